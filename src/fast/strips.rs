//! Strips: three table look-ups give the parts of a node that a line may meet (`spec/fast.md`, section 3).
//!
//! Seen along a line, a part is a hexagon: three strips, one along each kind of edge. With `v` and `m` the line's Plücker
//! coordinates (`lines.rs`) and `n`, `l` the axes after j, the line is in the strips of the part at `t` if for each j
//!
//! ```text
//! |m_j - (t_n v_l - t_l v_n)| < (v_n + v_l) / 2
//! ```
//!
//! Divided by `v_n + v_l`, a strip is 1 wide and lies at `t_n s - t_l (1 - s)`, with the share `s = v_l / (v_n + v_l)`. A
//! table per share has for each cell of the value the parts whose strip, with a margin, it may lie in.
//!
//! Parts are numbered `outer << 3 | inner`, with bits turned where the line runs downwards, so that a line meets lower
//! numbers first.

use std::sync::OnceLock;

use super::lanes::{Floats, Isa, Lanes, Tests};
use super::orders::SLABS;
use super::window::bits;

pub(super) const SHARES: usize = 128;
pub(super) const SHARE_STEPS: f32 = (SHARES - 1) as f32;
pub(super) const CELLS_PER_WIDTH: f32 = 30.0;
/// They reach 2.13 widths to either side of the node's centre.
pub(super) const CELLS: usize = 128;
const PER_GROUP: usize = 4;
const GROUPS: usize = CELLS / PER_GROUP;
pub(super) const MIDDLE: f32 = 64.0;

const CLASSES: usize = 3;
const MARGINS: [f32; CLASSES] = [1.0 / 32.0, 1.0 / 16.0, 1.0 / 8.0];
/// Rounding of the share, at most `3 / 2 SHARE_STEPS`, and of the cell's number.
const ROUNDING: f32 = 1.5 / SHARE_STEPS + 1.0 / 512.0;
/// Allowed error of values, in widths, by margin.
pub(super) const MOST_ERROR: [f32; CLASSES] = [
    MARGINS[0] - ROUNDING,
    MARGINS[1] - ROUNDING,
    MARGINS[2] - ROUNDING,
];

pub(super) type Row = [u64; CELLS];

/// The strips of a function, by cell of its value.
#[derive(Debug)]
pub(super) struct Strips {
    /// Parts whose strip touches the cell.
    pub(super) touched: Row,
    /// Parts whose strip reaches some cell of a group, or beyond. Groups keep tables small: caches hold more of them.
    ends_above: [u64; GROUPS],
    /// Parts whose strip begins in some cell of a group, or below.
    begins_below: [u64; GROUPS],
}

/// By margin, axis and share. Made when first used, as a small picture uses few.
static STRIPS: [[[OnceLock<Box<Strips>>; SHARES]; 3]; CLASSES] =
    [const { [const { [const { OnceLock::new() }; SHARES] }; 3] }; CLASSES];

pub(super) static BLIND: Strips = Strips {
    touched: [u64::MAX; CELLS],
    ends_above: [u64::MAX; GROUPS],
    begins_below: [u64::MAX; GROUPS],
};

/// Parts by sample, and the cells of its three functions.
#[derive(Debug)]
#[repr(C, align(32))]
pub(super) struct Candidates(pub(super) [u64; 64], pub(super) [[[u32; 8]; 8]; 3]);

impl Candidates {
    /// Looks up the parts among `wanted` by open sample. Returns the samples that have any, and the parts of all. `cells`:
    /// the functions in cells, at the first sample, and their slopes by column and by row.
    #[inline(always)]
    pub(super) fn look_up<I: Isa>(
        &mut self,
        isa: I,
        tables: [&Row; 3],
        cells: &[I::F32x4; 3],
        wanted: u64,
        open: u64,
    ) -> [u64; 2] {
        let [mut x, mut y, mut z] = [
            first_row::<I, 0>(isa, cells),
            first_row::<I, 1>(isa, cells),
            first_row::<I, 2>(isa, cells),
        ];
        let rows = 8 - open.leading_zeros() as usize / 8;
        for row in 0..rows {
            self.1[0][row] = x.0.indices::<CELLS>();
            self.1[1][row] = y.0.indices::<CELLS>();
            self.1[2][row] = z.0.indices::<CELLS>();
            x.0 = x.0.add(x.1);
            y.0 = y.0.add(y.1);
            z.0 = z.0.add(z.1);
        }
        // Gathers are slow on AMD.
        let [x, y, z] = self.1.each_ref().map(|rows| rows.as_flattened());
        let (mut any, mut all) = (0, 0);
        for bit in bits(open) {
            let cell = |of: &[u32]| of[bit] as usize % CELLS;
            let parts = wanted & tables[0][cell(x)] & tables[1][cell(y)] & tables[2][cell(z)];
            self.0[bit] = parts;
            any |= u64::from(parts != 0) << bit;
            all |= parts;
        }
        [any, all]
    }
}

#[inline(always)]
fn first_row<I: Isa, const FUNCTION: i32>(
    isa: I,
    [first, step_x, step_y]: &[I::F32x4; 3],
) -> (I::F32x8, I::F32x8) {
    let columns = I::F32x8::load(isa, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    let first = isa.broadcast::<FUNCTION>(*first);
    let step_x = isa.broadcast::<FUNCTION>(*step_x);
    (
        step_x.fma(columns, first),
        isa.broadcast::<FUNCTION>(*step_y),
    )
}

impl Strips {
    /// `class` of [`MOST_ERROR`], `share` in steps.
    #[inline(always)]
    pub(super) fn of(class: usize, axis: usize, share: usize) -> &'static Self {
        let new = || Self::new(axis, share as f32 / SHARE_STEPS, MARGINS[class]);
        STRIPS[class][axis][share].get_or_init(new)
    }

    #[inline(never)]
    fn new(axis: usize, share: f32, margin: f32) -> Box<Self> {
        let [mut begun, mut ends] = [[0; CELLS]; 2];
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        for place in 0..16 {
            let (a, b) = (place & 3, place >> 2);
            let parts = SLABS[next][a] & SLABS[last][b];
            let centre = (a as f32 - 1.5) * share - (b as f32 - 1.5) * (1.0 - share);
            let cell = |end: f32| (end * CELLS_PER_WIDTH + MIDDLE) as usize;
            begun[cell(centre - 0.5 - margin)] |= parts;
            ends[cell(centre + 0.5 + margin)] |= parts;
        }
        for cell in 1..CELLS {
            begun[cell] |= begun[cell - 1];
            ends[CELLS - 1 - cell] |= ends[CELLS - cell];
        }
        Box::new(Self {
            touched: std::array::from_fn(|cell| begun[cell] & ends[cell]),
            ends_above: std::array::from_fn(|group| ends[group * PER_GROUP]),
            begins_below: std::array::from_fn(|group| begun[group * PER_GROUP + PER_GROUP - 1]),
        })
    }

    /// The parts that lines with values from cells to cells may meet.
    #[inline(always)]
    pub(super) fn between(strips: [&Self; 3], low: [usize; 3], high: [usize; 3]) -> u64 {
        let mut parts = u64::MAX;
        for j in 0..3 {
            parts &= strips[j].ends_above[low[j] / PER_GROUP % GROUPS];
            parts &= strips[j].begins_below[high[j] / PER_GROUP % GROUPS];
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fast::orders::along;

    fn met(axis: usize, share: f64, value: f64) -> u64 {
        let mut parts = 0;
        for part in 0..64 {
            let t = |axis: usize| along(part, axis % 3) as f64 - 1.5;
            let centre = t(axis + 1) * share - t(axis + 2) * (1.0 - share);
            parts |= u64::from((value - centre).abs() < 0.5) << part;
        }
        parts
    }

    fn leave_a_part_out(class: usize, error: f64) -> bool {
        let mut left_out = false;
        let steps = 2 * SHARES - 2;
        for (axis, step) in (0..3).flat_map(|axis| (0..=steps).map(move |step| (axis, step))) {
            let share = (step as f64 - 0.02 * (step & 1) as f64) / steps as f64;
            let steps = (share * f64::from(SHARE_STEPS) + 0.5) as usize;
            let strips = Strips::of(class, axis, steps);
            for place in -2600..=2600 {
                let value = f64::from(place) / 1000.0;
                let parts = met(axis, share, value);
                for wrong in [-error, 0.0, error] {
                    let cell = (value + wrong) * f64::from(CELLS_PER_WIDTH) + f64::from(MIDDLE);
                    let cell = cell.clamp(0.0, 127.0) as usize;
                    let found = strips.touched[cell];
                    left_out |= parts & !found != 0;
                    let between = Strips::between([strips; 3], [cell; 3], [cell; 3]);
                    assert_eq!(found & !between, 0);
                }
            }
        }
        left_out
    }

    #[test]
    fn tables_leave_no_part_out_whatever_is_wrong_within_their_margin() {
        for (class, margin) in MARGINS.into_iter().enumerate() {
            let most = f64::from(MOST_ERROR[class]);
            assert!(!leave_a_part_out(class, most));
            assert!(leave_a_part_out(class, most + f64::from(margin) / 10.0));
        }
    }
}
