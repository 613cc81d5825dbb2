//! Plain Rust: what the steps mean.

use super::*;
use crate::fast::orders::{self, EXTENTS, SLABS};
use crate::fast::strips::CELLS;

/// The set that every processor has.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scalar;

impl Four for [f32; 4] {
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        std::array::from_fn(|i| self[i] + other[i])
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        std::array::from_fn(|i| self[i] - other[i])
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        std::array::from_fn(|i| self[i] * other[i])
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        std::array::from_fn(|i| self[i] / other[i])
    }
    #[inline(always)]
    fn fma(self, by: Self, plus: Self) -> Self {
        std::array::from_fn(|i| self[i] * by[i] + plus[i])
    }
    #[inline(always)]
    fn fms(self, by: Self, less: Self) -> Self {
        std::array::from_fn(|i| self[i] * by[i] - less[i])
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        std::array::from_fn(|i| self[i].max(other[i]))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        std::array::from_fn(|i| self[i].min(other[i]))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.map(f32::abs)
    }
    #[inline(always)]
    fn flip(self, signs: Self) -> Self {
        std::array::from_fn(|i| {
            if signs[i].is_sign_negative() {
                -self[i]
            } else {
                self[i]
            }
        })
    }
    #[inline(always)]
    fn next(self) -> Self {
        [self[1], self[2], self[0], self[3]]
    }
    #[inline(always)]
    fn last(self) -> Self {
        [self[2], self[0], self[1], self[3]]
    }
    #[inline(always)]
    fn signs(self) -> u32 {
        (0..4)
            .map(|i| u32::from(self[i].is_sign_negative()) << i)
            .sum()
    }
    #[inline(always)]
    fn cells(self) -> [usize; 3] {
        [0, 1, 2].map(|j| (self[j] as i32 as u32).min(CELLS as u32 - 1) as usize)
    }
    #[inline(always)]
    fn values(self) -> [f32; 4] {
        self
    }
    #[inline(always)]
    fn floor(self) -> Self {
        self.map(f32::floor)
    }
    #[inline(always)]
    fn sums(self, other: Self) -> Self {
        let [a, b] = [self, other].map(|lanes| lanes.iter().sum());
        [a, b, a, b]
    }
    #[inline(always)]
    fn whole(self) -> [i32; 4] {
        self.map(|c| c as i32)
    }
}

impl Isa for Scalar {
    type Four = [f32; 4];
    type Distances = [i32; 64];

    #[inline(always)]
    fn four(self, values: &[f32; 4]) -> [f32; 4] {
        *values
    }
    #[inline(always)]
    fn splat(self, value: f32) -> [f32; 4] {
        [value; 4]
    }

    fn windows(
        self,
        constants: &Constants,
        level: usize,
        centre: &[f64; 3],
        band: &Window,
    ) -> Windows {
        let (own, below) = (&constants.levels[level], &constants.levels[level + 1]);
        let half = f64::from(own.side) / 4.0;
        let mut windows = Windows {
            sides: [[0; 8]; 4],
            held: 0,
            near: 0,
        };
        for octant in 0..8 {
            let [x, y, w] = [0, 1, 2].map(|c| centre[c] + own.child[c][octant]);
            let nearest = w - below.half_depth;
            if nearest <= 0.0 {
                windows.near |= 1 << octant;
                continue;
            }
            let mut side = [0; 4];
            for (axis, c) in [x, y].into_iter().enumerate() {
                let at = c * constants.root_samples / w - 0.5;
                let edges = constants.edge.iter().map(|e| (e[axis] - at * e[2]).abs());
                let extent = edges.sum::<f64>() * (half / nearest);
                let extent = extent + (extent + at.abs() + 1.0) * TINY_WINDOW_MARGIN;
                let (first, last) = ([band.left, band.top][axis], [band.right, band.bottom][axis]);
                side[axis] = (at - extent).ceil().max(f64::from(first)).min(BEYOND) as i32;
                side[axis + 2] = (at + extent).floor().min(f64::from(last)).max(-1.0) as i32;
            }
            for (sides, side) in windows.sides.iter_mut().zip(side) {
                sides[octant] = side;
            }
            windows.held |= u8::from(side[0] <= side[2] && side[1] <= side[3]) << octant;
        }
        windows
    }

    fn parts_of_samples(
        self,
        tables: [&Row; 3],
        cells: &[[f32; 4]; 3],
        wanted: u64,
        open: u64,
        candidates: &mut Candidates,
    ) -> u64 {
        let mut any = 0;
        for sample in (0..64).filter(|sample| open >> sample & 1 != 0) {
            let (x, y) = ((sample & 7) as f32, (sample >> 3) as f32);
            let [first, step_x, step_y] = *cells;
            let at = step_x.fma([x; 4], step_y.fma([y; 4], first)).cells();
            let parts = (0..3).fold(wanted, |parts, j| parts & tables[j][at[j] % CELLS]);
            candidates.0[sample] = parts;
            any |= u64::from(parts != 0) << sample;
        }
        any
    }

    fn distances(self, values: &[[f32; 4]; 3]) -> [i32; 64] {
        let [first, step_x, step_y] = values.map(|v| v.map(|c| c.round() as i32));
        std::array::from_fn(|sample| {
            let (x, y) = (sample as i32 & 7, sample as i32 >> 3);
            let at = |j: usize| (first[j] + step_x[j] * x + step_y[j] * y).abs();
            at(0).max(at(1)).max(at(2))
        })
    }

    fn below(self, distances: &[i32; 64], limit: i16) -> u64 {
        let bits = distances.iter().enumerate();
        bits.fold(0, |bits, (sample, &distance)| {
            bits | u64::from(distance < i32::from(limit)) << sample
        })
    }

    fn extent(self, parts: u64) -> [[f32; 4]; 2] {
        let mut extent = [[0.0; 4]; 2];
        for (axis, slabs) in SLABS.iter().enumerate() {
            let filled = slabs.iter().enumerate();
            let filled = filled.map(|(i, slab)| usize::from(parts & slab != 0) << i);
            let [middle, half] = &EXTENTS[axis][filled.sum::<usize>()];
            extent[0] = extent[0].add(*middle);
            extent[1] = extent[1].add(*half);
        }
        extent
    }

    fn steps(self, [x, y, w]: &[[f64; 4]; 3], centre: [f64; 2], unit: f64) -> [[f32; 4]; 2] {
        [
            std::array::from_fn(|j| ((centre[1] * w[j] - y[j]) * unit) as f32),
            std::array::from_fn(|j| ((x[j] - centre[0] * w[j]) * unit) as f32),
        ]
    }

    fn turned_parts(self, parts: u64, octant: u8) -> u64 {
        orders::turned_parts(parts, octant)
    }

    fn spread(self, bytes: u64, mask: u8) -> (u64, u64) {
        let (mut spread, mut ones, mut left) = (0, 0, bytes);
        for place in (0..8).filter(|place| mask >> place & 1 != 0) {
            ones |= 0xff << (8 * place);
            spread |= (left & 0xff) << (8 * place);
            left >>= 8;
        }
        (spread, ones)
    }

    #[inline(always)]
    fn prefetch<T>(self, _: &[T], _: usize) {}

    fn put(self, rows: &mut [u32], first: usize, width: usize, samples: u64, value: u32) {
        let mut left = samples;
        while left != 0 {
            let bit = left.trailing_zeros() as usize;
            left &= left - 1;
            if let Some(entry) = rows.get_mut(first + (bit >> 3) * width + (bit & 7)) {
                *entry = value;
            }
        }
    }
}
