//! Which of 64 parts of a node a line may go through: three look-ups.
//!
//! # The idea
//!
//! Seen along a line, a cube is a hexagon: where three strips overlap, one
//! along each kind of edge. A line of direction `v` (all `v_k >= 0`, by
//! orientation) that passes the centre of a node with the moment `m` goes
//! through the part whose centre lies at `t` (in sides of a part) exactly if,
//! for each axis j with `n`, `l` the next two (modulo 3),
//!
//! ```text
//! |m_j - (t_n v_l - t_l v_n)| < (v_n + v_l) / 2
//! ```
//!
//! Divided by `v_n + v_l`, a strip is 1 wide, and where the 16 different strips
//! of a function lie depends on one number alone, the share `s = v_l / (v_n + v_l)`:
//! at `t_n s - t_l (1 - s)`. So one table for each share, made once for all
//! frames, says for each cell of the value which of the 64 parts may be met;
//! the three functions' answers and which parts exist are put together by `and`.
//!
//! Parts are numbered so that a line meets lower ones first: `outer << 3 |
//! inner`, each an octant in Morton order, with bits turned where the line
//! runs downwards.
//!
//! # What the margin has room for
//!
//! A table's strips are wider than the truth by a margin on either side: what is
//! found is a few parts too many and never one too few. `spec/fast.md` derives it.

use std::sync::LazyLock;

/// Shares that there are tables for: from 0 to 1, both included.
const SHARES: usize = 128;
/// Steps of the share between them.
pub(super) const SHARE_STEPS: f32 = (SHARES - 1) as f32;
/// Cells of a strip's width.
pub(super) const CELLS_PER_WIDTH: f32 = 30.0;
/// Cells of a table. They reach 2.13 widths to either side of the node's centre.
pub(super) const CELLS: usize = 128;
/// The cell of a line through the node's centre.
pub(super) const MIDDLE: f32 = 64.0;

/// Classes of tables.
const CLASSES: usize = 3;
/// Margins that there are tables for, in widths.
const MARGINS: [f32; CLASSES] = [1.0 / 32.0, 1.0 / 16.0, 1.0 / 8.0];
/// Of a margin, what the rounding of the share and of the cell's number needs:
/// at most `3 / 2 SHARE_STEPS`, and 1/512.
const ROUNDING: f32 = 1.5 / SHARE_STEPS + 1.0 / 512.0;
/// By how many widths values may be wrong, for each margin.
pub(super) const MOST_ERROR: [f32; CLASSES] = [
    MARGINS[0] - ROUNDING,
    MARGINS[1] - ROUNDING,
    MARGINS[2] - ROUNDING,
];

/// Tables of one margin.
const PER_MARGIN: usize = 3 * SHARES;
/// The table that excludes no part.
const BLIND: usize = MARGINS.len() * PER_MARGIN;

/// By cell, parts.
pub(super) type Row = [u64; CELLS];

/// The tables: by margin, axis and share, and the blind one.
#[derive(Debug)]
pub(super) struct Strips {
    /// Parts whose strip the cell may lie in.
    touched: Vec<Row>,
    /// Parts whose strip reaches the cell or beyond it.
    ends_above: Vec<Row>,
    /// Parts whose strip begins in the cell or below it.
    begins_below: Vec<Row>,
}

/// The tables, made when they are first wanted.
pub(super) static STRIPS: LazyLock<Strips> = LazyLock::new(Strips::new);

/// Place of a part along an axis, 0 to 3.
pub(super) const fn along(part: usize, axis: usize) -> usize {
    (part >> (5 - axis) & 1) << 1 | part >> (2 - axis) & 1
}

/// By axis and place along it, the parts there.
static AT: [[u64; 4]; 3] = {
    let mut at = [[0; 4]; 3];
    let mut number = 0;
    while number < 3 * 64 {
        let (axis, part) = (number / 64, number % 64);
        at[axis][along(part, axis)] |= 1 << part;
        number += 1;
    }
    at
};

impl Strips {
    fn new() -> Self {
        let mut strips = Self {
            touched: vec![[0; CELLS]; BLIND + 1],
            ends_above: vec![[0; CELLS]; BLIND + 1],
            begins_below: vec![[0; CELLS]; BLIND + 1],
        };
        for (class, margin) in MARGINS.into_iter().enumerate() {
            for axis in 0..3 {
                for share in 0..SHARES {
                    let at = Self::table(axis, share, class);
                    strips.fill(at, axis, share as f32 / SHARE_STEPS, margin);
                }
            }
        }
        strips.touched[BLIND] = [u64::MAX; CELLS];
        strips.ends_above[BLIND] = [u64::MAX; CELLS];
        strips.begins_below[BLIND] = [u64::MAX; CELLS];
        strips
    }

    /// Makes the tables of an axis for a share and a margin: notes where strips begin and end, then
    /// adds up, upwards the parts that have begun and downwards those that have not ended.
    fn fill(&mut self, at: usize, axis: usize, share: f32, margin: f32) {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        let (begun, ends) = (&mut self.begins_below[at], &mut self.ends_above[at]);
        for place in 0..16 {
            let (a, b) = (place & 3, place >> 2);
            let parts = AT[next][a] & AT[last][b];
            let centre = (a as f32 - 1.5) * share - (b as f32 - 1.5) * (1.0 - share);
            let cell = |end: f32| (end * CELLS_PER_WIDTH + MIDDLE) as usize;
            begun[cell(centre - 0.5 - margin)] |= parts;
            ends[cell(centre + 0.5 + margin)] |= parts;
        }
        for cell in 1..CELLS {
            begun[cell] |= begun[cell - 1];
            ends[CELLS - 1 - cell] |= ends[CELLS - cell];
        }
        for (touched, (begun, ends)) in self.touched[at].iter_mut().zip(begun.iter().zip(ends)) {
            *touched = *begun & *ends;
        }
    }

    /// The number of the table of an axis for a share, in steps, and for values that may be wrong
    /// as [`MOST_ERROR`] says of a class.
    #[inline(always)]
    pub(super) fn table(axis: usize, share: usize, class: usize) -> usize {
        class * PER_MARGIN + axis * SHARES + share
    }

    /// The blind table's number.
    pub(super) const BLIND: usize = BLIND;

    /// By cell, the parts that may be met, of three tables.
    #[inline(always)]
    pub(super) fn touched(&self, tables: [usize; 3]) -> [&Row; 3] {
        tables.map(|table| &self.touched[table])
    }

    /// The parts that a line may meet whose values lie in these cells or between them.
    #[inline(always)]
    pub(super) fn between(&self, tables: [usize; 3], low: [usize; 3], high: [usize; 3]) -> u64 {
        let mut parts = u64::MAX;
        for j in 0..3 {
            parts &= self.ends_above[tables[j]][low[j] % CELLS];
            parts &= self.begins_below[tables[j]][high[j] % CELLS];
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The parts that a line with this value of function `axis` and share meets.
    fn met(axis: usize, share: f64, value: f64) -> u64 {
        let mut parts = 0;
        for part in 0..64 {
            let t = |axis: usize| along(part, axis % 3) as f64 - 1.5;
            let centre = t(axis + 1) * share - t(axis + 2) * (1.0 - share);
            parts |= u64::from((value - centre).abs() < 0.5) << part;
        }
        parts
    }

    /// Whether tables leave out a part of a line whose values are wrong by `error`.
    fn leave_a_part_out(class: usize, error: f64) -> bool {
        let strips = &*STRIPS;
        let mut left_out = false;
        // Shares at the steps' ends, where they are rounded most.
        let steps = 2 * SHARES - 2;
        for (axis, step) in (0..3).flat_map(|axis| (0..=steps).map(move |step| (axis, step))) {
            let share = (step as f64 - 0.02 * (step & 1) as f64) / steps as f64;
            let steps = (share * f64::from(SHARE_STEPS) + 0.5) as usize;
            let table = Strips::table(axis, steps, class);
            for place in -2600..=2600 {
                let value = f64::from(place) / 1000.0;
                let parts = met(axis, share, value);
                for wrong in [-error, 0.0, error] {
                    let cell = (value + wrong) * f64::from(CELLS_PER_WIDTH) + f64::from(MIDDLE);
                    let cell = cell.clamp(0.0, 127.0) as usize;
                    let found = strips.touched([table; 3])[0][cell];
                    left_out |= parts & !found != 0;
                    assert_eq!(found, strips.between([table; 3], [cell; 3], [cell; 3]));
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
            // With a tenth of the margin less they would.
            assert!(leave_a_part_out(class, most + f64::from(margin) / 10.0));
        }
    }
}
