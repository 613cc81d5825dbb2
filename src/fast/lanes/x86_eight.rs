//! Steps on eight 32-bit lanes and on sixteen bytes, the same in both sets.
//!
//! SAFETY of all: an [`Avx2`] or [`Avx512`] is only made where AVX2 was found,
//! and only their steps call these. Loads are of as many entries as the array has.

use std::arch::x86_64::*;

use super::{Isa, Scalar};
use crate::fast::canvas::{Extent, Window, Windows};
use crate::fast::parts::ORDER_BYTES;
use crate::fast::subtree::{LANES, Subtree};
use crate::fast::tables::Coarse;
use crate::fast::walk::Bounds;

#[inline(always)]
pub(super) fn load(values: &[i32; LANES]) -> __m256i {
    // SAFETY: see above.
    unsafe { _mm256_loadu_si256(values.as_ptr().cast()) }
}

#[inline(always)]
pub(super) fn add(a: __m256i, b: __m256i) -> __m256i {
    // SAFETY: see above.
    unsafe { _mm256_add_epi32(a, b) }
}

#[inline(always)]
pub(super) fn sub(a: __m256i, b: __m256i) -> __m256i {
    // SAFETY: see above.
    unsafe { _mm256_sub_epi32(a, b) }
}

#[inline(always)]
pub(super) fn plus_times(a: __m256i, b: __m256i, times: i32) -> __m256i {
    // SAFETY: see above.
    unsafe { _mm256_add_epi32(a, _mm256_mullo_epi32(b, _mm256_set1_epi32(times))) }
}

#[inline(always)]
pub(super) fn store(values: __m256i) -> [i32; LANES] {
    let mut array = [0; LANES];
    // SAFETY: see above.
    unsafe { _mm256_storeu_si256(array.as_mut_ptr().cast(), values) };
    array
}

#[inline(always)]
pub(super) fn negative(a: __m256i) -> __m256i {
    // SAFETY: see above.
    unsafe { _mm256_sub_epi32(_mm256_setzero_si256(), a) }
}

#[inline(always)]
pub(super) fn plus_shifted(a: __m256i, b: __m256i, places: u32) -> __m256i {
    // SAFETY: see above.
    unsafe {
        let places = _mm_cvtsi32_si128(places as i32);
        _mm256_add_epi32(a, _mm256_sll_epi32(b, places))
    }
}

#[inline(always)]
pub(super) fn window(
    place: __m256i,
    bias: &[i32; 4],
    subtree: &Subtree,
    bounds: &Bounds,
) -> (Window, Extent) {
    let mut lines = [0i32; 4];
    // SAFETY: see above.
    let extent = unsafe {
        let load = |lanes: &[i32; 4]| lanes.as_ptr().cast::<__m128i>();
        let last = _mm256_extracti128_si256::<1>(place);
        let bits = _mm_cvtsi32_si128(subtree.box_bits as i32);
        let from_origin = _mm_sra_epi32(_mm_add_epi32(last, _mm_loadu_si128(load(bias))), bits);
        let line = _mm_add_epi32(from_origin, _mm_loadu_si128(load(&subtree.origin)));
        let line = _mm_max_epi32(line, _mm_loadu_si128(load(&bounds.least)));
        let line = _mm_min_epi32(line, _mm_loadu_si128(load(&bounds.greatest)));
        _mm_storeu_si128(lines.as_mut_ptr().cast(), line);
        let others = _mm_shuffle_epi32::<0b01_00_11_10>(line);
        // Last less first: the sign tells what is empty, the upper bits
        // what is more than a square.
        let more = _mm_sub_epi32(others, line);
        if _mm_testz_si128(more, _mm_setr_epi32(!7, !7, 0, 0)) != 0 {
            Extent::Square
        } else if _mm_movemask_ps(_mm_castsi128_ps(more)) & 0b11 != 0 {
            Extent::Empty
        } else {
            Extent::Large
        }
    };
    let [left, top, right, bottom] = lines;
    let window = Window {
        left,
        top,
        right,
        bottom,
    };
    (window, extent)
}

/// [`Isa::windows`].
#[inline(always)]
pub(super) fn windows(
    place: &[i32; LANES],
    left: u32,
    bias: &[i32; 4],
    subtree: &Subtree,
    bounds: &Bounds,
) -> Windows {
    let mut windows = Windows {
        left: [0; 8],
        top: [0; 8],
        right: [0; 8],
        bottom: [0; 8],
        shape: [0; 8],
        tile: [0; 8],
        held: 0,
        square: 0,
    };
    // SAFETY: see above.
    unsafe {
        let bits = _mm_cvtsi32_si128(subtree.box_bits as i32);
        let left = _mm_cvtsi32_si128(left as i32);
        let centre = |i: usize| {
            let offset = _mm256_sll_epi32(load(&subtree.child_box[i]), left);
            _mm256_add_epi32(_mm256_set1_epi32(place[4 + i]), offset)
        };
        let line = |i: usize, centre: __m256i| {
            let biased = _mm256_add_epi32(centre, _mm256_set1_epi32(bias[i]));
            let from_origin = _mm256_sra_epi32(biased, bits);
            _mm256_add_epi32(from_origin, _mm256_set1_epi32(subtree.origin[i]))
        };
        let first = |i: usize, centre: __m256i| {
            _mm256_max_epi32(line(i, centre), _mm256_set1_epi32(bounds.least[i]))
        };
        let last = |i: usize, centre: __m256i| {
            _mm256_min_epi32(line(i, centre), _mm256_set1_epi32(bounds.greatest[i]))
        };
        let (across, down) = (centre(0), centre(1));
        let (left, top) = (first(0, across), first(1, down));
        let (right, bottom) = (last(2, across), last(3, down));
        let (across, down) = (_mm256_sub_epi32(right, left), _mm256_sub_epi32(bottom, top));
        // The sign tells what is empty, the upper bits what is more than a square.
        let both = _mm256_or_si256(across, down);
        let more = _mm256_andnot_si256(_mm256_set1_epi32(7), both);
        let square = _mm256_cmpeq_epi32(more, _mm256_setzero_si256());
        let row = _mm256_srai_epi32::<3>(top);
        let from_left = _mm256_srai_epi32::<3>(left);
        let rows = _mm256_mullo_epi32(row, _mm256_set1_epi32(bounds.tiles_across));
        let column = _mm256_sub_epi32(from_left, _mm256_set1_epi32(bounds.first_tile));
        let tile = _mm256_add_epi32(rows, column);
        let shape = _mm256_add_epi32(_mm256_slli_epi32::<3>(down), across);
        let put = |to: &mut [i32; 8], lanes: __m256i| {
            _mm256_storeu_si256(to.as_mut_ptr().cast(), lanes);
        };
        put(&mut windows.left, left);
        put(&mut windows.top, top);
        put(&mut windows.right, right);
        put(&mut windows.bottom, bottom);
        put(&mut windows.shape, shape);
        put(&mut windows.tile, tile);
        windows.held = !_mm256_movemask_ps(_mm256_castsi256_ps(both)) as u8;
        windows.square = _mm256_movemask_ps(_mm256_castsi256_ps(square)) as u8;
    }
    windows
}

/// [`Isa::samples_between`] of halves of places.
#[inline(always)]
pub(super) fn samples_between(x: [__m256d; 2], y: [__m256d; 2], margin: f64) -> Window {
    let mut lines = [0i32; 4];
    // SAFETY: see above.
    unsafe {
        // What is last is what is first of the negative.
        let negative = _mm256_set1_pd(-0.0);
        let left = _mm256_min_pd(x[0], x[1]);
        let right = _mm256_xor_pd(negative, _mm256_max_pd(x[0], x[1]));
        let top = _mm256_min_pd(y[0], y[1]);
        let bottom = _mm256_xor_pd(negative, _mm256_max_pd(y[0], y[1]));
        let across = _mm256_min_pd(
            _mm256_unpacklo_pd(left, right),
            _mm256_unpackhi_pd(left, right),
        );
        let down = _mm256_min_pd(
            _mm256_unpacklo_pd(top, bottom),
            _mm256_unpackhi_pd(top, bottom),
        );
        let first = _mm256_min_pd(
            _mm256_permute2f128_pd::<0x20>(across, down),
            _mm256_permute2f128_pd::<0x31>(across, down),
        );
        // Sample i is at i + 1/2.
        let first = _mm256_sub_pd(first, _mm256_setr_pd(0.5, -0.5, 0.5, -0.5));
        let first = _mm256_ceil_pd(_mm256_sub_pd(first, _mm256_set1_pd(margin)));
        let far = _mm256_set1_pd((1 << 30) as f64);
        let first = _mm256_max_pd(first, _mm256_xor_pd(negative, far));
        let first = _mm256_cvtpd_epi32(_mm256_min_pd(first, far));
        _mm_storeu_si128(lines.as_mut_ptr().cast(), first);
    }
    let [left, less_right, top, less_bottom] = lines;
    Window {
        left,
        top,
        right: -less_right,
        bottom: -less_bottom,
    }
}

#[inline(always)]
pub(super) fn byte_table(table: &mut [u8; 64], children: &[i32; 8], shift: u32, few: bool) {
    // SAFETY: see above; the stores are of 8 and of twice 32 bytes, and
    // the table has 64.
    unsafe {
        let child = _mm256_loadu_si256(children.as_ptr().cast());
        let shift = _mm_cvtsi32_si128(shift as i32);
        // The lowest byte of each lane, in the lowest four bytes of each half.
        let lowest = _mm256_setr_epi8(
            0, 4, 8, 12, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, //
            -1, -1, -1, -1, 0, 4, 8, 12, -1, -1, -1, -1, -1, -1, -1, -1,
        );
        let inner = _mm256_shuffle_epi8(_mm256_sra_epi32(child, shift), lowest);
        let inner = _mm_or_si128(
            _mm256_castsi256_si128(inner),
            _mm256_extracti128_si256::<1>(inner),
        );
        if few {
            _mm_storel_epi64(table.as_mut_ptr().cast(), inner);
            return;
        }
        let doubled = _mm256_add_epi32(child, child);
        let outer = _mm256_shuffle_epi8(_mm256_sra_epi32(doubled, shift), lowest);
        let outer = _mm_or_si128(
            _mm256_castsi256_si128(outer),
            _mm256_extracti128_si256::<1>(outer),
        );
        let outer = _mm256_broadcastq_epi64(outer);
        let inner = _mm256_broadcastq_epi64(inner);
        // Bytes 0 to 3, and 4 to 7, eight times each.
        let first = _mm256_setr_epi8(
            0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, //
            2, 2, 2, 2, 2, 2, 2, 2, 3, 3, 3, 3, 3, 3, 3, 3,
        );
        let second = _mm256_add_epi8(first, _mm256_set1_epi8(4));
        let low = _mm256_add_epi8(_mm256_shuffle_epi8(outer, first), inner);
        let high = _mm256_add_epi8(_mm256_shuffle_epi8(outer, second), inner);
        _mm256_storeu_si256(table.as_mut_ptr().cast(), low);
        _mm256_storeu_si256(table.as_mut_ptr().add(32).cast(), high);
    }
}

#[inline(always)]
pub(super) fn square_of(tiles: &[u64], at: usize, across: usize, x: u32, y: u32) -> [u64; 2] {
    let last = tiles.len().checked_sub(across + 2);
    if last.is_none_or(|last| at > last) {
        return Scalar.square_of(tiles, at, across, x, y);
    }
    // SAFETY: see above; the loads are of two entries each, the last of
    // which is in the slice.
    unsafe {
        let upper = _mm_loadu_si128(tiles.as_ptr().add(at).cast());
        let lower = _mm_loadu_si128(tiles.as_ptr().add(at + across).cast());
        let up = _mm_cvtsi32_si128(8 * y as i32);
        let down = _mm_cvtsi32_si128(64 - 8 * y as i32);
        // A shift by 64 leaves nothing.
        let both = _mm_or_si128(_mm_srl_epi64(upper, up), _mm_sll_epi64(lower, down));
        let (left, right) = (_mm_cvtsi128_si64(both), _mm_extract_epi64::<1>(both));
        [left as u64 >> x, (right as u64) << (8 - x)]
    }
}

#[inline(always)]
pub(super) fn square_table(table: &mut [i16; 64], across: i32, down: i32) {
    // SAFETY: see above; the stores are of eight times 8 entries, all
    // that the table has.
    unsafe {
        let columns = _mm_setr_epi16(0, 1, 2, 3, 4, 5, 6, 7);
        let down = _mm_set1_epi16(down as i16);
        let mut row = _mm_mullo_epi16(columns, _mm_set1_epi16(across as i16));
        for y in 0..8 {
            _mm_storeu_si128(table.as_mut_ptr().add(8 * y).cast(), row);
            row = _mm_add_epi16(row, down);
        }
    }
}

#[inline(always)]
pub(super) fn spread(bytes: u64, exist: u64) -> u64 {
    // SAFETY: see above; both sets have BMI2.
    unsafe { _pdep_u64(bytes, exist) }
}

#[inline(always)]
pub(super) fn masks_in_order(masks: u64, octant: u8) -> u64 {
    let [low, high, order] = &ORDER_BYTES[usize::from(octant & 7)];
    // SAFETY: see above.
    unsafe {
        let nibble = _mm_set1_epi8(0x0f);
        let bytes = _mm_cvtsi64_si128(masks as i64);
        let lower = _mm_and_si128(bytes, nibble);
        let upper = _mm_and_si128(_mm_srli_epi16::<4>(bytes), nibble);
        let from_lower = _mm_shuffle_epi8(_mm_loadu_si128(low.as_ptr().cast()), lower);
        let from_upper = _mm_shuffle_epi8(_mm_loadu_si128(high.as_ptr().cast()), upper);
        let masks = _mm_or_si128(from_lower, from_upper);
        let masks = _mm_shuffle_epi8(masks, _mm_loadu_si128(order.as_ptr().cast()));
        _mm_cvtsi128_si64(masks) as u64
    }
}

#[inline(always)]
pub(super) fn all_within(a: __m256i, b: __m256i) -> bool {
    // SAFETY: see above.
    unsafe {
        let within = _mm256_cmpeq_epi32(_mm256_min_epu32(a, b), a);
        _mm256_movemask_epi8(within) == -1
    }
}

#[inline(always)]
pub(super) fn bits(lanes: __m128i) -> u64 {
    // SAFETY: see above.
    unsafe { u64::from(_mm_movemask_epi8(lanes) as u32) }
}

/// The values of the three strips, cut to bytes, in the first bytes of
/// four lanes.
#[inline(always)]
pub(super) fn cut(coarse: &Coarse, start: __m256i) -> __m128i {
    // SAFETY: see above.
    unsafe {
        let shift = _mm_loadu_si128(coarse.shift.as_ptr().cast());
        _mm_srav_epi32(_mm256_castsi256_si128(start), shift)
    }
}

/// The first sixteen lanes within all three strips.
#[inline(always)]
pub(super) fn few_strips(coarse: &Coarse, start: __m256i) -> u64 {
    let cut = cut(coarse, start);
    // SAFETY: see above; a table has more than 16 entries, a width too.
    unsafe {
        let mut beyond = _mm_setzero_si128();
        for f in 0..3 {
            let start = _mm_shuffle_epi8(cut, _mm_set1_epi8(4 * f as i8));
            let entries = _mm_loadu_si128(coarse.parts[f].as_ptr().cast());
            let width = _mm_loadu_si128(coarse.width[f].as_ptr().cast());
            let value = _mm_sub_epi8(start, entries);
            beyond = _mm_or_si128(beyond, _mm_subs_epu8(value, width));
        }
        bits(_mm_cmpeq_epi8(beyond, _mm_setzero_si128()))
    }
}

/// What both sets do the same way.
macro_rules! eight_lanes {
    () => {
        type Eight = __m256i;

        #[inline(always)]
        fn load(self, values: &[i32; LANES]) -> __m256i {
            eight::load(values)
        }

        #[inline(always)]
        fn add(self, a: __m256i, b: __m256i) -> __m256i {
            eight::add(a, b)
        }

        #[inline(always)]
        fn sub(self, a: __m256i, b: __m256i) -> __m256i {
            eight::sub(a, b)
        }

        #[inline(always)]
        fn plus_times(self, a: __m256i, b: __m256i, times: i32) -> __m256i {
            eight::plus_times(a, b, times)
        }

        #[inline(always)]
        fn store(self, values: __m256i) -> [i32; LANES] {
            eight::store(values)
        }

        #[inline(always)]
        fn negative(self, a: __m256i) -> __m256i {
            eight::negative(a)
        }

        #[inline(always)]
        fn plus_shifted(self, a: __m256i, b: __m256i, places: u32) -> __m256i {
            eight::plus_shifted(a, b, places)
        }

        #[inline(always)]
        fn window(
            self,
            place: __m256i,
            bias: &[i32; 4],
            subtree: &Subtree,
            bounds: &Bounds,
        ) -> (Window, Extent) {
            eight::window(place, bias, subtree, bounds)
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
            eight::windows(place, left, bias, subtree, bounds)
        }

        #[inline(always)]
        fn byte_table(self, table: &mut [u8; 64], children: &[i32; 8], shift: u32, few: bool) {
            eight::byte_table(table, children, shift, few);
        }

        #[inline(always)]
        fn square_of(self, tiles: &[u64], at: usize, across: usize, x: u32, y: u32) -> [u64; 2] {
            eight::square_of(tiles, at, across & 0xffff, x & 7, y & 7)
        }

        #[inline(always)]
        fn square_table(self, table: &mut [i16; 64], across: i32, down: i32) {
            eight::square_table(table, across, down);
        }

        #[inline(always)]
        fn spread(self, bytes: u64, _: u8, exist: u64) -> u64 {
            eight::spread(bytes, exist)
        }

        #[inline(always)]
        fn masks_in_order(self, masks: u64, octant: u8) -> u64 {
            eight::masks_in_order(masks, octant)
        }

        #[inline(always)]
        fn all_within(self, a: __m256i, b: __m256i) -> bool {
            eight::all_within(a, b)
        }
    };
}

pub(super) use eight_lanes;
