//! The scalar twin: plain Rust, on any processor.

use super::Isa;
use super::reals::ScalarReals;
use crate::fast::brick;
use crate::fast::canvas::{Extent, TILE_LOG2, Window, Windows};
use crate::fast::clip::{self, ClipRecord};
use crate::fast::parts::{self, Parts};
use crate::fast::planes::Exact;
use crate::fast::screen::{self, ScreenRecord};
use crate::fast::subtree::{LANES, STRIPS, Subtree};
use crate::fast::tables::{self, Coarse, Tables};
use crate::fast::tall;
use crate::fast::walk::{Bounds, Walk};

/// No instructions but those that every processor of the target has.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scalar;

impl Isa for Scalar {
    fn clip(self, walk: &mut Walk<'_, Self>, record: &ClipRecord) {
        clip::turn(walk, record);
    }

    fn screen(self, walk: &mut Walk<'_, Self>, subtree: &Subtree, record: &ScreenRecord) {
        screen::turn(walk, subtree, record);
    }

    fn absent(self, walk: &mut Walk<'_, Self>, subtree: &Subtree, record: &ScreenRecord) {
        screen::look_at_absent(walk, subtree, record);
    }

    fn brick(
        self,
        walk: &mut Walk<'_, Self>,
        subtree: &Subtree,
        record: &ScreenRecord,
        octant: u8,
        parts: &Parts,
    ) {
        brick::draw_node(walk, subtree, record, octant, parts);
    }

    fn tall(
        self,
        walk: &mut Walk<'_, Self>,
        subtree: &Subtree,
        record: &ScreenRecord,
        octant: u8,
        parts: &Parts,
    ) {
        tall::draw_node(walk, subtree, record, octant, parts);
    }

    fn tables(self, tables: &mut Tables, subtree: &Subtree, left: u32, octant: u8) {
        tables.make_parts(self, subtree, left, octant);
    }

    fn tiles(self, walk: &mut Walk<'_, Self>, subtree: &Subtree, record: &ScreenRecord) {
        screen::draw_tiles(walk, subtree, record);
    }

    fn change(self, walk: &mut Walk<'_, Self>, record: &ClipRecord) -> bool {
        clip::change(walk, record)
    }

    fn covers(self, exact: &Exact, min: [i32; 3], side: i32, sample: [i32; 2]) -> bool {
        exact.covers(min, side, sample)
    }

    type Reals = ScalarReals;

    #[inline(always)]
    fn reals(self, values: &[f64; 8]) -> ScalarReals {
        ScalarReals(*values)
    }

    #[inline(always)]
    fn real(self, value: f64) -> ScalarReals {
        ScalarReals([value; 8])
    }

    #[inline(always)]
    fn whole(self, values: ScalarReals) -> [i32; LANES] {
        values.0.map(|value| value as i32)
    }

    #[inline(always)]
    fn samples_between(self, x: ScalarReals, y: ScalarReals, margin: f64) -> Window {
        const FAR: f64 = (1 << 30) as f64;
        let first = |places: &[f64; 8]| {
            let least = places.iter().copied().fold(f64::INFINITY, f64::min);
            // Sample i is at i + 1/2.
            ((least - 0.5) - margin).ceil().clamp(-FAR, FAR) as i32
        };
        let last = |places: &[f64; 8]| {
            let greatest = places.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            ((greatest - 0.5) + margin).floor().clamp(-FAR, FAR) as i32
        };
        Window {
            left: first(&x.0),
            top: first(&y.0),
            right: last(&x.0),
            bottom: last(&y.0),
        }
    }

    type Eight = [i32; LANES];

    #[inline(always)]
    fn load(self, values: &[i32; LANES]) -> [i32; LANES] {
        *values
    }

    #[inline(always)]
    fn add(self, a: [i32; LANES], b: [i32; LANES]) -> [i32; LANES] {
        std::array::from_fn(|i| a[i].wrapping_add(b[i]))
    }

    #[inline(always)]
    fn sub(self, a: [i32; LANES], b: [i32; LANES]) -> [i32; LANES] {
        std::array::from_fn(|i| a[i].wrapping_sub(b[i]))
    }

    #[inline(always)]
    fn plus_times(self, a: [i32; LANES], b: [i32; LANES], times: i32) -> [i32; LANES] {
        std::array::from_fn(|i| a[i].wrapping_add(b[i].wrapping_mul(times)))
    }

    #[inline(always)]
    fn store(self, values: [i32; LANES]) -> [i32; LANES] {
        values
    }

    #[inline(always)]
    fn negative(self, a: [i32; LANES]) -> [i32; LANES] {
        std::array::from_fn(|i| a[i].wrapping_neg())
    }

    #[inline(always)]
    fn plus_shifted(self, a: [i32; LANES], b: [i32; LANES], places: u32) -> [i32; LANES] {
        std::array::from_fn(|i| a[i].wrapping_add(b[i] << places))
    }

    #[inline(always)]
    fn window(
        self,
        place: [i32; LANES],
        bias: &[i32; 4],
        subtree: &Subtree,
        bounds: &Bounds,
    ) -> (Window, Extent) {
        let [left, top, right, bottom]: [i32; 4] = std::array::from_fn(|i| {
            let line = (place[4 + i].wrapping_add(bias[i]) >> subtree.box_bits) + subtree.origin[i];
            line.max(bounds.least[i]).min(bounds.greatest[i])
        });
        let window = Window {
            left,
            top,
            right,
            bottom,
        };
        (window, window.extent())
    }

    #[inline(always)]
    fn windows(
        self,
        place: &[i32; LANES],
        left: u32,
        bias: &[i32; 4],
        subtree: &Subtree,
        bounds: &Bounds,
    ) -> Windows {
        let line = |i: usize| -> [i32; 8] {
            std::array::from_fn(|octant| {
                let place = place[4 + i].wrapping_add(subtree.child_box[i & 1][octant] << left);
                let line = (place.wrapping_add(bias[i]) >> subtree.box_bits) + subtree.origin[i];
                line.max(bounds.least[i]).min(bounds.greatest[i])
            })
        };
        let (first_column, first_row, last_column, last_row) = (line(0), line(1), line(2), line(3));
        let mut windows = Windows {
            left: first_column,
            top: first_row,
            right: last_column,
            bottom: last_row,
            shape: [0; 8],
            tile: [0; 8],
            held: 0,
            square: 0,
        };
        for octant in 0..8 {
            let window = windows.at(octant);
            let (across, down) = (window.right - window.left, window.bottom - window.top);
            windows.shape[octant] = (down << 3) + across;
            windows.tile[octant] = (window.top >> TILE_LOG2)
                .wrapping_mul(bounds.tiles_across)
                .wrapping_add(window.left >> TILE_LOG2)
                .wrapping_sub(bounds.first_tile);
            windows.held |= u8::from(!window.is_empty()) << octant;
            windows.square |= u8::from(window.extent() == Extent::Square) << octant;
        }
        windows
    }

    #[inline(always)]
    fn square_within(
        self,
        tables: &[[i16; 64]; STRIPS],
        start: [i32; LANES],
        bound: &[i32; LANES],
    ) -> u64 {
        let mut samples = u64::MAX;
        for f in 0..STRIPS {
            let (start, width) = (start[f] as i16, (2 * bound[f]) as u16);
            for (i, &entry) in tables[f].iter().enumerate() {
                if start.wrapping_add(entry) as u16 > width {
                    samples &= !(1 << i);
                }
            }
        }
        samples
    }

    #[inline(always)]
    fn all_within(self, a: [i32; LANES], b: [i32; LANES]) -> bool {
        a.iter().zip(&b).all(|(&a, &b)| a as u32 <= b as u32)
    }

    #[inline(always)]
    fn strips_within(self, coarse: &Coarse, start: [i32; LANES], few: bool) -> u64 {
        let mut lanes = u64::MAX;
        for f in 0..STRIPS {
            let byte = (start[f] >> coarse.shift[f]) as u8;
            let width = coarse.width[f][0];
            let count = if few { 8 } else { 64 };
            for (i, &entry) in coarse.parts[f].iter().enumerate().take(count) {
                if byte.wrapping_sub(entry) > width {
                    lanes &= !(1 << i);
                }
            }
        }
        lanes
    }

    #[inline(always)]
    fn byte_table(self, table: &mut [u8; 64], children: &[i32; 8], shift: u32, few: bool) {
        tables::byte_table(table, children, shift, few);
    }

    #[inline(always)]
    fn put(self, rows: &mut [u32], first: usize, width: usize, samples: u64, value: u32) {
        let mut left = samples;
        while left != 0 {
            let bit = left.trailing_zeros() as usize;
            left &= left - 1;
            rows[first + (bit >> 3) * width + (bit & 7)] = value;
        }
    }

    #[inline(always)]
    fn square_of(self, tiles: &[u64], at: usize, across: usize, x: u32, y: u32) -> [u64; 2] {
        let below = at.wrapping_add(across);
        let tile = |at: usize| tiles.get(at).copied().unwrap_or(0);
        let column = |upper: u64, lower: u64| match 8 * (y & 7) {
            0 => upper,
            down => upper >> down | lower << (64 - down),
        };
        let left = column(tile(at), tile(below));
        let right = column(tile(at.wrapping_add(1)), tile(below.wrapping_add(1)));
        [left >> (x & 7), right << (8 - (x & 7))]
    }

    #[inline(always)]
    fn children_within(
        self,
        tables: &[[i32; 8]; STRIPS + 2],
        value: [i32; LANES],
        width: &[i32; LANES],
    ) -> u8 {
        let mut inside = u8::MAX;
        for (f, by_child) in tables.iter().enumerate() {
            let lane = f + usize::from(f >= STRIPS);
            for (i, child) in by_child.iter().enumerate() {
                let is_beyond = value[lane].wrapping_sub(*child) as u32 > width[lane] as u32;
                inside &= !(u8::from(is_beyond) << i);
            }
        }
        inside
    }

    #[inline(always)]
    fn square_table(self, table: &mut [i16; 64], across: i32, down: i32) {
        for (i, entry) in table.iter_mut().enumerate() {
            let (x, y) = (i as i32 & 7, i as i32 >> 3);
            *entry = across.wrapping_mul(x).wrapping_add(down.wrapping_mul(y)) as i16;
        }
    }

    #[inline(always)]
    fn spread(self, bytes: u64, mask: u8, _: u64) -> u64 {
        let mut rest = bytes;
        let mut spread = 0;
        for bit in 0..8 {
            if mask >> bit & 1 != 0 {
                spread |= (rest & 0xff) << (8 * bit);
                rest >>= 8;
            }
        }
        spread
    }

    #[inline(always)]
    fn masks_in_order(self, masks: u64, octant: u8) -> u64 {
        parts::masks_in_order(masks, octant)
    }

    #[inline(always)]
    fn within_wide(self, table: &[i32; 64], start: i32, width: u32) -> u64 {
        let mut lanes = 0;
        for (i, &entry) in table.iter().enumerate() {
            lanes |= u64::from(start.wrapping_add(entry) as u32 <= width) << i;
        }
        lanes
    }
}
