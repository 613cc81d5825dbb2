//! AVX2, found at run time.
//!
//! Steps within a step are macros here: a closure would be compiled without the set's instructions.

use std::arch::x86_64::*;

use super::*;
use crate::fast::orders::{EXTENTS, SLABS, TURNED_BYTES};
use crate::fast::strips::CELLS;

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

/// Four lanes. One can only be had from an [`Avx2`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Floats(__m128);

/// An expression of intrinsics that read no memory.
macro_rules! avx {
    ($value:expr) => {
        // SAFETY: an `Avx2` and its lanes are only made where these features were found.
        unsafe { $value }
    };
}

const NEXT: i32 = 0b11_00_10_01;
const LAST: i32 = 0b11_01_00_10;

impl Four for Floats {
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        avx!(Self(_mm_add_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        avx!(Self(_mm_sub_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        avx!(Self(_mm_mul_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        avx!(Self(_mm_div_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn fma(self, by: Self, plus: Self) -> Self {
        avx!(Self(_mm_fmadd_ps(self.0, by.0, plus.0)))
    }
    #[inline(always)]
    fn fms(self, by: Self, less: Self) -> Self {
        avx!(Self(_mm_fmsub_ps(self.0, by.0, less.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        avx!(Self(_mm_max_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        avx!(Self(_mm_min_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        avx!(Self(_mm_andnot_ps(_mm_set1_ps(-0.0), self.0)))
    }
    #[inline(always)]
    fn flip(self, signs: Self) -> Self {
        avx!(Self(_mm_xor_ps(self.0, signs.0)))
    }
    #[inline(always)]
    fn next(self) -> Self {
        avx!(Self(_mm_shuffle_ps::<NEXT>(self.0, self.0)))
    }
    #[inline(always)]
    fn last(self) -> Self {
        avx!(Self(_mm_shuffle_ps::<LAST>(self.0, self.0)))
    }
    #[inline(always)]
    fn signs(self) -> u32 {
        avx!(_mm_movemask_ps(self.0) as u32)
    }
    #[inline(always)]
    fn cells(self) -> [usize; 3] {
        avx!({
            let whole = _mm_min_epu32(_mm_cvttps_epi32(self.0), _mm_set1_epi32(CELLS as i32 - 1));
            // The bounds are repeated for the compiler to see.
            [
                _mm_cvtsi128_si32(whole) as usize % CELLS,
                _mm_extract_epi32::<1>(whole) as usize % CELLS,
                _mm_extract_epi32::<2>(whole) as usize % CELLS,
            ]
        })
    }
    #[inline(always)]
    fn values(self) -> [f32; 4] {
        let mut values = [0.0; 4];
        // SAFETY: as above; the store is of the array's four.
        unsafe { _mm_storeu_ps(values.as_mut_ptr(), self.0) };
        values
    }
    #[inline(always)]
    fn floor(self) -> Self {
        avx!(Self(_mm_floor_ps(self.0)))
    }
    #[inline(always)]
    fn sums(self, other: Self) -> Self {
        avx!({
            let pairs = _mm_hadd_ps(self.0, other.0);
            Self(_mm_hadd_ps(pairs, pairs))
        })
    }
    #[inline(always)]
    fn whole(self) -> [i32; 4] {
        avx!({
            let whole = _mm_cvttps_epi32(self.0);
            [
                _mm_cvtsi128_si32(whole),
                _mm_extract_epi32::<1>(whole),
                _mm_extract_epi32::<2>(whole),
                _mm_extract_epi32::<3>(whole),
            ]
        })
    }
}

/// One of four lanes in all of eight.
#[inline(always)]
fn broadcast<const LANE: i32>(four: Floats) -> __m256 {
    avx!(_mm256_broadcastss_ps(match LANE {
        0 => four.0,
        1 => _mm_movehdup_ps(four.0),
        _ => _mm_movehl_ps(four.0, four.0),
    }))
}

impl Isa for Avx2 {
    type Four = Floats;
    type Distances = [__m256i; 4];

    #[inline(always)]
    fn four(self, values: &[f32; 4]) -> Floats {
        // SAFETY: as above; the load is of the array's four.
        unsafe { Floats(_mm_loadu_ps(values.as_ptr())) }
    }
    #[inline(always)]
    fn splat(self, value: f32) -> Floats {
        avx!(Floats(_mm_set1_ps(value)))
    }

    #[inline(always)]
    fn windows(
        self,
        constants: &Constants,
        level: usize,
        centre: &[f64; 3],
        band: &Window,
    ) -> Windows {
        let (own, below) = (&constants.levels[level], &constants.levels[level + 1]);
        if centre[2] > own.tiny_depth {
            return Scalar.windows(constants, level, centre, band);
        }
        let mut windows = Windows {
            sides: [[0; 8]; 4],
            held: 0,
            near: 0,
        };
        // SAFETY: as above; loads are of four of a level's eight, stores of
        // all eight of a side, which are aligned.
        unsafe {
            macro_rules! at {
                ($c:expr, $i:literal) => {{
                    let child = _mm256_loadu_pd(own.child[$c].as_ptr().add($i));
                    _mm256_add_pd(_mm256_set1_pd(centre[$c]), child)
                }};
            }
            macro_rules! narrow {
                ($low:expr, $high:expr) => {{
                    let low = _mm256_castps128_ps256(_mm256_cvtpd_ps($low));
                    _mm256_insertf128_ps::<1>(low, _mm256_cvtpd_ps($high))
                }};
            }
            let (w_low, w_high) = (at!(2, 0), at!(2, 4));
            let root = _mm256_set1_pd(constants.root_samples);
            let (over_low, over_high) = (_mm256_div_pd(root, w_low), _mm256_div_pd(root, w_high));
            let half_sample = _mm256_set1_pd(0.5);
            let depth = _mm256_set1_pd(below.half_depth);
            let nearest = narrow!(_mm256_sub_pd(w_low, depth), _mm256_sub_pd(w_high, depth));
            let zero = _mm256_setzero_ps();
            windows.near = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(nearest, zero)) as u8;
            // Half a child's side over its least depth; the inverse has 11 bits.
            let half = own.side as f32 * (0.25 * WINDOW_SCALE);
            let share = _mm256_mul_ps(_mm256_rcp_ps(nearest), _mm256_set1_ps(half));
            let plain = _mm256_castsi256_ps(_mm256_set1_epi32(i32::MAX));
            let rounding = _mm256_set1_ps(WINDOW_ROUNDING);
            let margin = _mm256_set1_ps(WINDOW_MARGIN);
            let mut held = _mm256_castsi256_ps(_mm256_set1_epi32(-1));
            for axis in 0..2 {
                let at = narrow!(
                    _mm256_fmsub_pd(at!(axis, 0), over_low, half_sample),
                    _mm256_fmsub_pd(at!(axis, 4), over_high, half_sample)
                );
                let mut edges = zero;
                for e in &constants.edge_lanes {
                    let along = _mm256_fnmadd_ps(at, _mm256_set1_ps(e[2]), _mm256_set1_ps(e[axis]));
                    edges = _mm256_add_ps(edges, _mm256_and_ps(plain, along));
                }
                let margin = _mm256_fmadd_ps(_mm256_and_ps(plain, at), rounding, margin);
                let extent = _mm256_fmadd_ps(edges, share, margin);
                let (first, last) = if axis == 0 {
                    (band.left, band.right)
                } else {
                    (band.top, band.bottom)
                };
                let low = _mm256_ceil_ps(_mm256_sub_ps(at, extent));
                let low = _mm256_max_ps(low, _mm256_set1_ps(first as f32));
                let high = _mm256_floor_ps(_mm256_add_ps(at, extent));
                let high = _mm256_min_ps(high, _mm256_set1_ps(last as f32));
                held = _mm256_and_ps(held, _mm256_cmp_ps::<_CMP_LE_OQ>(low, high));
                // Those that hold a sample are within the band.
                for (side, lanes) in [(axis, low), (axis + 2, high)] {
                    let to = windows.sides[side].as_mut_ptr().cast();
                    _mm256_store_si256(to, _mm256_cvttps_epi32(lanes));
                }
            }
            windows.held = _mm256_movemask_ps(held) as u8;
        }
        windows
    }

    #[inline(always)]
    fn parts_of_samples(
        self,
        tables: [&Row; 3],
        cells: &[Floats; 3],
        wanted: u64,
        open: u64,
        candidates: &mut Candidates,
    ) -> u64 {
        let mut any = 0u64;
        // SAFETY: as above; cells are looked up below `CELLS`, which is what a
        // table has, and stores are of eight of the 64 entries, which are aligned.
        unsafe {
            let ramp = _mm256_setr_ps(0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0);
            let last = _mm256_set1_epi32(CELLS as i32 - 1);
            let wanted = _mm256_set1_epi64x(wanted as i64);
            let zero = _mm256_setzero_si256();
            let [first, step_x, step_y] = *cells;
            let mut at = [
                _mm256_fmadd_ps(broadcast::<0>(step_x), ramp, broadcast::<0>(first)),
                _mm256_fmadd_ps(broadcast::<1>(step_x), ramp, broadcast::<1>(first)),
                _mm256_fmadd_ps(broadcast::<2>(step_x), ramp, broadcast::<2>(first)),
            ];
            let step = [
                broadcast::<0>(step_y),
                broadcast::<1>(step_y),
                broadcast::<2>(step_y),
            ];
            let rows = 8 - open.leading_zeros() as usize / 8;
            let mut left = open;
            for row in candidates.0.chunks_exact_mut(8).take(rows) {
                let is_open = left & 0xff != 0;
                left >>= 8;
                if !is_open {
                    at = [
                        _mm256_add_ps(at[0], step[0]),
                        _mm256_add_ps(at[1], step[1]),
                        _mm256_add_ps(at[2], step[2]),
                    ];
                    any <<= 8;
                    continue;
                }
                let mut low = wanted;
                let mut high = wanted;
                for j in 0..3 {
                    let cell = _mm256_min_epu32(_mm256_cvttps_epi32(at[j]), last);
                    at[j] = _mm256_add_ps(at[j], step[j]);
                    let table = tables[j].as_ptr().cast();
                    let (near, far) = (
                        _mm256_castsi256_si128(cell),
                        _mm256_extracti128_si256::<1>(cell),
                    );
                    low = _mm256_and_si256(low, _mm256_i32gather_epi64::<8>(table, near));
                    high = _mm256_and_si256(high, _mm256_i32gather_epi64::<8>(table, far));
                }
                let to = row.as_mut_ptr().cast::<__m256i>();
                _mm256_store_si256(to, low);
                _mm256_store_si256(to.add(1), high);
                let (low, high) = (
                    _mm256_cmpeq_epi64(low, zero),
                    _mm256_cmpeq_epi64(high, zero),
                );
                let low = _mm256_movemask_pd(_mm256_castsi256_pd(low)) as u64;
                let high = _mm256_movemask_pd(_mm256_castsi256_pd(high)) as u64;
                // The last row ends up lowest.
                any = any << 8 | (low | high << 4) ^ 0xff;
            }
        }
        let missing = open.leading_zeros() / 8 * 8;
        (any << (missing & 63)).swap_bytes() & open
    }

    #[inline(always)]
    fn distances(self, values: &[Floats; 3]) -> [__m256i; 4] {
        avx!({
            let [first, step_x, step_y] = *values;
            let first = _mm_cvtps_epi32(first.0);
            let first = _mm_packs_epi32(first, first);
            let (step_x, step_y) = (_mm_cvtps_epi32(step_x.0), _mm_cvtps_epi32(step_y.0));
            let (step_x, step_y) = (
                _mm_packs_epi32(step_x, step_x),
                _mm_packs_epi32(step_y, step_y),
            );
            // Two rows of eight.
            let columns = _mm256_setr_epi16(0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7);
            let rows = _mm256_setr_epi16(0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1);
            let mut worst = [_mm256_setzero_si256(); 4];
            macro_rules! function {
                ($bytes:literal) => {
                    let step_x = _mm256_broadcastw_epi16(_mm_srli_si128::<$bytes>(step_x));
                    let step_y = _mm256_broadcastw_epi16(_mm_srli_si128::<$bytes>(step_y));
                    let mut at = _mm256_broadcastw_epi16(_mm_srli_si128::<$bytes>(first));
                    at = _mm256_add_epi16(at, _mm256_mullo_epi16(columns, step_x));
                    at = _mm256_add_epi16(
                        at,
                        _mm256_and_si256(step_y, _mm256_sub_epi16(_mm256_setzero_si256(), rows)),
                    );
                    let two_rows = _mm256_add_epi16(step_y, step_y);
                    for worst in &mut worst {
                        *worst = _mm256_max_epu16(*worst, _mm256_abs_epi16(at));
                        at = _mm256_add_epi16(at, two_rows);
                    }
                };
            }
            function!(0);
            function!(2);
            function!(4);
            worst
        })
    }

    #[inline(always)]
    fn below(self, distances: &[__m256i; 4], limit: i16) -> u64 {
        avx!({
            let limit = _mm256_set1_epi16(limit);
            macro_rules! four_rows {
                ($i:literal) => {{
                    let upper = _mm256_cmpgt_epi16(limit, distances[$i]);
                    let lower = _mm256_cmpgt_epi16(limit, distances[$i + 1]);
                    // Rows 0 and 2, 1 and 3: packing goes by halves.
                    let rows = _mm256_packs_epi16(upper, lower);
                    let rows = _mm256_permute4x64_epi64::<0b11_01_10_00>(rows);
                    _mm256_movemask_epi8(rows) as u32 as u64
                }};
            }
            four_rows!(0) | four_rows!(2) << 32
        })
    }

    #[inline(always)]
    fn extent(self, parts: u64) -> [Floats; 2] {
        let mut extent = [self.splat(0.0); 2];
        // SAFETY: as above; the loads are of the array's four.
        unsafe {
            let parts = _mm256_set1_epi64x(parts as i64);
            for (axis, slabs) in SLABS.iter().enumerate() {
                let filled = _mm256_and_si256(parts, _mm256_loadu_si256(slabs.as_ptr().cast()));
                let empty = _mm256_cmpeq_epi64(filled, _mm256_setzero_si256());
                let empty = _mm256_movemask_pd(_mm256_castsi256_pd(empty)) as usize;
                let [middle, half] = &EXTENTS[axis][(empty & 15) ^ 15];
                extent[0] = extent[0].add(self.four(middle));
                extent[1] = extent[1].add(self.four(half));
            }
        }
        extent
    }

    #[inline(always)]
    fn steps(self, [x, y, w]: &[[f64; 4]; 3], centre: [f64; 2], unit: f64) -> [Floats; 2] {
        // SAFETY: as above; the loads are of the arrays' four.
        unsafe {
            let [x, y, w] = [
                _mm256_loadu_pd(x.as_ptr()),
                _mm256_loadu_pd(y.as_ptr()),
                _mm256_loadu_pd(w.as_ptr()),
            ];
            let unit = _mm256_set1_pd(unit);
            let column = _mm256_fmsub_pd(_mm256_set1_pd(centre[1]), w, y);
            let row = _mm256_fnmadd_pd(_mm256_set1_pd(centre[0]), w, x);
            [
                Floats(_mm256_cvtpd_ps(_mm256_mul_pd(column, unit))),
                Floats(_mm256_cvtpd_ps(_mm256_mul_pd(row, unit))),
            ]
        }
    }

    #[inline(always)]
    fn turned_parts(self, parts: u64, octant: u8) -> u64 {
        let [outer, low, high] = &TURNED_BYTES[usize::from(octant & 7)];
        // SAFETY: as above; the loads are of the arrays' sixteen.
        unsafe {
            let outer = _mm_loadu_si128(outer.as_ptr().cast());
            let low = _mm_loadu_si128(low.as_ptr().cast());
            let high = _mm_loadu_si128(high.as_ptr().cast());
            let bytes = _mm_shuffle_epi8(_mm_cvtsi64_si128(parts as i64), outer);
            let half = _mm_set1_epi8(15);
            let lower = _mm_shuffle_epi8(low, _mm_and_si128(bytes, half));
            let upper = _mm_and_si128(_mm_srli_epi16::<4>(bytes), half);
            let upper = _mm_shuffle_epi8(high, upper);
            _mm_cvtsi128_si64(_mm_or_si128(lower, upper)) as u64
        }
    }

    #[inline(always)]
    fn spread(self, bytes: u64, mask: u8) -> (u64, u64) {
        avx!({
            let places = _pdep_u64(u64::from(mask), 0x0101_0101_0101_0101);
            let ones = (places << 8).wrapping_sub(places);
            (_pdep_u64(bytes, ones), ones)
        })
    }

    #[inline(always)]
    fn prefetch<T>(self, entries: &[T], at: usize) {
        // Any address may be asked for; nothing is read.
        let entry = entries.as_ptr().wrapping_add(at);
        avx!(_mm_prefetch::<_MM_HINT_T0>(entry.cast()));
    }

    #[inline(always)]
    fn put(self, rows: &mut [u32], first: usize, width: usize, samples: u64, value: u32) {
        // SAFETY: as above; what is stored to are eight entries from the beginning of a row on,
        // which the slice has: `end` and the check in the loop.
        unsafe {
            let value_lanes = _mm256_set1_epi32(value as i32);
            let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let (mut left, mut at) = (samples, first);
            // All eight rows, drawn or not: how many there are cannot be predicted.
            // Rows begin at `first + row * width`, and all of their entries are in the slice.
            let end = width
                .saturating_mul(7)
                .saturating_add(first)
                .saturating_add(8);
            if end <= rows.len() {
                let mut to = rows.as_mut_ptr().add(first);
                for row in 0..8 {
                    let row = _mm256_set1_epi32((samples >> (8 * row)) as i32);
                    let mask = _mm256_cmpeq_epi32(_mm256_and_si256(row, bits), bits);
                    _mm256_maskstore_epi32(to.cast(), mask, value_lanes);
                    to = to.wrapping_add(width);
                }
                return;
            }
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
}
