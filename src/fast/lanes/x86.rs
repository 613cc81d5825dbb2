//! AVX2 and AVX-512, found at run time.

use std::arch::x86_64::*;

use super::{Isa, Scalar};
use super::x86_reals::{Avx2Reals, Avx512Reals};
use crate::fast::brick::{self, Coarse, ORDER_BYTES, Parts, Tables};
use crate::fast::canvas::{Extent, Window};
use crate::fast::clip::{self, ClipRecord};
use crate::fast::planes::Exact;
use crate::fast::screen::{self, ScreenRecord};
use crate::fast::subtree::{LANES, STRIPS, Subtree};
use crate::fast::walk::{Bounds, Walk};

/// AVX2 with the bit and fused multiply-add instructions of its time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Avx2(());

impl Avx2 {
    /// The set, if the processor has it.
    pub(crate) fn detect() -> Option<Self> {
        let found = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        found.then_some(Self(()))
    }
}

/// What the walk has compiled for each set: a function with the set's
/// instructions in a module of the set's name, and the step that calls it.
/// They are not put into each other: what one needs now and then would be
/// computed each time that the other is called.
macro_rules! compiled {
    ($set:ident, $name:ident, $features:literal) => {
        mod $name {
            use super::*;

            type Set = $set;

            #[inline(never)]
            #[target_feature(enable = $features)]
            pub(super) fn clip(walk: &mut Walk<'_, Set>, record: &ClipRecord) {
                clip::turn(walk, record);
            }

            #[inline(never)]
            #[target_feature(enable = $features)]
            pub(super) fn change(walk: &mut Walk<'_, Set>, record: &ClipRecord) -> bool {
                clip::change(walk, record)
            }

            #[inline(never)]
            #[target_feature(enable = $features)]
            pub(super) fn screen(
                walk: &mut Walk<'_, Set>,
                subtree: &Subtree,
                record: &ScreenRecord,
            ) {
                screen::turn(walk, subtree, record);
            }

            #[inline(never)]
            #[target_feature(enable = $features)]
            pub(super) fn tiles(walk: &mut Walk<'_, Set>, subtree: &Subtree, record: &ScreenRecord) {
                screen::draw_tiles(walk, subtree, record);
            }

            #[inline(never)]
            #[target_feature(enable = $features)]
            pub(super) fn brick(
                walk: &mut Walk<'_, Set>,
                subtree: &Subtree,
                record: &ScreenRecord,
                octant: u8,
                parts: &Parts,
            ) {
                brick::draw_node(walk, subtree, record, octant, parts);
            }

            #[inline(never)]
            #[target_feature(enable = $features)]
            pub(super) fn tables(
                isa: Set,
                tables: &mut Tables,
                subtree: &Subtree,
                left: u32,
                octant: u8,
            ) {
                tables.make_parts(isa, subtree, left, octant);
            }

            #[inline(never)]
            #[target_feature(enable = $features)]
            pub(super) fn covers(
                exact: &Exact,
                min: [i32; 3],
                side: i32,
                sample: [i32; 2],
            ) -> bool {
                exact.covers(min, side, sample)
            }
        }
    };
    ($name:ident) => {
        fn clip(self, walk: &mut Walk<'_, Self>, record: &ClipRecord) {
            // SAFETY: `self` is only made where these features were found.
            unsafe { $name::clip(walk, record) }
        }

        fn change(self, walk: &mut Walk<'_, Self>, record: &ClipRecord) -> bool {
            // SAFETY: `self` is only made where these features were found.
            unsafe { $name::change(walk, record) }
        }

        fn screen(self, walk: &mut Walk<'_, Self>, subtree: &Subtree, record: &ScreenRecord) {
            // SAFETY: `self` is only made where these features were found.
            unsafe { $name::screen(walk, subtree, record) }
        }

        fn tiles(self, walk: &mut Walk<'_, Self>, subtree: &Subtree, record: &ScreenRecord) {
            // SAFETY: `self` is only made where these features were found.
            unsafe { $name::tiles(walk, subtree, record) }
        }

        fn brick(
            self,
            walk: &mut Walk<'_, Self>,
            subtree: &Subtree,
            record: &ScreenRecord,
            octant: u8,
            parts: &Parts,
        ) {
            // SAFETY: `self` is only made where these features were found.
            unsafe { $name::brick(walk, subtree, record, octant, parts) }
        }

        fn tables(self, tables: &mut Tables, subtree: &Subtree, left: u32, octant: u8) {
            // SAFETY: `self` is only made where these features were found.
            unsafe { $name::tables(self, tables, subtree, left, octant) }
        }

        fn covers(self, exact: &Exact, min: [i32; 3], side: i32, sample: [i32; 2]) -> bool {
            // SAFETY: `self` is only made where these features were found.
            unsafe { $name::covers(exact, min, side, sample) }
        }
    };
}

compiled!(Avx2, avx2, "avx2,fma,bmi1,bmi2,lzcnt,popcnt");
compiled!(
    Avx512,
    avx512,
    "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt"
);

/// Steps on eight 32-bit lanes and on sixteen bytes, the same in both sets.
///
/// SAFETY of all: an [`Avx2`] or [`Avx512`] is only made where AVX2 was found,
/// and only their steps call these. Loads are of as many entries as the array has.
mod eight {
    use super::*;

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
    pub(super) fn any_beyond(a: __m256i, b: __m256i) -> bool {
        // SAFETY: see above.
        unsafe {
            let beyond = _mm256_cmpgt_epi32(_mm256_abs_epi32(a), b);
            _mm256_testz_si256(beyond, beyond) == 0
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
}

/// By how much 32 lanes are beyond a width; 0 where they are within.
#[inline(always)]
fn half_beyond(table: &[u8; 64], half: usize, start: __m256i, width: __m256i) -> __m256i {
    // SAFETY: an `Avx2` is only made where AVX2 was found, and only its steps
    // call this; the load is of 32 entries that the array has.
    unsafe {
        let entries = _mm256_loadu_si256(table.as_ptr().add(32 * half).cast());
        _mm256_subs_epu8(_mm256_sub_epi8(start, entries), width)
    }
}

/// 64 lanes as bits.
#[inline(always)]
fn bits_of(low: __m256i, high: __m256i) -> u64 {
    // SAFETY: as in `half_within`; no memory is touched.
    unsafe {
        u64::from(_mm256_movemask_epi8(low) as u32)
            | u64::from(_mm256_movemask_epi8(high) as u32) << 32
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

        #[inline(always)]
        fn any_beyond(self, a: __m256i, b: __m256i) -> bool {
            eight::any_beyond(a, b)
        }
    };
}

impl Isa for Avx2 {
    const NAME: &'static str = "avx2";

    compiled!(avx2);

    type Reals = Avx2Reals;

    #[inline(always)]
    fn reals(self, values: &[f64; 8]) -> Avx2Reals {
        let values = values.as_ptr();
        // SAFETY: `self` is only made where these features were found; the
        // loads are of twice four entries that the array has.
        unsafe { Avx2Reals(_mm256_loadu_pd(values), _mm256_loadu_pd(values.add(4))) }
    }

    #[inline(always)]
    fn real(self, value: f64) -> Avx2Reals {
        // SAFETY: `self` is only made where these features were found.
        unsafe { Avx2Reals(_mm256_set1_pd(value), _mm256_set1_pd(value)) }
    }

    #[inline(always)]
    fn whole(self, values: Avx2Reals) -> __m256i {
        // SAFETY: `self` is only made where these features were found.
        unsafe { _mm256_set_m128i(_mm256_cvtpd_epi32(values.1), _mm256_cvtpd_epi32(values.0)) }
    }

    #[inline(always)]
    fn samples_between(self, x: Avx2Reals, y: Avx2Reals, margin: f64) -> Window {
        eight::samples_between([x.0, x.1], [y.0, y.1], margin)
    }

    eight_lanes!();

    #[inline(always)]
    fn put(self, rows: &mut [u32], first: usize, width: usize, samples: u64, value: u32) {
        // SAFETY: `self` is only made where these features were found; what is
        // stored to is in the slice.
        unsafe {
            let value_lanes = _mm256_set1_epi32(value as i32);
            let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let (mut left, mut at) = (samples, first);
            while left != 0 {
                if at + 8 > rows.len() {
                    return Scalar.put(rows, at, width, left, value);
                }
                let row = _mm256_and_si256(_mm256_set1_epi32(left as i32), bits);
                let mask = _mm256_cmpeq_epi32(row, bits);
                _mm256_maskstore_epi32(rows.as_mut_ptr().add(at).cast(), mask, value_lanes);
                left >>= 8;
                at += width;
            }
        }
    }

    #[inline(always)]
    fn square_within(
        self,
        tables: &[[i16; 64]; STRIPS],
        start: __m256i,
        half_width: &[i32; LANES],
    ) -> u64 {
        // SAFETY: `self` is only made where these features were found; the
        // loads are of four times 16 entries, all that a table has.
        unsafe {
            let low = _mm256_castsi256_si128(start);
            let starts = [low, _mm_srli_si128::<4>(low), _mm_srli_si128::<8>(low)];
            let mut samples = [_mm256_set1_epi8(-1); 4];
            for f in 0..STRIPS {
                let start = _mm256_broadcastw_epi16(starts[f]);
                let width = _mm256_set1_epi16(2 * half_width[f] as i16);
                for part in 0..4 {
                    let entries = _mm256_loadu_si256(tables[f].as_ptr().add(16 * part).cast());
                    let value = _mm256_add_epi16(start, entries);
                    let within = _mm256_cmpeq_epi16(_mm256_min_epu16(value, width), value);
                    samples[part] = _mm256_and_si256(samples[part], within);
                }
            }
            // Packing goes by halves: put the quarters back in order.
            let low = _mm256_packs_epi16(samples[0], samples[1]);
            let high = _mm256_packs_epi16(samples[2], samples[3]);
            let low = _mm256_permute4x64_epi64::<0b11_01_10_00>(low);
            bits_of(low, _mm256_permute4x64_epi64::<0b11_01_10_00>(high))
        }
    }

    #[inline(always)]
    fn strips_within(self, coarse: &Coarse, start: __m256i, few: bool) -> u64 {
        if few {
            return eight::few_strips(coarse, start);
        }
        let cut = eight::cut(coarse, start);
        // SAFETY: as in `half_beyond`; a width has 32 entries.
        unsafe {
            let cut = _mm256_broadcastsi128_si256(cut);
            let mut low = _mm256_setzero_si256();
            let mut high = low;
            for f in 0..3 {
                let start = _mm256_shuffle_epi8(cut, _mm256_set1_epi8(4 * f as i8));
                let width = _mm256_loadu_si256(coarse.width[f].as_ptr().cast());
                let table = &coarse.parts[f];
                low = _mm256_or_si256(low, half_beyond(table, 0, start, width));
                high = _mm256_or_si256(high, half_beyond(table, 1, start, width));
            }
            let none = _mm256_setzero_si256();
            bits_of(_mm256_cmpeq_epi8(low, none), _mm256_cmpeq_epi8(high, none))
        }
    }

    #[inline(always)]
    fn within_wide(self, table: &[i32; 64], start: i32, width: u32) -> u64 {
        let mut lanes = 0u64;
        for part in 0..8 {
            // SAFETY: as in `sixteen`; the load is of 8 entries that the array has.
            let eight = unsafe {
                let entries = _mm256_loadu_si256(table.as_ptr().add(8 * part).cast());
                let value = _mm256_add_epi32(_mm256_set1_epi32(start), entries);
                let least = _mm256_min_epu32(value, _mm256_set1_epi32(width as i32));
                let equal = _mm256_cmpeq_epi32(least, value);
                _mm256_movemask_ps(_mm256_castsi256_ps(equal)) as u8
            };
            lanes |= u64::from(eight) << (8 * part);
        }
        lanes
    }
}

/// AVX-512 with words and bytes, and all that AVX2 has.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Avx512(());

impl Avx512 {
    /// The set, if the processor has it.
    pub(crate) fn detect() -> Option<Self> {
        let found = Avx2::detect().is_some()
            && is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl");
        found.then_some(Self(()))
    }
}

impl Isa for Avx512 {
    const NAME: &'static str = "avx512";

    compiled!(avx512);

    type Reals = Avx512Reals;

    #[inline(always)]
    fn reals(self, values: &[f64; 8]) -> Avx512Reals {
        // SAFETY: `self` is only made where these features were found; the
        // load is of all that the array has.
        unsafe { Avx512Reals(_mm512_loadu_pd(values.as_ptr())) }
    }

    #[inline(always)]
    fn real(self, value: f64) -> Avx512Reals {
        // SAFETY: `self` is only made where these features were found.
        unsafe { Avx512Reals(_mm512_set1_pd(value)) }
    }

    #[inline(always)]
    fn whole(self, values: Avx512Reals) -> __m256i {
        // SAFETY: `self` is only made where these features were found.
        unsafe { _mm512_cvtpd_epi32(values.0) }
    }

    #[inline(always)]
    fn samples_between(self, x: Avx512Reals, y: Avx512Reals, margin: f64) -> Window {
        eight::samples_between(x.halves(), y.halves(), margin)
    }

    eight_lanes!();

    #[inline(always)]
    fn put(self, rows: &mut [u32], first: usize, width: usize, samples: u64, value: u32) {
        // SAFETY: `self` is only made where these features were found; what is
        // stored to is in the slice.
        unsafe {
            let value_lanes = _mm256_set1_epi32(value as i32);
            let (mut left, mut at) = (samples, first);
            while left != 0 {
                if at + 8 > rows.len() {
                    return Scalar.put(rows, at, width, left, value);
                }
                let row = rows.as_mut_ptr().add(at).cast();
                _mm256_mask_storeu_epi32(row, left as u8, value_lanes);
                left >>= 8;
                at += width;
            }
        }
    }

    #[inline(always)]
    fn square_within(
        self,
        tables: &[[i16; 64]; STRIPS],
        start: __m256i,
        half_width: &[i32; LANES],
    ) -> u64 {
        // SAFETY: `self` is only made where these features were found; the
        // loads are of twice 32 entries, all that a table has.
        unsafe {
            let low = _mm256_castsi256_si128(start);
            let starts = [low, _mm_srli_si128::<4>(low), _mm_srli_si128::<8>(low)];
            let (mut upper, mut lower) = (u32::MAX, u32::MAX);
            for f in 0..STRIPS {
                let start = _mm512_broadcastw_epi16(starts[f]);
                let width = _mm512_set1_epi16(2 * half_width[f] as i16);
                let table = tables[f].as_ptr();
                let value = _mm512_add_epi16(start, _mm512_loadu_si512(table.cast()));
                upper = _mm512_mask_cmple_epu16_mask(upper, value, width);
                let value = _mm512_add_epi16(start, _mm512_loadu_si512(table.add(32).cast()));
                lower = _mm512_mask_cmple_epu16_mask(lower, value, width);
            }
            u64::from(upper) | u64::from(lower) << 32
        }
    }

    #[inline(always)]
    fn strips_within(self, coarse: &Coarse, start: __m256i, few: bool) -> u64 {
        if few {
            return eight::few_strips(coarse, start);
        }
        let cut = eight::cut(coarse, start);
        // SAFETY: as in `bytes_within`.
        unsafe {
            let mut lanes = u64::MAX;
            for f in 0..3 {
                let entries = _mm512_loadu_si512(coarse.parts[f].as_ptr().cast());
                let start = _mm_shuffle_epi8(cut, _mm_set1_epi8(4 * f as i8));
                let value = _mm512_sub_epi8(_mm512_broadcastb_epi8(start), entries);
                let width = _mm512_set1_epi8(coarse.width[f][0] as i8);
                lanes = _mm512_mask_cmple_epu8_mask(lanes, value, width);
            }
            lanes
        }
    }

    #[inline(always)]
    fn within_wide(self, table: &[i32; 64], start: i32, width: u32) -> u64 {
        // SAFETY: as in `within`, four times 16 entries.
        unsafe {
            let start = _mm512_set1_epi32(start);
            let width = _mm512_set1_epi32(width as i32);
            let mut lanes = 0u64;
            for part in 0..4 {
                let entries = _mm512_loadu_si512(table.as_ptr().add(16 * part).cast());
                let within = _mm512_cmple_epu32_mask(_mm512_add_epi32(start, entries), width);
                lanes |= u64::from(within) << (16 * part);
            }
            lanes
        }
    }
}
