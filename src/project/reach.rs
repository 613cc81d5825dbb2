//! Magnitudes of a frame's integers, and its eye.

use hwmodel::Format;

use super::vector::cross;

/// A view as integers of `2^-frac` voxels: clip vectors of the object's lowest corner and of a finest voxel's edges.
#[derive(Clone, Copy)]
pub(super) struct Quantised {
    pub(super) origin: [i64; 3],
    pub(super) edge: [[i64; 3]; 3],
}

/// Largest magnitudes in a frame.
pub(super) struct Reach {
    pub(super) position: i128,
    /// Of a silhouette plane: the sum of its three coefficients.
    plane: i128,
}

impl Reach {
    /// Over the object's eight corners; other vertices lie between. `None` beyond 127 bits.
    pub(super) fn of(quantised: &Quantised, depth: u32) -> Option<Self> {
        let origin = quantised.origin.map(i128::from);
        let edge = quantised.edge.map(|e| e.map(i128::from));
        let along = edge.map(|e| e.map(|c| c << depth));
        let mut reach = Self {
            position: 0,
            plane: 0,
        };
        for corner in 0..8u32 {
            let mut at = origin;
            for (k, step) in along.iter().enumerate() {
                if corner >> (2 - k) & 1 == 1 {
                    for c in 0..3 {
                        at[c] += step[c];
                    }
                }
            }
            for c in at {
                reach.position = reach.position.max(c.abs());
            }
            if reach.position > 1 << 62 {
                return None;
            }
            for step in edge {
                let [a, b, c] = cross(at, step).map(i128::abs);
                reach.plane = reach.plane.max(a + b + c);
            }
        }
        Some(reach)
    }

    /// Whether positions leave headroom (bisector tests take `2X - W`, the guard `8X + W`, the divide `X + 4W` and `8W`).
    pub(super) fn position_fits(&self, format: Format, shift: u32) -> bool {
        self.position << shift <= i128::from(format.max()) / 16
    }

    pub(super) fn plane_fits(&self, format: Format) -> bool {
        self.plane <= i128::from(format.wide().max()) / 8
    }

    pub(super) fn fits(&self, format: Format, sub_levels: u32) -> bool {
        self.position_fits(format, sub_levels) && self.plane_fits(format)
    }
}

/// The eye of the quantised view, where the clip vector is zero.
pub(super) struct Eye {
    pub(super) floor: [i64; 3],
    pub(super) ceil: [i64; 3],
    pub(super) positive: bool,
}

impl Eye {
    /// Solves `origin + sum u_k edge_k = 0` by Cramer's rule, in units of `2^-sub_levels`. `None`: beyond 127 bits;
    /// `Some(None)`: no volume.
    pub(super) fn solve(quantised: &Quantised, sub_levels: u32) -> Option<Option<Self>> {
        let edge = quantised.edge.map(|e| e.map(i128::from));
        let minus_origin = quantised.origin.map(|c| -i128::from(c));
        let determinant = |m: &[[i128; 3]; 3]| -> Option<i128> {
            let minor = cross(m[1], m[2]);
            (0..3).try_fold(0i128, |sum, c| {
                m[0][c].checked_mul(minor[c])?.checked_add(sum)
            })
        };
        let whole = determinant(&edge)?;
        if whole == 0 {
            return Some(None);
        }
        let (sign, size) = (whole.signum(), whole.abs());
        let mut floor = [0; 3];
        let mut ceil = [0; 3];
        for k in 0..3 {
            let mut replaced = edge;
            replaced[k] = minus_origin;
            let unit = 1i128 << sub_levels;
            let part = determinant(&replaced)?.checked_mul(unit)? * sign;
            floor[k] = i64::try_from(part.div_euclid(size)).ok()?;
            ceil[k] = floor[k] + i64::from(part.rem_euclid(size) != 0);
        }
        Some(Some(Self {
            floor,
            ceil,
            positive: whole > 0,
        }))
    }
}
