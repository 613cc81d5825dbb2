//! [`Reals`] in vectors of AVX2 and AVX-512.
//!
//! SAFETY of all: a value of these types is only made by the steps of an
//! [`super::Avx2`] or [`super::Avx512`], which are only made where the
//! processor has the instructions. Nothing here touches memory but as said.

use std::arch::x86_64::*;
use std::ops::{Add, Mul, Sub};

use super::reals::{EXPONENT, Reals, scale_base};

/// Two vectors of four.
#[derive(Debug, Clone, Copy)]
pub(in crate::fast) struct Avx2Reals(pub(super) __m256d, pub(super) __m256d);

/// One vector of eight.
#[derive(Debug, Clone, Copy)]
pub(in crate::fast) struct Avx512Reals(pub(super) __m512d);

impl Avx512Reals {
    /// Lanes 0 to 3, and lanes 4 to 7.
    #[inline(always)]
    pub(super) fn halves(self) -> [__m256d; 2] {
        // SAFETY: see the top of the file.
        unsafe {
            [
                _mm512_castpd512_pd256(self.0),
                _mm512_extractf64x4_pd::<1>(self.0),
            ]
        }
    }
}

/// An operator of both types.
macro_rules! operator {
    ($operator:ident, $name:ident, $four:ident, $eight:ident) => {
        impl $operator for Avx2Reals {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                // SAFETY: see the top of the file.
                unsafe { Self($four(self.0, other.0), $four(self.1, other.1)) }
            }
        }

        impl $operator for Avx512Reals {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                // SAFETY: see the top of the file.
                unsafe { Self($eight(self.0, other.0)) }
            }
        }
    };
}

operator!(Add, add, _mm256_add_pd, _mm512_add_pd);
operator!(Sub, sub, _mm256_sub_pd, _mm512_sub_pd);
operator!(Mul, mul, _mm256_mul_pd, _mm512_mul_pd);

/// [`Reals::sums`] of lanes 0 to 3 and lanes 4 to 7: the total, and the
/// differences by axis.
#[inline(always)]
fn sums(low: __m256d, high: __m256d) -> (f64, __m256d) {
    // SAFETY: see the top of the file.
    unsafe {
        let (sum, difference) = (_mm256_add_pd(low, high), _mm256_sub_pd(high, low));
        // By halves: sums along the last axis of both.
        let pairs = _mm256_hadd_pd(sum, difference);
        let (first, second) = (
            _mm256_castpd256_pd128(pairs),
            _mm256_extractf128_pd::<1>(pairs),
        );
        let total = _mm_add_pd(first, second);
        let along_y = _mm_sub_pd(second, first);
        let along_z = _mm_add_pd(_mm256_castpd256_pd128(sum), _mm256_extractf128_pd::<1>(sum));
        let along_z = _mm_sub_pd(_mm_unpackhi_pd(along_z, along_z), along_z);
        let along_z = _mm_mul_pd(along_z, _mm_setr_pd(1.0, 0.0));
        let along_x_and_y = _mm_shuffle_pd::<0b01>(total, along_y);
        (
            _mm_cvtsd_f64(total),
            _mm256_set_m128d(along_z, along_x_and_y),
        )
    }
}

impl Reals for Avx2Reals {
    #[inline(always)]
    fn first(self) -> [f64; 4] {
        let mut first = [0.0; 4];
        // SAFETY: see the top of the file; the array has four entries.
        unsafe { _mm256_storeu_pd(first.as_mut_ptr(), self.0) };
        first
    }

    #[inline(always)]
    fn over(self, by: Self) -> Self {
        // SAFETY: see the top of the file.
        unsafe { Self(_mm256_div_pd(self.0, by.0), _mm256_div_pd(self.1, by.1)) }
    }

    #[inline(always)]
    fn fused(self, by: Self, plus: Self) -> Self {
        // SAFETY: see the top of the file.
        unsafe {
            Self(
                _mm256_fmadd_pd(self.0, by.0, plus.0),
                _mm256_fmadd_pd(self.1, by.1, plus.1),
            )
        }
    }

    #[inline(always)]
    fn floor(self) -> Self {
        // SAFETY: see the top of the file.
        unsafe { Self(_mm256_floor_pd(self.0), _mm256_floor_pd(self.1)) }
    }

    #[inline(always)]
    fn trunc(self) -> Self {
        const TOWARDS_ZERO: i32 = _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC;
        // SAFETY: see the top of the file.
        unsafe {
            Self(
                _mm256_round_pd::<TOWARDS_ZERO>(self.0),
                _mm256_round_pd::<TOWARDS_ZERO>(self.1),
            )
        }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see the top of the file.
        unsafe {
            let sign = _mm256_set1_pd(-0.0);
            Self(
                _mm256_andnot_pd(sign, self.0),
                _mm256_andnot_pd(sign, self.1),
            )
        }
    }

    #[inline(always)]
    fn least(self, other: Self) -> Self {
        // SAFETY: see the top of the file.
        unsafe {
            Self(
                _mm256_min_pd(self.0, other.0),
                _mm256_min_pd(self.1, other.1),
            )
        }
    }

    #[inline(always)]
    fn greatest(self, other: Self) -> Self {
        // SAFETY: see the top of the file.
        unsafe {
            Self(
                _mm256_max_pd(self.0, other.0),
                _mm256_max_pd(self.1, other.1),
            )
        }
    }

    #[inline(always)]
    fn is_at_least(self, other: Self) -> Self {
        // SAFETY: see the top of the file.
        unsafe {
            let one = _mm256_set1_pd(1.0);
            Self(
                _mm256_and_pd(one, _mm256_cmp_pd::<_CMP_GE_OQ>(self.0, other.0)),
                _mm256_and_pd(one, _mm256_cmp_pd::<_CMP_GE_OQ>(self.1, other.1)),
            )
        }
    }

    #[inline(always)]
    fn any_negative(self) -> bool {
        // SAFETY: see the top of the file.
        unsafe {
            let least = _mm256_min_pd(self.0, self.1);
            let below = _mm256_cmp_pd::<_CMP_LT_OQ>(least, _mm256_setzero_pd());
            _mm256_movemask_pd(below) != 0
        }
    }

    #[inline(always)]
    fn scale_to(self, bits: u32) -> Self {
        // SAFETY: see the top of the file.
        unsafe {
            let base = _mm256_set1_epi64x(scale_base(bits) as i64);
            let exponent = _mm256_set1_epi64x(EXPONENT as i64);
            let low = _mm256_and_si256(_mm256_castpd_si256(self.0), exponent);
            let high = _mm256_and_si256(_mm256_castpd_si256(self.1), exponent);
            Self(
                _mm256_castsi256_pd(_mm256_sub_epi64(base, low)),
                _mm256_castsi256_pd(_mm256_sub_epi64(base, high)),
            )
        }
    }

    #[inline(always)]
    fn sums(self) -> (f64, Self) {
        let (total, edges) = sums(self.0, self.1);
        // SAFETY: see the top of the file.
        unsafe { (total, Self(edges, _mm256_setzero_pd())) }
    }
}

impl Reals for Avx512Reals {
    #[inline(always)]
    fn first(self) -> [f64; 4] {
        let mut first = [0.0; 4];
        // SAFETY: see the top of the file; the array has four entries.
        unsafe { _mm256_storeu_pd(first.as_mut_ptr(), _mm512_castpd512_pd256(self.0)) };
        first
    }

    #[inline(always)]
    fn over(self, by: Self) -> Self {
        // SAFETY: see the top of the file.
        unsafe { Self(_mm512_div_pd(self.0, by.0)) }
    }

    #[inline(always)]
    fn fused(self, by: Self, plus: Self) -> Self {
        // SAFETY: see the top of the file.
        unsafe { Self(_mm512_fmadd_pd(self.0, by.0, plus.0)) }
    }

    #[inline(always)]
    fn floor(self) -> Self {
        const DOWN: i32 = _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC;
        // SAFETY: see the top of the file.
        unsafe { Self(_mm512_roundscale_pd::<DOWN>(self.0)) }
    }

    #[inline(always)]
    fn trunc(self) -> Self {
        const TOWARDS_ZERO: i32 = _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC;
        // SAFETY: see the top of the file.
        unsafe { Self(_mm512_roundscale_pd::<TOWARDS_ZERO>(self.0)) }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see the top of the file.
        unsafe { Self(_mm512_abs_pd(self.0)) }
    }

    #[inline(always)]
    fn least(self, other: Self) -> Self {
        // SAFETY: see the top of the file.
        unsafe { Self(_mm512_min_pd(self.0, other.0)) }
    }

    #[inline(always)]
    fn greatest(self, other: Self) -> Self {
        // SAFETY: see the top of the file.
        unsafe { Self(_mm512_max_pd(self.0, other.0)) }
    }

    #[inline(always)]
    fn is_at_least(self, other: Self) -> Self {
        // SAFETY: see the top of the file.
        unsafe {
            let lanes = _mm512_cmp_pd_mask::<_CMP_GE_OQ>(self.0, other.0);
            Self(_mm512_maskz_mov_pd(lanes, _mm512_set1_pd(1.0)))
        }
    }

    #[inline(always)]
    fn any_negative(self) -> bool {
        // SAFETY: see the top of the file.
        unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, _mm512_setzero_pd()) != 0 }
    }

    #[inline(always)]
    fn scale_to(self, bits: u32) -> Self {
        // SAFETY: see the top of the file.
        unsafe {
            let base = _mm512_set1_epi64(scale_base(bits) as i64);
            let exponent = _mm512_set1_epi64(EXPONENT as i64);
            let own = _mm512_and_si512(_mm512_castpd_si512(self.0), exponent);
            Self(_mm512_castsi512_pd(_mm512_sub_epi64(base, own)))
        }
    }

    #[inline(always)]
    fn sums(self) -> (f64, Self) {
        let [low, high] = self.halves();
        let (total, edges) = sums(low, high);
        // SAFETY: see the top of the file.
        unsafe { (total, Self(_mm512_zextpd256_pd512(edges))) }
    }
}
