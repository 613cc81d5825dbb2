//! Operations on lanes. [`Scalar`] defines them. An instruction set is a value that exists only where the processor has
//! the set, and vectors are made only from it. Sets round differently, on which no picture depends.
//!
//! Each large step of the traversal runs in [`Isa::vectorize`]. Functions below it that use lanes are
//! `#[inline(always)]`.

/// Vectors of a set, each a register, with the intrinsics that load and fill it. Each set calls the others by its own macro
/// `intrinsics!`.
#[allow(unused_macros, reason = "some processors have no vectors")]
macro_rules! lanes {
    ($($name:ident([$lane:ty; $n:literal] in $register:ty, $load:ident, $splat:ident);)*) => {$(
        #[derive(Debug, Clone, Copy)]
        pub(in crate::fast) struct $name($register);

        impl Lanes<$n> for $name {
            type Isa = Vector;
            type Lane = $lane;
            #[inline(always)]
            fn load(_: Vector, values: &[$lane; $n]) -> Self {
                // SAFETY: a `Vector` is only made where its set was found. The load is of the array's lanes.
                unsafe { Self($load(values.as_ptr().cast())) }
            }
            #[inline(always)]
            fn splat(_: Vector, value: $lane) -> Self {
                intrinsics!(Self($splat(value as _)))
            }
        }
    )*};
}

/// Methods that are an intrinsic each.
#[allow(unused_macros, reason = "some processors have no vectors")]
macro_rules! methods {
    ($($name:ident($($other:ident),*) = $intrinsic:ident;)*) => {$(
        #[inline(always)]
        fn $name(self $(, $other: Self)*) -> Self {
            intrinsics!(Self($intrinsic(self.0 $(, $other.0)*)))
        }
    )*};
}

mod scalar;
#[cfg(test)]
mod tests;
#[cfg_attr(target_arch = "x86_64", path = "x86.rs")]
#[cfg_attr(
    all(target_arch = "aarch64", target_endian = "little"),
    path = "neon.rs"
)]
#[cfg_attr(
    all(target_arch = "wasm32", target_feature = "simd128"),
    path = "wasm.rs"
)]
mod vector;

use std::fmt::Debug;

use super::orders::turned_parts;

pub(super) use scalar::Scalar;
pub(super) use vector::Vector;

pub(super) trait Lanes<const N: usize>: Copy + Send + Sync + Debug {
    type Isa: Copy;
    type Lane: Copy;
    fn load(isa: Self::Isa, values: &[Self::Lane; N]) -> Self;
    fn splat(isa: Self::Isa, value: Self::Lane) -> Self;
}

pub(super) trait Floats<const N: usize>: Lanes<N> {
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    fn fma(self, by: Self, plus: Self) -> Self;
    fn fms(self, by: Self, less: Self) -> Self;
    fn fnma(self, by: Self, from: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn min(self, other: Self) -> Self;
    fn abs(self) -> Self;
    fn floor(self) -> Self;
    fn ceil(self) -> Self;
}

/// Four `f32`: three axes, and a fourth lane that most algorithms ignore.
pub(super) trait F32x4: Floats<4, Lane = f32> {
    /// With the sign turned where `signs` (0 or -0) has one.
    fn flip(self, signs: Self) -> Self;
    /// By axis, the value along the next axis (modulo 3).
    fn next(self) -> Self;
    /// By axis, the value along the axis after that.
    fn last(self) -> Self;
    /// Sign bits, the first lane's lowest.
    fn signs(self) -> u32;
    /// Whole parts of the first three lanes as indices below `N`; others become the last index.
    fn indices<const N: usize>(self) -> [usize; 3];
    fn values(self) -> [f32; 4];
    /// Sums of all lanes: of this vector, the other, and both again.
    fn sums(self, other: Self) -> Self;
    /// Whole numbers, of lanes that are whole and small.
    fn whole(self) -> [i32; 4];
}

pub(super) trait Tests<const N: usize>: Floats<N, Lane = f32> {
    fn at_most(self, other: Self) -> u8;
    /// The inverse, to 11 bits or more.
    fn reciprocal(self) -> Self;
    fn whole(self) -> [i32; N];
    /// As [`F32x4::indices`].
    fn indices<const M: usize>(self) -> [u32; N];
}

/// Sums and products wrap around.
pub(super) trait Shorts<const N: usize>: Lanes<N, Lane = i16> {
    fn add(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn abs(self) -> Self;
    /// The greater, of lanes taken as `u16`.
    fn max_unsigned(self, other: Self) -> Self;
    /// The lanes that are below a limit, one bit each: eight of this vector, eight of the next, and again.
    fn below(self, next: Self, limit: Self) -> u32;
}

pub(super) trait Masks<const N: usize>: Lanes<N, Lane = u64> {
    fn and(self, other: Self) -> Self;
    /// The lanes that are 0, one bit each.
    fn zeros(self) -> u32;
}

pub(super) trait Isa: Copy + Send + Sync + Debug + 'static {
    type F32x4: F32x4<Isa = Self>;
    type F32x8: Tests<8, Isa = Self>;
    type F64x4: Floats<4, Isa = Self, Lane = f64>;
    type I16x16: Shorts<16, Isa = Self>;
    type U64x4: Masks<4, Isa = Self>;

    fn detect() -> Option<Self>;

    /// Runs a step, an `#[inline(always)]` closure, in its own function, compiled for this set. Arguments are passed, not
    /// captured, so that the compiler knows that they do not alias.
    #[inline(never)]
    fn vectorize<T, A>(self, target: &mut T, argument: A, step: impl FnOnce(&mut T, A)) {
        step(target, argument);
    }

    #[inline(always)]
    fn four(self, values: &[f32; 4]) -> Self::F32x4 {
        Self::F32x4::load(self, values)
    }
    #[inline(always)]
    fn splat(self, value: f32) -> Self::F32x4 {
        Self::F32x4::splat(self, value)
    }
    fn narrow(self, wide: Self::F64x4) -> Self::F32x4;
    fn join(self, low: Self::F32x4, high: Self::F32x4) -> Self::F32x8;
    /// One of the first three lanes in all of eight.
    fn broadcast<const LANE: i32>(self, from: Self::F32x4) -> Self::F32x8;
    /// One of the first three lanes, rounded to 16 bits, in all of sixteen.
    fn broadcast_rounded<const LANE: i32>(self, from: Self::F32x4) -> Self::I16x16;
    /// Bytes, one after the other, at the places of a mask's bits, and bytes of ones there.
    fn expand(self, bytes: u64, mask: u8) -> [u64; 2] {
        let (mut expanded, mut ones, mut left) = (0, 0, bytes);
        for place in (0..8).filter(|place| mask >> place & 1 != 0) {
            ones |= 0xff << (8 * place);
            expanded |= (left & 0xff) << (8 * place);
            left >>= 8;
        }
        [expanded, ones]
    }
    /// [`turned_parts`].
    #[inline(always)]
    fn turned(self, parts: u64, octant: u8) -> u64 {
        turned_parts(parts, octant)
    }
    /// Copies values to 8 x 8 entries by mask, eight bits per row; rows of entries begin `width` apart, of values `step`.
    /// Panics unless all exist.
    #[inline(always)]
    fn store_masked(self, to: &mut [u32], width: usize, mask: u64, from: &[u32], step: usize) {
        let mut left = mask;
        while left != 0 {
            let bit = left.trailing_zeros() as usize;
            left &= left - 1;
            let (row, column) = (bit >> 3, bit & 7);
            to[row * width + column] = from[row * step + column];
        }
    }
}
