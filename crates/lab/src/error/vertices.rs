//! How far the machine's vertices are from where the camera sees them.

use std::collections::BTreeMap;

use glam::DVec3;

use super::method::VertexLevel;
use crate::measure::Spread;
use shiftvox::machine::{Positions, Space, visit_positions};
use shiftvox::project::camera::Axes;
use shiftvox::project::{Camera, FrameSetup};

/// Voxels whose vertices are examined, most; their ancestors come on top.
const MOST_VOXELS: usize = 20_000;

/// Errors by octree level of the vertices of the voxels that a frame shows
/// and of all their ancestors. `voxels`: what its samples see.
///
/// Examined are vertices whose exact projection lies in the picture. The
/// projection is that of the camera in real numbers, so the rounding of the view by
/// a narrow format counts. Of more than 20,000 voxels every n-th is taken.
#[must_use]
pub fn vertex_levels(camera: &Camera, setup: &FrameSetup, voxels: &[[i32; 4]]) -> Vec<VertexLevel> {
    let Ok(axes) = camera.axes() else {
        return Vec::new();
    };
    let mut seen: Vec<[i32; 4]> = voxels.iter().copied().filter(|v| v[3] >= 0).collect();
    seen.sort_unstable();
    seen.dedup();
    let step = seen.len().div_ceil(MOST_VOXELS).max(1);
    let some: Vec<[i32; 4]> = seen.into_iter().step_by(step).collect();
    let mut levels: BTreeMap<u32, (u64, u64, Vec<f64>)> = BTreeMap::new();
    visit_positions(setup, &some, &mut |positions| {
        let (records, on_screen, errors) = levels.entry(positions.level).or_default();
        *records += 1;
        *on_screen += u64::from(positions.space == Space::Screen);
        for corner in 0..8 {
            errors.extend(error_px(camera, &axes, setup, positions, corner));
        }
    });
    let level = |(level, (records, on_screen, errors))| VertexLevel {
        level,
        records,
        on_screen,
        px: Spread::of(errors),
    };
    levels.into_iter().map(level).collect()
}

/// Distance of one vertex from its exact projection, pixels; `None` where
/// that is not in the picture.
fn error_px(
    camera: &Camera,
    axes: &Axes,
    setup: &FrameSetup,
    positions: &Positions,
    corner: usize,
) -> Option<f64> {
    let held = positions.samples[corner]?;
    let placement = &setup.placement;
    let side = 1i64 << (setup.depth - positions.level);
    let along = |k: usize| {
        let index = placement.origin_index[k] + positions.corner[k];
        let index = index + side * (corner as i64 >> (2 - k) & 1);
        placement.world_origin[k] + index as f64 * placement.voxel_size
    };
    let from_eye = DVec3::new(along(0), along(1), along(2)) - camera.eye;
    let depth = from_eye.dot(axes.forward);
    if depth <= 0.0 {
        return None;
    }
    let (width, height) = (f64::from(camera.width), f64::from(camera.height));
    let x = width / 2.0 + axes.focal_px * from_eye.dot(axes.right) / depth;
    let y = height / 2.0 - axes.focal_px * from_eye.dot(axes.up) / depth;
    if !(0.0..=width).contains(&x) || !(0.0..=height).contains(&y) {
        return None;
    }
    let sample = libm::ldexp(1.0, -(setup.options.aa_log2 as i32));
    Some(libm::hypot(held[0] * sample - x, held[1] * sample - y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use shiftvox::graph::Placement;
    use shiftvox::project::{CageKind, Coverage, SetupOptions};

    fn levels(options: &SetupOptions) -> Vec<VertexLevel> {
        let camera = Camera {
            eye: DVec3::new(3.0, -2.0, 2.5) * 8.0,
            target: DVec3::splat(4.0),
            up: DVec3::Z,
            fov_degrees: 30.0,
            width: 200,
            height: 160,
        };
        let placement = Placement {
            origin_index: [-4, 0, 3],
            voxel_size: 0.5,
            ..Placement::default()
        };
        let camera = Camera {
            eye: camera.eye / 2.0,
            target: DVec3::new(0.0, 2.0, 3.5),
            ..camera
        };
        let setup = FrameSetup::new(&camera, &placement, 3, options).unwrap();
        let voxels = [[1, 2, 3, 3], [7, 7, 7, 3], [1, 2, 3, 3], [0, 0, 0, -1]];
        vertex_levels(&camera, &setup, &voxels)
    }

    #[test]
    fn clip_space_is_exact_but_for_the_views_rounding() {
        let levels = levels(&SetupOptions {
            tolerance_px: 0.0,
            aa_log2: 1,
            ..SetupOptions::default()
        });
        let numbers: Vec<_> = levels.iter().map(|l| (l.level, l.records)).collect();
        assert_eq!(numbers, [(0, 1), (1, 2), (2, 2), (3, 2)]);
        for level in levels {
            assert_eq!(level.on_screen, 0);
            assert!(level.px.count > 0 && level.px.worst < 1e-4, "{level:?}");
        }
    }

    #[test]
    fn the_paper_errs_more_and_narrow_words_more_still() {
        let paper = SetupOptions {
            cage: CageKind::Corners,
            coverage: Coverage::Any,
            tolerance_px: f64::INFINITY,
            ..SetupOptions::of(Coverage::Any)
        };
        let [exact, paper] = [SetupOptions::default(), paper].map(|options| levels(&options));
        // The root's corners are projected; what is halved from them errs.
        assert!(paper[0].px.worst < 1e-3, "{paper:?}");
        assert!(paper[1].px.worst > 0.5, "{paper:?}");
        assert!(exact.iter().all(|l| l.px.worst < 1e-3), "{exact:?}");
        let narrow = levels(&SetupOptions {
            bits: 20,
            ..SetupOptions::default()
        });
        assert!(narrow[3].px.worst > 1e-3, "{narrow:?}");
    }
}
