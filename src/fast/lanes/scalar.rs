//! Plain Rust: the definition of every operation.

use std::array::from_fn;

use super::*;

#[derive(Debug, Clone, Copy)]
pub(in crate::fast) struct Scalar;

impl<T: Copy + Send + Sync + Debug, const N: usize> Lanes<N> for [T; N] {
    type Isa = Scalar;
    type Lane = T;
    #[inline(always)]
    fn load(_: Scalar, values: &[T; N]) -> Self {
        *values
    }
    #[inline(always)]
    fn splat(_: Scalar, value: T) -> Self {
        [value; N]
    }
}

/// Methods that work lane by lane: lanes of the vectors, and the result.
macro_rules! lane_by_lane {
    ($($name:ident($lane:ident $(, $other:ident)*) = $value:expr;)*) => {$(
        #[inline(always)]
        fn $name(self $(, $other: Self)*) -> Self {
            from_fn(|i| {
                let ($lane, $($other,)*) = (self[i], $($other[i],)*);
                $value
            })
        }
    )*};
}

macro_rules! floats {
    ($lane:ty) => {
        impl<const N: usize> Floats<N> for [$lane; N] {
            lane_by_lane! {
                add(a, b) = a + b;
                sub(a, b) = a - b;
                mul(a, b) = a * b;
                div(a, b) = a / b;
                fma(a, by, plus) = a * by + plus;
                fms(a, by, less) = a * by - less;
                fnma(a, by, from) = from - a * by;
                max(a, b) = a.max(b);
                min(a, b) = a.min(b);
                abs(a) = a.abs();
                floor(a) = a.floor();
                ceil(a) = a.ceil();
            }
        }
    };
}
floats!(f32);
floats!(f64);

#[inline(always)]
fn bits<const N: usize>(holds: impl Fn(usize) -> bool) -> u32 {
    (0..N).fold(0, |bits, i| bits | u32::from(holds(i)) << i)
}

#[inline(always)]
fn index<const N: usize>(at: f32) -> usize {
    (at as i32 as u32 as usize).min(N - 1)
}

impl F32x4 for [f32; 4] {
    lane_by_lane! {
        flip(a, sign) = if sign.is_sign_negative() { -a } else { a };
    }
    #[inline(always)]
    fn next(self) -> Self {
        [self[1], self[2], self[0], self[3]]
    }
    #[inline(always)]
    fn last(self) -> Self {
        [self[2], self[0], self[1], self[3]]
    }
    #[inline(always)]
    fn signs(self) -> u32 {
        bits::<4>(|i| self[i].is_sign_negative())
    }
    #[inline(always)]
    fn indices<const N: usize>(self) -> [usize; 3] {
        [0, 1, 2].map(|i| index::<N>(self[i]))
    }
    #[inline(always)]
    fn values(self) -> [f32; 4] {
        self
    }
    #[inline(always)]
    fn sums(self, other: Self) -> Self {
        let [a, b] = [self, other].map(|lanes| lanes.iter().sum());
        [a, b, a, b]
    }
    #[inline(always)]
    fn whole(self) -> [i32; 4] {
        self.map(|c| c as i32)
    }
}

impl<const N: usize> Tests<N> for [f32; N] {
    #[inline(always)]
    fn at_most(self, other: Self) -> u8 {
        bits::<N>(|i| self[i] <= other[i]) as u8
    }
    #[inline(always)]
    fn reciprocal(self) -> Self {
        self.map(|c| 1.0 / c)
    }
    #[inline(always)]
    fn whole(self) -> [i32; N] {
        self.map(|c| c as i32)
    }
    #[inline(always)]
    fn indices<const M: usize>(self) -> [u32; N] {
        self.map(|at| index::<M>(at) as u32)
    }
}

impl<const N: usize> Shorts<N> for [i16; N] {
    lane_by_lane! {
        add(a, b) = a.wrapping_add(b);
        mul(a, b) = a.wrapping_mul(b);
        abs(a) = a.wrapping_abs();
        max_unsigned(a, b) = (a as u16).max(b as u16) as i16;
    }
    #[inline(always)]
    fn below(self, next: Self, limit: Self) -> u32 {
        let [own, next] = [self, next].map(|lanes| bits::<N>(|i| lanes[i] < limit[i]));
        let eight = |i: usize| (own >> i & 0xff | (next >> i & 0xff) << 8) << (2 * i);
        (0..N).step_by(8).map(eight).sum()
    }
}

impl<const N: usize> Masks<N> for [u64; N] {
    lane_by_lane! {
        and(a, b) = a & b;
    }
    #[inline(always)]
    fn zeros(self) -> u32 {
        bits::<N>(|i| self[i] == 0)
    }
}

impl Isa for Scalar {
    type F32x4 = [f32; 4];
    type F32x8 = [f32; 8];
    type F64x4 = [f64; 4];
    type I16x16 = [i16; 16];
    type U64x4 = [u64; 4];

    fn detect() -> Option<Self> {
        Some(Self)
    }
    #[inline(always)]
    fn narrow(self, wide: [f64; 4]) -> [f32; 4] {
        wide.map(|c| c as f32)
    }
    #[inline(always)]
    fn join(self, low: [f32; 4], high: [f32; 4]) -> [f32; 8] {
        from_fn(|i| if i < 4 { low[i] } else { high[i - 4] })
    }
    #[inline(always)]
    fn broadcast<const LANE: i32>(self, from: [f32; 4]) -> [f32; 8] {
        [from[LANE as usize]; 8]
    }
    #[inline(always)]
    fn broadcast_rounded<const LANE: i32>(self, from: [f32; 4]) -> [i16; 16] {
        [from[LANE as usize].round_ties_even() as i16; 16]
    }
}
