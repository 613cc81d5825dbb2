//! The nodes to draw: those whose voxels are small enough, else their children.

use glam::DVec3;

use super::FarCounts;
use crate::far::store::FarFile;
use crate::geometry::point;
use crate::raster::RasterCamera;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Chosen {
    pub(super) number: usize,
    /// Of the eye from the middle of its box, world units.
    pub(super) middle: f64,
}

const BRANCH_MARGIN: f64 = 2.0;

/// `is_fine`: whether pixels have so many samples that triangles may look better than voxels.
pub(super) fn nodes(
    file: &FarFile,
    view: &RasterCamera,
    voxel_px: f64,
    is_fine: bool,
    counts: &mut FarCounts,
) -> Vec<Chosen> {
    let mut chosen = Vec::new();
    let mut waiting = vec![0];
    while let Some(number) = waiting.pop() {
        counts.visited += 1;
        let node = &file.nodes()[number];
        let centre = file.settings.centre;
        let (low, high) = node.bounds();
        let (low, high) = (low + centre, high + centre);
        let voxel = f64::from(node.voxel);
        let eye = view.eye;
        let distance = (low - eye).max(eye - high).max(DVec3::ZERO).length();
        let across = if is_fine { node.across } else { 2 };
        let pixel = 0.5 * f64::from(across) * voxel;
        let is_small = pixel * view.focal_px <= voxel_px * distance;
        // Nearer, things that hide it may be behind the eye, unless the eye is outside the box of everything.
        let all = file.bounds();
        let is_outside_all = eye.cmplt(all.0).any() || eye.cmpgt(all.1).any();
        let is_far = distance >= file.settings.distance_voxels * voxel || is_outside_all;
        let is_drawn = node.is_leaf() || node.has_grid() && is_small && is_far;
        // Voxels are drawn as squares that reach beyond their cubes.
        let margin = if is_drawn {
            voxel
        } else {
            let least = (high - low).max_element() / f64::from(file.settings.grid - 1);
            BRANCH_MARGIN * voxel.max(least)
        };
        let margin = DVec3::splat(margin);
        if is_outside(view, low - margin, high + margin) {
            counts.outside += 1;
        } else if is_drawn {
            let middle = ((low + high) / 2.0 - eye).length();
            chosen.push(Chosen { number, middle });
        } else {
            waiting.extend(node.below());
        }
    }
    chosen
}

/// Whether a box is certainly beside or behind the picture.
fn is_outside(view: &RasterCamera, low: DVec3, high: DVec3) -> bool {
    let corners: [DVec3; 8] = std::array::from_fn(|corner| {
        view.seen(point([0, 1, 2].map(|k| [low, high][corner >> k & 1][k])))
    });
    if corners.iter().any(|seen| seen.z < view.near) {
        return corners.iter().all(|seen| seen.z < view.near);
    }
    let size = [view.width, view.height].map(f64::from);
    let places = corners.map(|seen| view.place(seen));
    (0..2).any(|k| {
        places.iter().all(|place| (place[k] + 1.5).ceil() < 0.0)
            || places
                .iter()
                .all(|place| (place[k] - 1.5).floor() >= size[k])
    })
}
