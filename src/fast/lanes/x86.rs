//! AVX2 and AVX-512, found at run time.

use std::arch::x86_64::*;

use super::x86_eight::{self as eight, eight_lanes};
use super::x86_reals::{Avx2Reals, Avx512Reals};
use super::{Isa, Scalar};
use crate::fast::brick;
use crate::fast::canvas::{Extent, Window, Windows};
use crate::fast::clip::{self, ClipRecord};
use crate::fast::parts::Parts;
use crate::fast::planes::Exact;
use crate::fast::screen::{self, ScreenRecord};
use crate::fast::subtree::{LANES, STRIPS, Subtree};
use crate::fast::tables::{Coarse, Tables};
use crate::fast::tall;
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

            #[cold]
            #[inline(never)]
            #[target_feature(enable = $features)]
            pub(super) fn absent(
                walk: &mut Walk<'_, Set>,
                subtree: &Subtree,
                record: &ScreenRecord,
            ) {
                screen::look_at_absent(walk, subtree, record);
            }

            #[inline(never)]
            #[target_feature(enable = $features)]
            pub(super) fn tiles(
                walk: &mut Walk<'_, Set>,
                subtree: &Subtree,
                record: &ScreenRecord,
            ) {
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
            pub(super) fn tall(
                walk: &mut Walk<'_, Set>,
                subtree: &Subtree,
                record: &ScreenRecord,
                octant: u8,
                parts: &Parts,
            ) {
                tall::draw_node(walk, subtree, record, octant, parts);
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

        fn absent(self, walk: &mut Walk<'_, Self>, subtree: &Subtree, record: &ScreenRecord) {
            // SAFETY: `self` is only made where these features were found.
            unsafe { $name::absent(walk, subtree, record) }
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

        fn tall(
            self,
            walk: &mut Walk<'_, Self>,
            subtree: &Subtree,
            record: &ScreenRecord,
            octant: u8,
            parts: &Parts,
        ) {
            // SAFETY: `self` is only made where these features were found.
            unsafe { $name::tall(walk, subtree, record, octant, parts) }
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
    // SAFETY: as in `half_beyond`; no memory is touched.
    unsafe {
        u64::from(_mm256_movemask_epi8(low) as u32)
            | u64::from(_mm256_movemask_epi8(high) as u32) << 32
    }
}

impl Isa for Avx2 {
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
        // stored to are eight entries from `at` on, which the slice has.
        unsafe {
            let value_lanes = _mm256_set1_epi32(value as i32);
            let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let (mut left, mut at) = (samples, first);
            while left != 0 {
                if rows.len().saturating_sub(at) < 8 {
                    return Scalar.put(rows, at, width, left, value);
                }
                let row = _mm256_and_si256(_mm256_set1_epi32(left as i32), bits);
                let mask = _mm256_cmpeq_epi32(row, bits);
                _mm256_maskstore_epi32(rows.as_mut_ptr().add(at).cast(), mask, value_lanes);
                left >>= 8;
                at = at.wrapping_add(width);
            }
        }
    }

    #[inline(always)]
    fn square_within(
        self,
        tables: &[[i16; 64]; STRIPS],
        start: __m256i,
        bound: &[i32; LANES],
    ) -> u64 {
        // SAFETY: `self` is only made where these features were found; the
        // loads are of four times 16 entries, all that a table has.
        unsafe {
            let low = _mm256_castsi256_si128(start);
            let starts = [low, _mm_srli_si128::<4>(low), _mm_srli_si128::<8>(low)];
            let mut samples = [_mm256_set1_epi8(-1); 4];
            for f in 0..STRIPS {
                let start = _mm256_broadcastw_epi16(starts[f]);
                let width = _mm256_set1_epi16((2 * bound[f]) as i16);
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
    fn children_within(
        self,
        tables: &[[i32; 8]; STRIPS + 2],
        value: __m256i,
        width: &[i32; LANES],
    ) -> u8 {
        // SAFETY: as in `within_wide`.
        unsafe {
            let mut inside = _mm256_set1_epi32(-1);
            for (f, by_child) in tables.iter().enumerate() {
                let lane = f + usize::from(f >= STRIPS);
                let value = _mm256_permutevar8x32_epi32(value, _mm256_set1_epi32(lane as i32));
                let by_child = _mm256_loadu_si256(by_child.as_ptr().cast());
                let value = _mm256_sub_epi32(value, by_child);
                let least = _mm256_min_epu32(value, _mm256_set1_epi32(width[lane]));
                inside = _mm256_and_si256(inside, _mm256_cmpeq_epi32(least, value));
            }
            _mm256_movemask_ps(_mm256_castsi256_ps(inside)) as u8
        }
    }

    #[inline(always)]
    fn within_wide(self, table: &[i32; 64], start: i32, width: u32) -> u64 {
        let mut lanes = 0u64;
        for part in 0..8 {
            // SAFETY: `self` is only made where these features were found; the load is of 8 entries that the array has.
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
        // stored to are eight entries from `at` on, which the slice has.
        unsafe {
            let value_lanes = _mm256_set1_epi32(value as i32);
            let (mut left, mut at) = (samples, first);
            while left != 0 {
                if rows.len().saturating_sub(at) < 8 {
                    return Scalar.put(rows, at, width, left, value);
                }
                let row = rows.as_mut_ptr().add(at).cast();
                _mm256_mask_storeu_epi32(row, left as u8, value_lanes);
                left >>= 8;
                at = at.wrapping_add(width);
            }
        }
    }

    #[inline(always)]
    fn square_within(
        self,
        tables: &[[i16; 64]; STRIPS],
        start: __m256i,
        bound: &[i32; LANES],
    ) -> u64 {
        // SAFETY: `self` is only made where these features were found; the
        // loads are of twice 32 entries, all that a table has.
        unsafe {
            let low = _mm256_castsi256_si128(start);
            let starts = [low, _mm_srli_si128::<4>(low), _mm_srli_si128::<8>(low)];
            let (mut upper, mut lower) = (u32::MAX, u32::MAX);
            for f in 0..STRIPS {
                let start = _mm512_broadcastw_epi16(starts[f]);
                let width = _mm512_set1_epi16((2 * bound[f]) as i16);
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
        // SAFETY: `self` is only made where these features were found.
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
    fn children_within(
        self,
        tables: &[[i32; 8]; STRIPS + 2],
        value: __m256i,
        width: &[i32; LANES],
    ) -> u8 {
        // SAFETY: `self` is only made where these features were found.
        unsafe {
            let mut inside = u8::MAX;
            for (f, by_child) in tables.iter().enumerate() {
                let lane = f + usize::from(f >= STRIPS);
                let value = _mm256_permutevar8x32_epi32(value, _mm256_set1_epi32(lane as i32));
                let by_child = _mm256_loadu_si256(by_child.as_ptr().cast());
                let value = _mm256_sub_epi32(value, by_child);
                let width = _mm256_set1_epi32(width[lane]);
                inside = _mm256_mask_cmple_epu32_mask(inside, value, width);
            }
            inside
        }
    }

    #[inline(always)]
    fn within_wide(self, table: &[i32; 64], start: i32, width: u32) -> u64 {
        // SAFETY: `self` is only made where these features were found; the
        // loads are of four times 16 entries, all that the table has.
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
