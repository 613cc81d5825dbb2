//! The uniform grid of a node: which voxels there are, which a ray crosses.

use glam::DVec3;

/// Cubes from `origin`, `cells` along each axis (1 to 255).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Lowest corner, world units.
    pub origin: DVec3,
    /// Side of a voxel, world units, above 0.
    pub voxel: f64,
    /// Voxels along each axis.
    pub cells: [u8; 3],
}

impl Grid {
    /// The grid of a box: its longest side spans `side` voxels, from the middle
    /// of the first to the middle of the last, so that the outermost planes lie
    /// within a layer and not between two. `side` is 2 to 255.
    #[must_use]
    pub fn around(low: DVec3, high: DVec3, side: u32) -> Self {
        let extent = high - low;
        let steps = f64::from(side.clamp(2, 255) - 1);
        // As stored: so that the viewer's voxels are those that were sampled.
        let voxel = f64::from((extent.max_element() / steps) as f32);
        let voxel = if voxel > 0.0 {
            voxel
        } else {
            f64::from(f32::MIN_POSITIVE)
        };
        let origin = (low - DVec3::splat(voxel / 2.0)).as_vec3().as_dvec3();
        let cells = (extent / voxel).to_array().map(|steps| {
            // 0 to 254 steps: 1 to 255 layers.
            (steps + 0.5) as u32 as f64 + 1.0
        });
        Self {
            origin,
            voxel,
            cells: cells.map(|c| c.min(255.0) as u8),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.cells.iter().map(|&c| usize::from(c)).product()
    }

    /// Number of a voxel, row by row.
    pub(super) fn number(&self, place: [u8; 3]) -> usize {
        let [x, y, z] = place.map(usize::from);
        let [nx, ny, _] = self.cells.map(usize::from);
        (z * ny + y) * nx + x
    }

    /// Place of the voxel of a number.
    pub(super) fn place(&self, number: usize) -> [u8; 3] {
        let [nx, ny, _] = self.cells.map(usize::from);
        // Below 255 each, as the grid is.
        [number % nx, number / nx % ny, number / nx / ny].map(|c| c as u8)
    }

    /// Numbers of the voxels at a voxel's faces, edges and corners, 26 of them within the grid.
    pub(super) fn neighbours(&self, number: usize) -> impl Iterator<Item = usize> + use<> {
        let place = self.place(number);
        let grid = *self;
        (0..27u16).filter_map(move |step| {
            let steps = [step % 3, step / 3 % 3, step / 9];
            let mut at = place;
            for k in 0..3 {
                // One back, here, one on.
                let next = (u16::from(place[k]) + steps[k]).checked_sub(1)?;
                if next >= u16::from(grid.cells[k]) {
                    return None;
                }
                // Below the number of cells.
                at[k] = next as u8;
            }
            (at != place).then(|| grid.number(at))
        })
    }

    /// In voxels from the origin.
    pub(super) fn local(&self, point: DVec3) -> DVec3 {
        (point - self.origin) / self.voxel
    }

    /// In world units, from voxels.
    pub(super) fn world(&self, local: DVec3) -> DVec3 {
        self.origin + local * self.voxel
    }

    /// The voxels along a ray, with the distances (in voxels) at which it enters and leaves each.
    pub(super) fn along(&self, from: DVec3, direction: DVec3) -> GridTraversal {
        let cells = DVec3::from_array(self.cells.map(f64::from));
        let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
        for k in 0..3 {
            if direction[k] == 0.0 {
                if from[k] < 0.0 || from[k] >= cells[k] {
                    leave = f64::NEG_INFINITY;
                }
                continue;
            }
            let (a, b) = (-from[k] / direction[k], (cells[k] - from[k]) / direction[k]);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        let start = from + direction * enter;
        let at =
            [0, 1, 2].map(|k| (start[k].floor() as i32).clamp(0, i32::from(self.cells[k]) - 1));
        let next = [0, 1, 2].map(|k| {
            if direction[k] == 0.0 {
                return f64::INFINITY;
            }
            let plane = f64::from(at[k] + i32::from(direction[k] > 0.0));
            (plane - from[k]) / direction[k]
        });
        GridTraversal {
            cells: self.cells.map(i32::from),
            at,
            next,
            per_cell: [0, 1, 2].map(|k| (1.0 / direction[k]).abs()),
            forward: [0, 1, 2].map(|k| if direction[k] > 0.0 { 1 } else { -1 }),
            enter,
            is_done: enter >= leave,
        }
    }
}

/// Voxels along a ray, one after the other.
#[derive(Debug, Clone)]
pub(super) struct GridTraversal {
    cells: [i32; 3],
    at: [i32; 3],
    next: [f64; 3],
    per_cell: [f64; 3],
    forward: [i32; 3],
    enter: f64,
    is_done: bool,
}

/// A voxel that a ray crosses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crossing {
    pub(super) place: [u8; 3],
    /// Where the ray enters and leaves it, voxels along the ray.
    pub(super) enter: f64,
    pub(super) leave: f64,
}

impl Iterator for GridTraversal {
    type Item = Crossing;

    fn next(&mut self) -> Option<Crossing> {
        if self.is_done {
            return None;
        }
        let axis = (0..3).fold(0, |least, k| {
            if self.next[k] < self.next[least] {
                k
            } else {
                least
            }
        });
        let crossing = Crossing {
            // Within the cells, so within a byte.
            place: self.at.map(|c| c as u8),
            enter: self.enter,
            leave: self.next[axis].max(self.enter),
        };
        self.enter = crossing.leave;
        self.at[axis] += self.forward[axis];
        self.next[axis] += self.per_cell[axis];
        self.is_done = !(0..self.cells[axis]).contains(&self.at[axis]);
        Some(crossing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_outermost_planes_lie_within_layers() {
        let grid = Grid::around(DVec3::ZERO, DVec3::new(7.0, 3.0, 0.0), 8);
        assert_eq!((grid.cells, grid.voxel), ([8, 4, 1], 1.0));
        assert_eq!(grid.origin, DVec3::splat(-0.5));
        for number in 0..grid.len() {
            assert_eq!(grid.number(grid.place(number)), number);
        }
    }

    #[test]
    fn neighbours_are_all_within_one_voxel() {
        let grid = Grid {
            origin: DVec3::ZERO,
            voxel: 1.0,
            cells: [255, 2, 3],
        };
        for number in 0..grid.len() {
            let here = grid.place(number).map(i32::from);
            let is_near = |&other: &usize| {
                let there = grid.place(other).map(i32::from);
                other != number && (0..3).all(|k| (here[k] - there[k]).abs() <= 1)
            };
            let expected: Vec<usize> = (0..grid.len()).filter(is_near).collect();
            assert_eq!(grid.neighbours(number).collect::<Vec<usize>>(), expected);
        }
    }

    #[test]
    fn a_ray_crosses_voxels_in_order() {
        let grid = Grid {
            origin: DVec3::ZERO,
            voxel: 1.0,
            cells: [4, 4, 4],
        };
        let direction = DVec3::new(1.0, 0.5, 0.0).normalize();
        let walk: Vec<Crossing> = grid
            .along(DVec3::new(-2.0, -0.75, 0.5), direction)
            .collect();
        let places: Vec<[u8; 3]> = walk.iter().map(|c| c.place).collect();
        let expected = [
            [0, 0, 0],
            [1, 0, 0],
            [1, 1, 0],
            [2, 1, 0],
            [3, 1, 0],
            [3, 2, 0],
        ];
        assert_eq!(places, expected);
        assert!(walk.windows(2).all(|w| w[0].leave == w[1].enter));
        assert_eq!(grid.along(DVec3::splat(9.0), DVec3::X).count(), 0);
    }
}
