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
    pub(super) own: Own<'t>,
    /// Least distance of an eye that sees it, voxels.
    pub(super) distance: f64,
    pub(super) opacity_blend: Blend,
    pub(super) shader_blend: Blend,
}

/// Which triangles voxels are made of.
#[derive(Debug, Clone)]
pub(super) struct Own<'t> {
    range: Range<usize>,
    /// Of each of the range whether it is one; `None`: all are.
    is_taken: Option<&'t [bool]>,
}

impl<'t> Own<'t> {
    pub(super) fn all(range: Range<usize>) -> Self {
        Self {
            range,
            is_taken: None,
        }
    }

    pub(super) fn contains(&self, triangle: usize) -> bool {
        let is_taken = |taken: &[bool]| taken[triangle - self.range.start];
        self.range.contains(&triangle) && self.is_taken.is_none_or(is_taken)
    }

    pub(super) fn numbers(&self) -> impl Iterator<Item = usize> + use<'_, 't> {
        self.range.clone().filter(|&number| self.contains(number))
    }
}

impl<'t> Target<'t> {
    /// The same with some of its triangles.
    pub(super) fn of<'s>(&self, is_taken: &'s [bool]) -> Target<'s>
    where
        't: 's,
    {
        Target {
            own: Own {
                range: self.own.range.clone(),
                is_taken: Some(is_taken),
            },
            ..*self
        }
    }
}

/// A ray that ended, in voxels of the grid.
pub(super) struct Shot {
    pub(super) from: DVec3,
    pub(super) direction: DVec3,
    /// Where it ends along its direction; infinite where it meets nothing as far as it was followed.
    pub(super) end: f64,
    /// The triangle that it meets.
    pub(super) triangle: u32,
    /// Number of the touched voxel in which it ends at one of the node's own triangles;
    /// [`NOWHERE`]: in none.
    pub(super) touched: u32,
}

/// No voxel.
pub(super) const NOWHERE: u32 = u32::MAX;
/// A ray's end is in single precision: it may lie this far from the triangle, voxels, and so in
/// the voxel beside the triangle's.
const END_WITHIN: f64 = 0.01;

impl Target<'_> {
    /// Number of the touched voxel in which a ray ends. `slot` has those numbers, of all voxels of
    /// the grid.
    fn voxel_at(&self, end: DVec3, slot: &[u32]) -> u32 {
        let cells = self.grid.cells.map(f64::from);
        let number = |at: DVec3| {
            let place = [0, 1, 2].map(|k| at[k].floor().clamp(0.0, cells[k] - 1.0) as u8);
            slot[self.grid.number(place)]
        };
        let here = number(end);
        if here != NOWHERE {
            return here;
        }
        // Triangles between two voxels, or in a corner.
        let near = (0..27).map(|step| {
            let step = DVec3::new(
                f64::from(step % 3),
                f64::from(step / 3 % 3),
                f64::from(step / 9),
            );
            number(end + (step - DVec3::ONE) * END_WITHIN)
        });
        near.into_iter()
            .find(|&slot| slot != NOWHERE)
            .unwrap_or(NOWHERE)
    }

    /// A ray from S through a point of the grid, followed until `beyond` voxels behind it. `slot`
    /// has the numbers of touched voxels.
    pub(super) fn shoot(&self, point: DVec3, direction: DVec3, beyond: f64, slot: &[u32]) -> Shot {
        let back = self.back_to_surface(point, direction);
        let from = point - direction * back;
        let most = (back + beyond) * self.grid.voxel;
        let meeting = self
            .occluders
            .nearest(self.grid.world(from), direction, most);
        let mut shot = Shot {
            from,
            direction,
            end: f64::INFINITY,
            triangle: NOWHERE,
            touched: NOWHERE,
        };
        if let Some(meeting) = meeting {
            shot.end = meeting.distance / self.grid.voxel;
            shot.triangle = meeting.triangle as u32;
            if self.own.contains(meeting.triangle) {
                shot.touched = self.voxel_at(from + direction * shot.end, slot);
            }
        }
        shot
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
