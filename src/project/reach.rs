//! What follows from a frame's integers: how far they reach, and where its eye is.

use hwmodel::Format;

use super::host::{Host, Num, Whole, cross};

/// A view as integers of `2^-frac` voxels: clip vectors of the object's lowest
/// corner and of a finest voxel's edges.
#[derive(Clone, Copy)]
pub(super) struct Quantised<H> {
    pub(super) origin: [Num<H, i64>; 3],
    pub(super) edge: [[Num<H, i64>; 3]; 3],
}

/// Largest magnitudes that a frame meets.
pub(super) struct Reach<H> {
    /// Of a coordinate of a clip vector.
    pub(super) position: Whole<H>,
    /// Of a silhouette plane: the sum of its three coefficients.
    plane: Whole<H>,
}

impl<H: Host> Reach<H> {
    /// The reach over the object's eight corners; intermediate vertices lie between.
    /// `None` where it does not fit 127 bits.
    pub(super) fn of(view: &Quantised<H>, depth: u32) -> Option<Self> {
        let by = view.origin[0].by;
        let origin = view.origin.map(Num::widened);
        let edge = view.edge.map(|e| e.map(Num::widened));
        let along = edge.map(|e| e.map(|c| c << depth));
        let mut reach = Self {
            position: by.lift(0),
            plane: by.lift(0),
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
                let [a, b, c] = cross(at, step).map(Whole::abs);
                reach.plane = reach.plane.max(a + b + c);
            }
        }
        Some(reach)
    }

    /// Whether positions leave headroom (bisector tests take `2X - W`, the
    /// guard `8X + W`, the divide `X + 4W` and `8W`).
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

/// The eye of the quantised view, exactly: where the clip vector is zero.
pub(super) struct Eye<H> {
    pub(super) floor: [Num<H, i64>; 3],
    pub(super) ceil: [Num<H, i64>; 3],
    pub(super) positive: bool,
}

impl<H: Host> Eye<H> {
    /// Solves `origin + sum u_k edge_k = 0` by Cramer's rule, in units of
    /// `2^-sub_levels`. `None`: beyond 127 bits; `Some(None)`: no volume.
    pub(super) fn solve(view: &Quantised<H>, sub_levels: u32) -> Option<Option<Self>> {
        let by = view.origin[0].by;
        let edge = view.edge.map(|e| e.map(Num::widened));
        let minus_origin = view.origin.map(|c| -c.widened());
        let determinant = |m: &[[Whole<H>; 3]; 3]| -> Option<Whole<H>> {
            let minor = cross(m[1], m[2]);
            (0..3).try_fold(by.lift(0), |sum, c| {
                m[0][c].checked_mul(minor[c])?.checked_add(sum)
            })
        };
        let whole = determinant(&edge)?;
        if whole == 0 {
            return Some(None);
        }
        let (sign, size) = (whole.signum(), whole.abs());
        let mut floor = [by.lift(0); 3];
        let mut ceil = floor;
        for k in 0..3 {
            let mut replaced = edge;
            replaced[k] = minus_origin;
            let unit = by.lift(1i128) << sub_levels;
            let part = determinant(&replaced)?.checked_mul(unit)? * sign;
            floor[k] = part.div_floor(size).narrowed()?;
            ceil[k] = floor[k] + i64::from(part.rem_floor(size) != 0);
        }
        Some(Some(Self {
            floor,
            ceil,
            positive: whole > 0,
        }))
    }
}
