//! Distances of the machine's vertices from their exact projections.

use glam::DVec3;

use crate::measure::Spread;
use shiftvox::machine::{Positions, visit_positions};
use shiftvox::project::camera::Axes;
use shiftvox::project::{Camera, FrameSetup};

/// Most voxels whose vertices are examined, without their ancestors.
const MOST_VOXELS: usize = 20_000;

/// Errors in pixels of the vertices of visible voxels and of all their ancestors. `voxels`: what the
/// samples see.
///
/// Vertices count whose exact projection lies in the picture. That projection is in real numbers,
/// so errors include the rounding of the view by a narrow format. Of more than 20,000 voxels every
/// n-th is examined.
#[must_use]
pub fn vertex_errors(camera: &Camera, setup: &FrameSetup, voxels: &[[i32; 4]]) -> Option<Spread> {
    let axes = camera.axes().ok()?;
    let mut seen: Vec<[i32; 4]> = voxels.iter().copied().filter(|v| v[3] >= 0).collect();
    seen.sort_unstable();
    seen.dedup();
    let step = seen.len().div_ceil(MOST_VOXELS).max(1);
    let some: Vec<[i32; 4]> = seen.into_iter().step_by(step).collect();
    let mut errors = Vec::new();
    visit_positions(setup, &some, &mut |positions| {
        let of = |corner| error_px(camera, &axes, setup, positions, corner);
        errors.extend((0..8).filter_map(of));
    });
    (!errors.is_empty()).then(|| Spread::of(errors))
}

/// Distance of a vertex from its exact projection, pixels; `None` if that is not in the picture.
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
    use shiftvox::project::SetupOptions;

    fn errors(options: &SetupOptions) -> Spread {
        let camera = Camera {
            eye: DVec3::new(3.0, -2.0, 2.5) * 4.0,
            target: DVec3::new(0.0, 2.0, 3.5),
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
        let setup = FrameSetup::new(&camera, &placement, 3, options).unwrap();
        let voxels = [[1, 2, 3, 3], [7, 7, 7, 3], [1, 2, 3, 3], [0, 0, 0, -1]];
        vertex_errors(&camera, &setup, &voxels).unwrap()
    }

    #[test]
    fn clip_space_is_exact_and_the_papers_midpoints_err() {
        let exact = errors(&SetupOptions {
            aa_log2: 1,
            ..SetupOptions::default()
        });
        // The root, and two voxels with their ancestors: at most 7 records of 8 vertices.
        assert!((1..=56).contains(&exact.count), "{exact:?}");
        assert!(exact.worst < 1e-3, "{exact:?}");
        let paper = errors(&SetupOptions::paper());
        assert!(paper.worst > 0.5, "{paper:?}");
        let narrow = errors(&SetupOptions {
            bits: 20,
            ..SetupOptions::default()
        });
        assert!(narrow.worst > 1e-3, "{narrow:?}");
    }
}
