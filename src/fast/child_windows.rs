//! Bounding rectangles of a node's eight children in the picture. A window may be too wide, never too narrow (margins:
//! `spec/fast.md`, section 5).

use super::constants::{Constants, Level};
use super::lanes::{Floats, Isa, Lanes, Tests};
use super::window::{BEYOND, WINDOW_MARGIN, Window};

const ROUNDING: f32 = 1.0 / (1 << 21) as f32;
/// Factor on extents, for an inverse of 11 bits and its rounding.
const SCALE: f32 = 1.0 + 1.0 / 256.0;
/// Margin of windows in `f64`: in samples, and relative to their terms.
const TINY_MARGIN: f64 = 1.0 / (1u64 << 40) as f64;

#[derive(Debug, Clone, Copy, Default)]
#[repr(C, align(32))]
pub(super) struct ChildWindows {
    sides: [[i32; 8]; 4],
    pub(super) held: u8,
    pub(super) near: u8,
}

impl ChildWindows {
    #[inline(always)]
    pub(super) fn at(&self, octant: usize) -> Window {
        Window::of([0, 1, 2, 3].map(|i| self.sides[i][octant & 7]))
    }

    #[inline(always)]
    pub(super) fn compute<I: Isa>(
        &mut self,
        isa: I,
        constants: &Constants,
        level: usize,
        centre: &[f64; 3],
        band: &Window,
    ) {
        let (own, below) = (&constants.levels[level], &constants.levels[level + 1]);
        if centre[2] > own.tiny_depth {
            self.compute_tiny(constants, own, below, centre, band);
            return;
        }
        let w = children(isa, own, centre, 2);
        let root = I::F64x4::splat(isa, constants.root_samples);
        let over = [root.div(w[0]), root.div(w[1])];
        let half_sample = I::F64x4::splat(isa, 0.5);
        let depth = I::F64x4::splat(isa, below.half_depth);
        let nearest = narrow(isa, [w[0].sub(depth), w[1].sub(depth)]);
        let zero = I::F32x8::splat(isa, 0.0);
        self.near = nearest.at_most(zero);
        let half = I::F32x8::splat(isa, own.side as f32 * (0.25 * SCALE));
        let share = nearest.reciprocal().mul(half);
        let rounding = I::F32x8::splat(isa, ROUNDING);
        let margin = I::F32x8::splat(isa, WINDOW_MARGIN);
        self.held = u8::MAX;
        let ends = [[band.left, band.right], [band.top, band.bottom]];
        for (axis, [first, last]) in ends.into_iter().enumerate() {
            let at = children(isa, own, centre, axis);
            let at = [
                at[0].fms(over[0], half_sample),
                at[1].fms(over[1], half_sample),
            ];
            let at = narrow(isa, at);
            let mut edges = zero;
            for edge in &constants.edge_lanes {
                let (along, depth) = (edge[axis], edge[2]);
                let along = I::F32x8::splat(isa, along);
                edges = edges.add(at.fnma(I::F32x8::splat(isa, depth), along).abs());
            }
            let extent = edges.fma(share, at.abs().fma(rounding, margin));
            let low = at
                .sub(extent)
                .ceil()
                .max(I::F32x8::splat(isa, first as f32));
            let high = at
                .add(extent)
                .floor()
                .min(I::F32x8::splat(isa, last as f32));
            self.held &= low.at_most(high);
            self.sides[axis] = low.whole();
            self.sides[axis + 2] = high.whole();
        }
    }

    #[inline(never)]
    fn compute_tiny(
        &mut self,
        constants: &Constants,
        own: &Level,
        below: &Level,
        centre: &[f64; 3],
        band: &Window,
    ) {
        let half = f64::from(own.side) / 4.0;
        *self = Self::default();
        for octant in 0..8 {
            let [x, y, w] = [0, 1, 2].map(|c| centre[c] + own.child[c][octant]);
            let nearest = w - below.half_depth;
            if nearest <= 0.0 {
                self.near |= 1 << octant;
                continue;
            }
            let mut side = [0; 4];
            for (axis, c) in [x, y].into_iter().enumerate() {
                let at = c * constants.root_samples / w - 0.5;
                let edges = constants.edge.iter().map(|e| (e[axis] - at * e[2]).abs());
                let extent = edges.sum::<f64>() * (half / nearest);
                let extent = extent + (extent + at.abs() + 1.0) * TINY_MARGIN;
                let (first, last) = ([band.left, band.top][axis], [band.right, band.bottom][axis]);
                side[axis] = (at - extent).ceil().max(f64::from(first)).min(BEYOND) as i32;
                side[axis + 2] = (at + extent).floor().min(f64::from(last)).max(-1.0) as i32;
            }
            for (sides, side) in self.sides.iter_mut().zip(side) {
                sides[octant] = side;
            }
            self.held |= u8::from(side[0] <= side[2] && side[1] <= side[3]) << octant;
        }
    }
}

#[inline(always)]
fn children<I: Isa>(isa: I, own: &Level, centre: &[f64; 3], c: usize) -> [I::F64x4; 2] {
    let middle = I::F64x4::splat(isa, centre[c]);
    let (halves, _) = own.child[c].as_chunks();
    [
        I::F64x4::load(isa, &halves[0]).add(middle),
        I::F64x4::load(isa, &halves[1]).add(middle),
    ]
}

#[inline(always)]
fn narrow<I: Isa>(isa: I, [low, high]: [I::F64x4; 2]) -> I::F32x8 {
    isa.join(isa.narrow(low), isa.narrow(high))
}
