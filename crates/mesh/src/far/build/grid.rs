//! The uniform grid of a node: which voxels there are, which a ray crosses.

use glam::DVec3;

use crate::geometry::point;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Grid {
    pub(super) origin: DVec3,
    pub(super) voxel: f64,
    pub(super) cells: [u8; 3],
}

impl Grid {
    /// The longest side of a box spans `side` (2 to 255) voxels, from the middle of the first to that of the last.
    pub(super) fn around(low: DVec3, high: DVec3, side: u32) -> Self {
        let extent = high - low;
        let steps = f64::from(side.clamp(2, 255) - 1);
        // As stored: so that the viewer's voxels are those that were sampled.
        let voxel = f64::from(((extent.max_element() / steps) as f32).max(f32::MIN_POSITIVE));
        let origin = (low - DVec3::splat(voxel / 2.0)).as_vec3().as_dvec3();
        let cells = (extent / voxel).to_array();
        Self {
            origin,
            voxel,
            cells: cells.map(|c| ((c + 0.5).floor() + 1.0).min(255.0) as u8),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.cells.iter().map(|&c| usize::from(c)).product()
    }

    pub(super) fn number(&self, place: [u8; 3]) -> usize {
        let [x, y, z] = place.map(usize::from);
        let [nx, ny, _] = self.cells.map(usize::from);
        (z * ny + y) * nx + x
    }

    pub(super) fn place(&self, number: usize) -> [u8; 3] {
        let [nx, ny, _] = self.cells.map(usize::from);
        [number % nx, number / nx % ny, number / nx / ny].map(|c| c as u8)
    }

    pub(super) fn neighbours(&self, number: usize) -> impl Iterator<Item = usize> + use<> {
        let place = self.place(number);
        let grid = *self;
        (0..27u16).filter_map(move |step| {
            let steps = [step % 3, step / 3 % 3, step / 9];
            let mut at = place;
            for k in 0..3 {
                let next = (u16::from(place[k]) + steps[k]).checked_sub(1)?;
                if next >= u16::from(grid.cells[k]) {
                    return None;
                }
                at[k] = next as u8;
            }
            (at != place).then(|| grid.number(at))
        })
    }

    pub(super) fn local(&self, point: DVec3) -> DVec3 {
        (point - self.origin) / self.voxel
    }

    pub(super) fn world(&self, local: DVec3) -> DVec3 {
        self.origin + local * self.voxel
    }

    /// Visits voxels along a line while `visit` returns true, with the distance (in voxels) at which the line leaves each.
    /// Distances are whole numbers of 2^-32 voxels, so that steps are exact and need no branch.
    #[inline]
    pub(super) fn along(
        &self,
        from: DVec3,
        direction: DVec3,
        mut visit: impl FnMut(usize, f64) -> bool,
    ) {
        let cells = point(self.cells);
        let per_cell = direction.recip();
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        for k in 0..3 {
            if direction[k] == 0.0 {
                if from[k] < 0.0 || from[k] >= cells[k] {
                    return;
                }
                continue;
            }
            let (a, b) = (-from[k] * per_cell[k], (cells[k] - from[k]) * per_cell[k]);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        if enter >= leave {
            return;
        }
        let start = from + direction * enter;
        let [nx, ny, _] = self.cells.map(i64::from);
        let strides = [1, nx, nx * ny];
        let units = |distance: f64| (distance * UNITS).clamp(-FAR_AWAY, FAR_AWAY) as i64;
        let (mut number, mut end) = (0, i64::MAX);
        let (mut step, mut next, mut size) = ([0; 3], [i64::MAX; 3], [0; 3]);
        for k in 0..3 {
            let last = i64::from(self.cells[k]) - 1;
            let at = (start[k].floor() as i64).clamp(0, last);
            number += at * strides[k];
            let is_forward = direction[k] > 0.0;
            if direction[k] != 0.0 {
                step[k] = if is_forward { strides[k] } else { -strides[k] };
                next[k] = units(((at + i64::from(is_forward)) as f64 - from[k]) * per_cell[k]);
                size[k] = units(per_cell[k].abs());
                let left = if is_forward { last - at } else { at };
                end = end.min(next[k].saturating_add(left.saturating_mul(size[k])));
            }
        }
        let ([mut x, mut y, mut z], [of_x, of_y, of_z]) = (next, size);
        loop {
            let nearest = x.min(y).min(z);
            if !visit(number as usize, nearest as f64 / UNITS) || nearest >= end {
                return;
            }
            // All ones where that plane is crossed; where several are, through an edge or corner.
            let crossed = |plane: i64| -i64::from(plane == nearest);
            let (by_x, by_y, by_z) = (crossed(x), crossed(y), crossed(z));
            x += of_x & by_x;
            y += of_y & by_y;
            z += of_z & by_z;
            number += (step[0] & by_x) + (step[1] & by_y) + (step[2] & by_z);
        }
    }
}

const UNITS: f64 = (1u64 << 32) as f64;
const FAR_AWAY: f64 = (1u64 << 60) as f64;
