use std::arch::x86_64::*;

use super::*;

/// AVX2 with the bit and fused multiply-add instructions of its time.
#[derive(Debug, Clone, Copy)]
pub(in crate::fast) struct Vector(());

/// An expression of intrinsics that read no memory.
macro_rules! intrinsics {
    ($value:expr) => {
        // SAFETY: a `Vector` and its lanes are only made where these features were found.
        unsafe { $value }
    };
}

lanes! {
    Floats4([f32; 4] in __m128, _mm_loadu_ps, _mm_set1_ps);
    Floats8([f32; 8] in __m256, _mm256_loadu_ps, _mm256_set1_ps);
    Doubles4([f64; 4] in __m256d, _mm256_loadu_pd, _mm256_set1_pd);
    Shorts16([i16; 16] in __m256i, _mm256_loadu_si256, _mm256_set1_epi16);
    Masks4([u64; 4] in __m256i, _mm256_loadu_si256, _mm256_set1_epi64x);
}

macro_rules! floats {
    ($name:ident[$n:literal]: $add:ident $sub:ident $mul:ident $div:ident
     $fma:ident $fms:ident $fnma:ident $max:ident $min:ident
     $and_not:ident $set:ident $floor:ident $ceil:ident) => {
        impl Floats<$n> for $name {
            methods! {
                add(other) = $add;
                sub(other) = $sub;
                mul(other) = $mul;
                div(other) = $div;
                fma(by, plus) = $fma;
                fms(by, less) = $fms;
                fnma(by, from) = $fnma;
                max(other) = $max;
                min(other) = $min;
                floor() = $floor;
                ceil() = $ceil;
            }
            #[inline(always)]
            fn abs(self) -> Self {
                intrinsics!(Self($and_not($set(-0.0), self.0)))
            }
        }
    };
}
floats! { Floats4[4]: _mm_add_ps _mm_sub_ps _mm_mul_ps _mm_div_ps
_mm_fmadd_ps _mm_fmsub_ps _mm_fnmadd_ps _mm_max_ps _mm_min_ps
_mm_andnot_ps _mm_set1_ps _mm_floor_ps _mm_ceil_ps }
floats! { Floats8[8]: _mm256_add_ps _mm256_sub_ps _mm256_mul_ps _mm256_div_ps
_mm256_fmadd_ps _mm256_fmsub_ps _mm256_fnmadd_ps _mm256_max_ps _mm256_min_ps
_mm256_andnot_ps _mm256_set1_ps _mm256_floor_ps _mm256_ceil_ps }
floats! { Doubles4[4]: _mm256_add_pd _mm256_sub_pd _mm256_mul_pd _mm256_div_pd
_mm256_fmadd_pd _mm256_fmsub_pd _mm256_fnmadd_pd _mm256_max_pd _mm256_min_pd
_mm256_andnot_pd _mm256_set1_pd _mm256_floor_pd _mm256_ceil_pd }

const NEXT: i32 = 0b11_00_10_01;
const LAST: i32 = 0b11_01_00_10;

impl F32x4 for Floats4 {
    methods! {
        flip(signs) = _mm_xor_ps;
    }
    #[inline(always)]
    fn next(self) -> Self {
        intrinsics!(Self(_mm_shuffle_ps::<NEXT>(self.0, self.0)))
    }
    #[inline(always)]
    fn last(self) -> Self {
        intrinsics!(Self(_mm_shuffle_ps::<LAST>(self.0, self.0)))
    }
    #[inline(always)]
    fn signs(self) -> u32 {
        intrinsics!(_mm_movemask_ps(self.0) as u32)
    }
    #[inline(always)]
    fn indices<const N: usize>(self) -> [usize; 3] {
        intrinsics!({
            let whole = _mm_min_epu32(_mm_cvttps_epi32(self.0), _mm_set1_epi32(N as i32 - 1));
            // The bounds are repeated for the compiler to see.
            [
                _mm_cvtsi128_si32(whole) as usize % N,
                _mm_extract_epi32::<1>(whole) as usize % N,
                _mm_extract_epi32::<2>(whole) as usize % N,
            ]
        })
    }
    #[inline(always)]
    fn values(self) -> [f32; 4] {
        let mut values = [0.0; 4];
        // SAFETY: as above. The store is of the array's four.
        unsafe { _mm_storeu_ps(values.as_mut_ptr(), self.0) };
        values
    }
    #[inline(always)]
    fn sums(self, other: Self) -> Self {
        intrinsics!({
            let pairs = _mm_hadd_ps(self.0, other.0);
            Self(_mm_hadd_ps(pairs, pairs))
        })
    }
    #[inline(always)]
    fn whole(self) -> [i32; 4] {
        intrinsics!({
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

impl Tests<8> for Floats8 {
    methods! {
        reciprocal() = _mm256_rcp_ps;
    }
    #[inline(always)]
    fn at_most(self, other: Self) -> u8 {
        intrinsics!(_mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)) as u8)
    }
    #[inline(always)]
    fn whole(self) -> [i32; 8] {
        let mut whole = [0; 8];
        // SAFETY: as above. The store is of the array's eight.
        unsafe { _mm256_storeu_si256(whole.as_mut_ptr().cast(), _mm256_cvttps_epi32(self.0)) };
        whole
    }
    #[inline(always)]
    fn indices<const N: usize>(self) -> [u32; 8] {
        let mut whole = [0u32; 8];
        // SAFETY: as above. The store is of the array's eight.
        unsafe {
            let last = _mm256_set1_epi32(N as i32 - 1);
            let at = _mm256_min_epu32(_mm256_cvttps_epi32(self.0), last);
            _mm256_storeu_si256(whole.as_mut_ptr().cast(), at);
        }
        whole
    }
}

impl Shorts<16> for Shorts16 {
    methods! {
        add(other) = _mm256_add_epi16;
        mul(other) = _mm256_mullo_epi16;
        abs() = _mm256_abs_epi16;
        max_unsigned(other) = _mm256_max_epu16;
    }
    #[inline(always)]
    fn below(self, next: Self, limit: Self) -> u32 {
        intrinsics!({
            let own = _mm256_cmpgt_epi16(limit.0, self.0);
            let next = _mm256_cmpgt_epi16(limit.0, next.0);
            // Packing works by halves.
            _mm256_movemask_epi8(_mm256_packs_epi16(own, next)) as u32
        })
    }
}

impl Masks<4> for Masks4 {
    methods! {
        and(other) = _mm256_and_si256;
    }
    #[inline(always)]
    fn zeros(self) -> u32 {
        intrinsics!({
            let zeros = _mm256_cmpeq_epi64(self.0, _mm256_setzero_si256());
            _mm256_movemask_pd(_mm256_castsi256_pd(zeros)) as u32
        })
    }
}

/// By octant: the outer octants' order, and a mask's lower and upper half turned.
static TURNS: [[[u8; 16]; 3]; 8] = {
    let mut table = [[[0; 16]; 3]; 8];
    let mut i = 0;
    while i < 128 {
        let (octant, at) = (i as u8 >> 4, i & 15);
        table[i >> 4][0][at] = (at as u8 & 7) ^ octant;
        table[i >> 4][1][at] = (turned_parts(at as u64, octant) >> (8 * octant)) as u8;
        table[i >> 4][2][at] = (turned_parts((at as u64) << 4, octant) >> (8 * octant)) as u8;
        i += 1;
    }
    table
};

impl Isa for Vector {
    type F32x4 = Floats4;
    type F32x8 = Floats8;
    type F64x4 = Doubles4;
    type I16x16 = Shorts16;
    type U64x4 = Masks4;

    fn detect() -> Option<Self> {
        let found = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        found.then_some(Self(()))
    }
    #[inline(always)]
    fn vectorize<T, A>(self, target: &mut T, argument: A, step: impl FnOnce(&mut T, A)) {
        #[inline(never)]
        #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
        fn compiled<T, A>(target: &mut T, argument: A, step: impl FnOnce(&mut T, A)) {
            step(target, argument);
        }
        // SAFETY: a `Vector` is only made where these features were found.
        unsafe { compiled(target, argument, step) };
    }
    #[inline(always)]
    fn narrow(self, wide: Doubles4) -> Floats4 {
        intrinsics!(Floats4(_mm256_cvtpd_ps(wide.0)))
    }
    #[inline(always)]
    fn join(self, low: Floats4, high: Floats4) -> Floats8 {
        intrinsics!(Floats8(_mm256_set_m128(high.0, low.0)))
    }
    #[inline(always)]
    fn broadcast<const LANE: i32>(self, from: Floats4) -> Floats8 {
        intrinsics!(Floats8(_mm256_broadcastss_ps(match LANE {
            0 => from.0,
            1 => _mm_movehdup_ps(from.0),
            _ => _mm_movehl_ps(from.0, from.0),
        })))
    }
    #[inline(always)]
    fn broadcast_rounded<const LANE: i32>(self, from: Floats4) -> Shorts16 {
        intrinsics!({
            let rounded = _mm_cvtps_epi32(from.0);
            let rounded = _mm_packs_epi32(rounded, rounded);
            Shorts16(_mm256_broadcastw_epi16(match LANE {
                0 => rounded,
                1 => _mm_srli_si128::<2>(rounded),
                _ => _mm_srli_si128::<4>(rounded),
            }))
        })
    }
    #[inline(always)]
    fn expand(self, bytes: u64, mask: u8) -> [u64; 2] {
        intrinsics!({
            let places = _pdep_u64(u64::from(mask), 0x0101_0101_0101_0101);
            let ones = (places << 8).wrapping_sub(places);
            [_pdep_u64(bytes, ones), ones]
        })
    }
    #[inline(always)]
    fn turned(self, parts: u64, octant: u8) -> u64 {
        let tables = &TURNS[usize::from(octant & 7)];
        // SAFETY: as above. The loads are of the tables' bytes.
        unsafe {
            let [outer, low, high] = [0, 1, 2].map(|i| _mm_loadu_si128(tables[i].as_ptr().cast()));
            let bytes = _mm_shuffle_epi8(_mm_cvtsi64_si128(parts as i64), outer);
            let half = _mm_set1_epi8(15);
            let low = _mm_shuffle_epi8(low, _mm_and_si128(bytes, half));
            let upper = _mm_and_si128(_mm_srli_epi16::<4>(bytes), half);
            _mm_cvtsi128_si64(_mm_or_si128(low, _mm_shuffle_epi8(high, upper))) as u64
        }
    }
    #[inline(always)]
    fn store_masked(self, to: &mut [u32], width: usize, mask: u64, from: &[u32], step: usize) {
        assert!(width.saturating_mul(7).saturating_add(8) <= to.len());
        assert!(step.saturating_mul(7).saturating_add(8) <= from.len());
        let first = to.as_mut_ptr();
        let row = |i: usize| first.wrapping_add(i * width).cast::<__m256i>();
        let values = |i: usize| from.as_ptr().wrapping_add(i * step).cast();
        // SAFETY: as above. The eight entries and values of each of eight rows exist, as was checked.
        unsafe {
            let halves = [mask, mask >> 32].map(|half| _mm256_set1_epi32(half as i32));
            let columns = _mm256_setr_epi32(31, 30, 29, 28, 27, 26, 25, 24);
            // Loads first: rows are often 4096 bytes apart, which processors take for the same place for a while.
            let before = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| _mm256_loadu_si256(row(i)));
            for (i, before) in before.into_iter().enumerate() {
                let value = _mm256_loadu_si256(values(i));
                // Each column's bit becomes its lane's sign, and that all of the lane.
                let places = _mm256_sub_epi32(columns, _mm256_set1_epi32(8 * (i as i32 & 3)));
                let mask = _mm256_srai_epi32::<31>(_mm256_sllv_epi32(halves[i / 4], places));
                // Masked stores are slow on AMD.
                _mm256_storeu_si256(row(i), _mm256_blendv_epi8(before, value, mask));
            }
        }
    }
}
