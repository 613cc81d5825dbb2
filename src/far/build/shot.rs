//! A ray at a node, from the surface S to where it ends.
//!
//! S lies around the node: each of its points is `distance` voxels from the
//! node's grid. Triangles beyond S do not hide the node.

use std::ops::Range;

use glam::DVec3;

use super::grid::Grid;
use super::rays::Occluders;
use crate::far::blend::Blend;

/// Steps of the search for S along a ray; it is nearly straight after the first.
const STEPS_TO_S: u32 = 3;

/// A node that is sampled.
pub(super) struct Target<'t> {
    pub(super) occluders: &'t Occluders,
    pub(super) grid: Grid,
    /// The node's own triangles among the occluders.
    pub(super) own: Range<usize>,
    /// Least distance of an eye that sees it, voxels.
    pub(super) distance: f64,
    pub(super) opacity_blend: Blend,
}

/// A ray that ended, in voxels of the grid.
pub(super) struct Shot {
    pub(super) from: DVec3,
    pub(super) direction: DVec3,
    /// Where it ends along its direction; infinite where it meets nothing.
    pub(super) end: f64,
    /// The triangle that it meets.
    pub(super) triangle: usize,
}

impl Target<'_> {
    /// The voxel in which a ray ends at one of the node's own triangles.
    pub(super) fn end_of(&self, shot: &Shot) -> Option<[u8; 3]> {
        if !self.own.contains(&shot.triangle) {
            return None;
        }
        let mut last = None;
        for crossing in self.grid.along(shot.from, shot.direction) {
            last = Some(crossing.place);
            if crossing.leave > shot.end {
                break;
            }
        }
        last
    }

    /// A ray from S through a point of the grid.
    pub(super) fn shoot(&self, point: DVec3, direction: DVec3) -> Shot {
        let from = point - direction * self.back_to_surface(point, direction);
        let meeting = self.occluders.nearest(self.grid.world(from), direction);
        Shot {
            from,
            direction,
            end: meeting.map_or(f64::INFINITY, |m| m.distance / self.grid.voxel),
            triangle: meeting.map_or(usize::MAX, |m| m.triangle),
        }
    }

    /// How far back from a point of the grid along a direction S is, voxels.
    fn back_to_surface(&self, point: DVec3, direction: DVec3) -> f64 {
        let cells = DVec3::from_array(self.grid.cells.map(f64::from));
        // The distance from the grid grows ever faster along the ray: Newton's
        // steps from beyond S come nearer to it and never go past.
        let mut back = self.distance + cells.length();
        for _ in 0..STEPS_TO_S {
            let at = point - direction * back;
            let outside = (at - cells).max(DVec3::ZERO) + at.min(DVec3::ZERO);
            let distance = outside.length();
            let slope = -outside.dot(direction) / distance;
            // Beyond the grid there is a slope; not for a direction of zero length.
            if slope.is_nan() || slope <= 0.0 {
                break;
            }
            back -= (distance - self.distance) / slope;
        }
        back
    }
}
