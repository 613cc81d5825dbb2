use std::arch::aarch64::*;

use super::*;
use halves::Pair;

#[path = "halves.rs"]
mod halves;

/// NEON, which all 64-bit Arm processors have.
#[derive(Debug, Clone, Copy)]
pub(in crate::fast) struct Vector;

/// An expression of intrinsics that read no memory.
macro_rules! intrinsics {
    ($value:expr) => {
        // SAFETY: all 64-bit Arm processors have these instructions.
        unsafe { $value }
    };
}

lanes! {
    Floats4([f32; 4] in float32x4_t, vld1q_f32, vdupq_n_f32);
    Doubles2([f64; 2] in float64x2_t, vld1q_f64, vdupq_n_f64);
    Shorts8([i16; 8] in int16x8_t, vld1q_s16, vdupq_n_s16);
    Masks2([u64; 2] in uint64x2_t, vld1q_u64, vdupq_n_u64);
}

macro_rules! floats {
    ($name:ident[$n:literal]: $add:ident $sub:ident $mul:ident $div:ident
     $fma:ident $fms:ident $neg:ident $max:ident $min:ident
     $abs:ident $floor:ident $ceil:ident) => {
        impl Floats<$n> for $name {
            methods! {
                add(other) = $add;
                sub(other) = $sub;
                mul(other) = $mul;
                div(other) = $div;
                max(other) = $max;
                min(other) = $min;
                abs() = $abs;
                floor() = $floor;
                ceil() = $ceil;
            }
            #[inline(always)]
            fn fma(self, by: Self, plus: Self) -> Self {
                intrinsics!(Self($fma(plus.0, self.0, by.0)))
            }
            #[inline(always)]
            fn fms(self, by: Self, less: Self) -> Self {
                intrinsics!(Self($fma($neg(less.0), self.0, by.0)))
            }
            #[inline(always)]
            fn fnma(self, by: Self, from: Self) -> Self {
                intrinsics!(Self($fms(from.0, self.0, by.0)))
            }
        }
    };
}
floats! { Floats4[4]: vaddq_f32 vsubq_f32 vmulq_f32 vdivq_f32
vfmaq_f32 vfmsq_f32 vnegq_f32 vmaxnmq_f32 vminnmq_f32
vabsq_f32 vrndmq_f32 vrndpq_f32 }
floats! { Doubles2[2]: vaddq_f64 vsubq_f64 vmulq_f64 vdivq_f64
vfmaq_f64 vfmsq_f64 vnegq_f64 vmaxnmq_f64 vminnmq_f64
vabsq_f64 vrndmq_f64 vrndpq_f64 }

/// Places of bytes, for lanes 1, 2, 0, 3 and 2, 0, 1, 3.
static NEXT: [u8; 16] = [4, 5, 6, 7, 8, 9, 10, 11, 0, 1, 2, 3, 12, 13, 14, 15];
static LAST: [u8; 16] = [8, 9, 10, 11, 0, 1, 2, 3, 4, 5, 6, 7, 12, 13, 14, 15];

impl Floats4 {
    #[inline(always)]
    fn in_order(self, places: &[u8; 16]) -> Self {
        // SAFETY: all 64-bit Arm processors have these instructions. The load is of the array's bytes.
        unsafe {
            let bytes = vqtbl1q_u8(vreinterpretq_u8_f32(self.0), vld1q_u8(places.as_ptr()));
            Self(vreinterpretq_f32_u8(bytes))
        }
    }
}

/// The highest bit of each lane.
#[inline(always)]
fn highest(lanes: uint32x4_t) -> u32 {
    let places = [0, 1, 2, 3];
    // SAFETY: all 64-bit Arm processors have these instructions. The load is of the array's lanes.
    unsafe {
        let bits = vshrq_n_u32::<31>(lanes);
        vaddvq_u32(vshlq_u32(bits, vld1q_s32(places.as_ptr())))
    }
}

#[inline(always)]
fn four(lanes: uint32x4_t) -> [u32; 4] {
    intrinsics!([
        vgetq_lane_u32::<0>(lanes),
        vgetq_lane_u32::<1>(lanes),
        vgetq_lane_u32::<2>(lanes),
        vgetq_lane_u32::<3>(lanes),
    ])
}

impl F32x4 for Floats4 {
    #[inline(always)]
    fn flip(self, signs: Self) -> Self {
        intrinsics!({
            let [own, signs] = [self, signs].map(|lanes| vreinterpretq_u32_f32(lanes.0));
            Self(vreinterpretq_f32_u32(veorq_u32(own, signs)))
        })
    }
    #[inline(always)]
    fn next(self) -> Self {
        self.in_order(&NEXT)
    }
    #[inline(always)]
    fn last(self) -> Self {
        self.in_order(&LAST)
    }
    #[inline(always)]
    fn signs(self) -> u32 {
        intrinsics!(highest(vreinterpretq_u32_f32(self.0)))
    }
    #[inline(always)]
    fn indices<const N: usize>(self) -> [usize; 3] {
        // The bounds are repeated for the compiler to see.
        let [a, b, c, _] = Tests::indices::<N>(self).map(|at| at as usize % N);
        [a, b, c]
    }
    #[inline(always)]
    fn values(self) -> [f32; 4] {
        intrinsics!(four(vreinterpretq_u32_f32(self.0))).map(f32::from_bits)
    }
    #[inline(always)]
    fn sums(self, other: Self) -> Self {
        intrinsics!({
            let pairs = vpaddq_f32(self.0, other.0);
            Self(vpaddq_f32(pairs, pairs))
        })
    }
    #[inline(always)]
    fn whole(self) -> [i32; 4] {
        Tests::whole(self)
    }
}

impl Tests<4> for Floats4 {
    #[inline(always)]
    fn at_most(self, other: Self) -> u8 {
        intrinsics!(highest(vcleq_f32(self.0, other.0))) as u8
    }
    #[inline(always)]
    fn reciprocal(self) -> Self {
        Self::splat(Vector, 1.0).div(self)
    }
    #[inline(always)]
    fn whole(self) -> [i32; 4] {
        intrinsics!(four(vreinterpretq_u32_s32(vcvtq_s32_f32(self.0)))).map(|whole| whole as i32)
    }
    #[inline(always)]
    fn indices<const N: usize>(self) -> [u32; 4] {
        four(intrinsics!({
            let whole = vreinterpretq_u32_s32(vcvtq_s32_f32(self.0));
            vminq_u32(whole, vdupq_n_u32(N as u32 - 1))
        }))
    }
}

impl Shorts<8> for Shorts8 {
    methods! {
        add(other) = vaddq_s16;
        mul(other) = vmulq_s16;
        abs() = vabsq_s16;
    }
    #[inline(always)]
    fn max_unsigned(self, other: Self) -> Self {
        intrinsics!({
            let [own, other] = [self, other].map(|lanes| vreinterpretq_u16_s16(lanes.0));
            Self(vreinterpretq_s16_u16(vmaxq_u16(own, other)))
        })
    }
    #[inline(always)]
    fn below(self, next: Self, limit: Self) -> u32 {
        let bits = [1, 2, 4, 8, 16, 32, 64, 128];
        // SAFETY: all 64-bit Arm processors have these instructions. The load is of the array's lanes.
        let [own, next] = unsafe {
            let bits = vld1_u8(bits.as_ptr());
            [self, next].map(|lanes| {
                let is_below = vmovn_u16(vcltq_s16(lanes.0, limit.0));
                u32::from(vaddv_u8(vand_u8(is_below, bits)))
            })
        };
        own | next << 8
    }
}

impl Masks<2> for Masks2 {
    methods! {
        and(other) = vandq_u64;
    }
    #[inline(always)]
    fn zeros(self) -> u32 {
        intrinsics!({
            let zeros = vceqzq_u64(self.0);
            (vgetq_lane_u64::<0>(zeros) & 1 | vgetq_lane_u64::<1>(zeros) & 2) as u32
        })
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
    fn narrow(self, Pair(low, high): Self::F64x4) -> Floats4 {
        intrinsics!(Floats4(vcvt_high_f32_f64(vcvt_f32_f64(low.0), high.0)))
    }
    #[inline(always)]
    fn join(self, low: Floats4, high: Floats4) -> Self::F32x8 {
        Pair(low, high)
    }
    #[inline(always)]
    fn broadcast<const LANE: i32>(self, from: Floats4) -> Self::F32x8 {
        let all = intrinsics!(Floats4(vdupq_laneq_f32::<LANE>(from.0)));
        Pair(all, all)
    }
    #[inline(always)]
    fn broadcast_rounded<const LANE: i32>(self, from: Floats4) -> Self::I16x16 {
        let all = intrinsics!({
            let rounded = vqmovn_s32(vcvtnq_s32_f32(from.0));
            Shorts8(vdupq_lane_s16::<LANE>(rounded))
        });
        Pair(all, all)
    }
    #[inline(always)]
    fn store_masked(self, to: &mut [u32], width: usize, mask: u64, from: &[u32], step: usize) {
        let bits = [1, 2, 4, 8, 16, 32, 64, 128];
        assert!(width.saturating_mul(7).saturating_add(8) <= to.len());
        for i in 0..8 {
            let (fours, _) = to[i * width..][..8].as_chunks_mut::<4>();
            let (values, _) = from[i * step..][..8].as_chunks::<4>();
            let of_columns = values.iter().zip(bits.as_chunks::<4>().0);
            for (four, (value, bits)) in fours.iter_mut().zip(of_columns) {
                // SAFETY: all 64-bit Arm processors have these instructions. Loads and the store are of the arrays' lanes.
                unsafe {
                    let mask = vdupq_n_u32((mask >> (8 * i)) as u32);
                    let mask = vtstq_u32(mask, vld1q_u32(bits.as_ptr()));
                    let value = vld1q_u32(value.as_ptr());
                    let before = vld1q_u32(four.as_ptr());
                    vst1q_u32(four.as_mut_ptr(), vbslq_u32(mask, value, before));
                }
            }
        }
    }
}
