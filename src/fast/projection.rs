//! Projection of a node: its centre, the slopes of its moments, and the window around its parts.

use super::constants::{Constants, Level};
use super::lanes::{F32x4, Floats, Isa, Lanes, Masks};
use super::orders::{EXTENTS, SLABS};
use super::window::{BEYOND, WINDOW_MARGIN, Window};

/// Rounding of [`Projection::window`], relative to its terms: `spec/fast.md`, section 5.
const BOX_ROUNDING: f32 = 1.0 / (1 << 18) as f32;

/// Half a node's depth over its centre's, from which [`Projection::window`] leaves windows unchanged: towards 1
/// rounding grows.
const NEAR: f32 = 0.25;

#[derive(Debug, Clone, Copy)]
pub(super) struct Projection<I: Isa> {
    pub(super) centre: [f64; 2],
    inverse: f64,
    /// Slopes of the moments by column and by row, by axis.
    pub(super) step: [I::F32x4; 2],
}

impl<I: Isa> Projection<I> {
    /// Of a node that is `across` parts wide, with its centre's clip vector. The unit of slopes is the side of a part.
    #[inline(always)]
    pub(super) fn new(
        isa: I,
        constants: &Constants,
        level: &Level,
        [x, y, w]: [f64; 3],
        across: f64,
    ) -> Self {
        let inverse = 1.0 / w;
        let to_samples = constants.root_samples * inverse;
        let centre = [x * to_samples - 0.5, y * to_samples - 0.5];
        let unit = constants.scale * w * across * level.inverse_side;
        Self {
            centre,
            inverse,
            step: steps(isa, &constants.edge_columns, centre, unit),
        }
    }

    /// The part of a window that the box around some parts covers, or a little more; of a near node ([`NEAR`]) all. A point
    /// `t` parts from the centre is seen `t . step` from it, times a constant, over its depth, which differs from the
    /// centre's by at most half a node's.
    #[inline(always)]
    pub(super) fn window(
        &self,
        isa: I,
        constants: &Constants,
        level: &Level,
        across: f64,
        parts: u64,
        window: &Window,
    ) -> Window {
        let [down, right] = self.step;
        let share = (level.half_depth * self.inverse) as f32;
        if share > NEAR {
            return *window;
        }
        let [middle, half] = extent(isa, parts);
        let side = f64::from(level.side);
        let scale = side * side / (4.0 * across) * constants.inverse_scale;
        let scale = (scale * self.inverse * self.inverse) as f32;
        let spread = isa.splat(share).div(isa.splat(1.0 - share));
        let outward = isa.four(&[-0.0, -0.0, 0.0, 0.0]);
        let [x, y] = self.centre.map(|c| c as f32);
        let centre = isa.four(&[x, y, x, y]).flip(outward);
        let along = right.mul(middle).sums(down.mul(middle));
        let about = right.abs().mul(half).sums(down.abs().mul(half));
        let along = along.mul(isa.four(&[-scale, scale, scale, -scale]));
        let about = about.mul(isa.splat(scale.abs()));
        let reach = along.add(about);
        let rounding = isa.splat(BOX_ROUNDING);
        let margin = centre
            .abs()
            .add(about)
            .fma(rounding, isa.splat(WINDOW_MARGIN));
        let end = centre.add(reach.abs().fma(spread, reach.add(margin)));
        let bounds = [window.left, window.top, window.right, window.bottom].map(|c| c as f32);
        let bounds = isa.four(&bounds).flip(outward);
        let end = end.min(bounds).max(isa.splat(-BEYOND as f32));
        Window::of(end.floor().flip(outward).whole())
    }
}

/// Slopes by column and by row of moments about a point of the picture. `edges`: by coordinate, times `unit`.
#[inline(always)]
fn steps<I: Isa>(isa: I, edges: &[[f64; 4]; 3], centre: [f64; 2], unit: f64) -> [I::F32x4; 2] {
    let (column, row) = (
        I::F64x4::splat(isa, centre[0]),
        I::F64x4::splat(isa, centre[1]),
    );
    let [x, y, w] = edges;
    let w = I::F64x4::load(isa, w);
    let column_step = row.fms(w, I::F64x4::load(isa, y));
    let row_step = column.fnma(w, I::F64x4::load(isa, x));
    let unit = I::F64x4::splat(isa, unit);
    [
        isa.narrow(column_step.mul(unit)),
        isa.narrow(row_step.mul(unit)),
    ]
}

#[inline(always)]
fn extent<I: Isa>(isa: I, parts: u64) -> [I::F32x4; 2] {
    let mut extent = [isa.splat(0.0); 2];
    let parts = I::U64x4::splat(isa, parts);
    for (axis, slabs) in SLABS.iter().enumerate() {
        let empty = parts.and(I::U64x4::load(isa, slabs)).zeros() as usize;
        let [middle, half] = &EXTENTS[axis][(empty & 15) ^ 15];
        extent[0] = extent[0].add(isa.four(middle));
        extent[1] = extent[1].add(isa.four(half));
    }
    extent
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fast::lanes::Scalar;
    use crate::fast::lines::tests::Node;
    use crate::fast::orders::along;
    use crate::split_mix::SplitMix;

    #[test]
    fn windows_hold_the_parts_and_little_more() {
        let mut dice = SplitMix::new(7);
        let (mut checked, mut far, mut tight) = (0, 0, 0);
        while checked < 20_000 {
            let node = Node::random(&mut dice, 0);
            let (constants, centre, min) = (&node.constants, node.centre, node.min);
            let level = &constants.levels[node.level];
            let parts = (0..1 + dice.below(3)).fold(0, |all, _| all | 1u64 << dice.below(64));
            // Least x, least y, and the greatest of both, negated.
            let mut least = [f64::MAX; 4];
            for corner in 0..8 * 64 {
                let (part, corner) = (corner / 8, corner % 8);
                if parts >> part & 1 == 1 {
                    let at = [0, 1, 2].map(|k| {
                        let steps = along(part, k) + (corner >> (2 - k) & 1);
                        min[k] + steps as f64 * f64::from(level.side) / 4.0
                    });
                    let [x, y, w] = node.clip(at);
                    let [x, y] = [x, y].map(|c| c * constants.root_samples / w - 0.5);
                    let ends = [x, y, -x, -y];
                    least = [0, 1, 2, 3].map(|i| least[i].min(ends[i]));
                }
            }
            let bounds = Window::of([0, 0, 399, 299]);
            let across = [4.0, 16.0][checked % 2];
            let projection = Projection::new(Scalar, constants, level, centre, across);
            let window = projection.window(Scalar, constants, level, across, parts, &bounds);
            let edges = [0.0, 0.0, -399.0, -299.0];
            let least = [0, 1, 2, 3].map(|i| least[i].ceil().max(edges[i]));
            let [width, height] = [0, 1].map(|i| -least[i + 2] - least[i]);
            if width < 0.0 || height < 0.0 {
                continue;
            }
            let found = [window.left, window.top, -window.right, -window.bottom].map(f64::from);
            assert!((0..4).all(|i| found[i] <= least[i]), "{window:?} {least:?}");
            // Near the eye parts of a box are at very different depths.
            if level.half_depth * 16.0 < centre[2] {
                far += 1;
                let room = 2.0 + 0.25 * width.max(height);
                tight += u32::from((0..4).all(|i| least[i] - found[i] <= room));
            }
            checked += 1;
        }
        assert!(far > 1000 && tight * 10 > far * 9, "{tight} of {far}");
    }
}
