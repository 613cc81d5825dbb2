use std::arch::wasm32::*;

use super::*;
use halves::Pair;

#[path = "halves.rs"]
mod halves;

/// The 128-bit vectors of WebAssembly, which has no fused multiply-add. Chosen when the program is compiled.
#[derive(Debug, Clone, Copy)]
pub(in crate::fast) struct Vector;

/// An expression of intrinsics.
macro_rules! intrinsics {
    ($value:expr) => {
        $value
    };
}

lanes! {
    Floats4([f32; 4] in v128, v128_load, f32x4_splat);
    Doubles2([f64; 2] in v128, v128_load, f64x2_splat);
    Shorts8([i16; 8] in v128, v128_load, i16x8_splat);
    Masks2([u64; 2] in v128, v128_load, u64x2_splat);
}

macro_rules! floats {
    ($name:ident[$n:literal]: $add:ident $sub:ident $mul:ident $div:ident
     $max:ident $min:ident $abs:ident $floor:ident $ceil:ident) => {
        impl Floats<$n> for $name {
            methods! {
                add(other) = $add;
                sub(other) = $sub;
                mul(other) = $mul;
                div(other) = $div;
                abs() = $abs;
                floor() = $floor;
                ceil() = $ceil;
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                // The other where one is no number, as AVX has it.
                Self($max(other.0, self.0))
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                Self($min(other.0, self.0))
            }
            #[inline(always)]
            fn fma(self, by: Self, plus: Self) -> Self {
                self.mul(by).add(plus)
            }
            #[inline(always)]
            fn fms(self, by: Self, less: Self) -> Self {
                self.mul(by).sub(less)
            }
            #[inline(always)]
            fn fnma(self, by: Self, from: Self) -> Self {
                from.sub(self.mul(by))
            }
        }
    };
}
floats! { Floats4[4]: f32x4_add f32x4_sub f32x4_mul f32x4_div
f32x4_pmax f32x4_pmin f32x4_abs f32x4_floor f32x4_ceil }
floats! { Doubles2[2]: f64x2_add f64x2_sub f64x2_mul f64x2_div
f64x2_pmax f64x2_pmin f64x2_abs f64x2_floor f64x2_ceil }

#[inline(always)]
fn four(lanes: v128) -> [u32; 4] {
    [
        u32x4_extract_lane::<0>(lanes),
        u32x4_extract_lane::<1>(lanes),
        u32x4_extract_lane::<2>(lanes),
        u32x4_extract_lane::<3>(lanes),
    ]
}

impl F32x4 for Floats4 {
    methods! {
        flip(signs) = v128_xor;
    }
    #[inline(always)]
    fn next(self) -> Self {
        Self(i32x4_shuffle::<1, 2, 0, 3>(self.0, self.0))
    }
    #[inline(always)]
    fn last(self) -> Self {
        Self(i32x4_shuffle::<2, 0, 1, 3>(self.0, self.0))
    }
    #[inline(always)]
    fn signs(self) -> u32 {
        u32::from(i32x4_bitmask(self.0))
    }
    #[inline(always)]
    fn indices<const N: usize>(self) -> [usize; 3] {
        // The bounds are repeated for the compiler to see.
        let [a, b, c, _] = Tests::indices::<N>(self).map(|at| at as usize % N);
        [a, b, c]
    }
    #[inline(always)]
    fn values(self) -> [f32; 4] {
        four(self.0).map(f32::from_bits)
    }
    #[inline(always)]
    fn sums(self, other: Self) -> Self {
        let pairs = |a, b| {
            let even = i32x4_shuffle::<0, 2, 4, 6>(a, b);
            f32x4_add(even, i32x4_shuffle::<1, 3, 5, 7>(a, b))
        };
        let halves = pairs(self.0, other.0);
        Self(pairs(halves, halves))
    }
    #[inline(always)]
    fn whole(self) -> [i32; 4] {
        Tests::whole(self)
    }
}

impl Tests<4> for Floats4 {
    #[inline(always)]
    fn at_most(self, other: Self) -> u8 {
        i32x4_bitmask(f32x4_le(self.0, other.0))
    }
    #[inline(always)]
    fn reciprocal(self) -> Self {
        Self(f32x4_splat(1.0)).div(self)
    }
    #[inline(always)]
    fn whole(self) -> [i32; 4] {
        four(i32x4_trunc_sat_f32x4(self.0)).map(|whole| whole as i32)
    }
    #[inline(always)]
    fn indices<const N: usize>(self) -> [u32; 4] {
        let whole = i32x4_trunc_sat_f32x4(self.0);
        four(u32x4_min(whole, u32x4_splat(N as u32 - 1)))
    }
}

impl Shorts<8> for Shorts8 {
    methods! {
        add(other) = i16x8_add;
        mul(other) = i16x8_mul;
        abs() = i16x8_abs;
        max_unsigned(other) = u16x8_max;
    }
    #[inline(always)]
    fn below(self, next: Self, limit: Self) -> u32 {
        let [own, next] = [self, next].map(|lanes| i16x8_lt(lanes.0, limit.0));
        u32::from(i8x16_bitmask(i8x16_narrow_i16x8(own, next)))
    }
}

impl Masks<2> for Masks2 {
    methods! {
        and(other) = v128_and;
    }
    #[inline(always)]
    fn zeros(self) -> u32 {
        u32::from(i64x2_bitmask(i64x2_eq(self.0, u64x2_splat(0))))
    }
}

impl Isa for Vector {
    type F32x4 = Floats4;
    type F32x8 = Pair<Floats4>;
    type F64x4 = Pair<Doubles2>;
    type I16x16 = Pair<Shorts8>;
    type U64x4 = Pair<Masks2>;

    fn detect() -> Option<Self> {
        Some(Self)
    }
    #[inline(always)]
    fn narrow(self, wide: Self::F64x4) -> Floats4 {
        let [low, high] = [wide.0, wide.1].map(|half| f32x4_demote_f64x2_zero(half.0));
        Floats4(i32x4_shuffle::<0, 1, 4, 5>(low, high))
    }
    #[inline(always)]
    fn join(self, low: Floats4, high: Floats4) -> Self::F32x8 {
        Pair(low, high)
    }
    #[inline(always)]
    fn broadcast<const LANE: i32>(self, from: Floats4) -> Self::F32x8 {
        Self::F32x8::splat(self, from.values()[LANE as usize])
    }
    #[inline(always)]
    fn broadcast_rounded<const LANE: i32>(self, from: Floats4) -> Self::I16x16 {
        let rounded = i32x4_trunc_sat_f32x4(f32x4_nearest(from.0));
        let lane = four(rounded)[LANE as usize] as i32;
        Self::I16x16::splat(self, lane.clamp(-0x8000, 0x7fff) as i16)
    }
}
