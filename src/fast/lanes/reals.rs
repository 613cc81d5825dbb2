//! Eight `f64` at once: what a change to screen space and the windows of
//! clip-space boxes are computed with. The operators and steps here are one
//! or two instructions where the processor has vectors.

use std::ops::{Add, Mul, Sub};

/// Eight `f64`, lane by lane.
pub(in crate::fast) trait Reals:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// `self / by`.
    fn over(self, by: Self) -> Self;

    /// `self * by + plus`, rounded once.
    fn fused(self, by: Self, plus: Self) -> Self;

    /// Rounded down.
    fn floor(self) -> Self;

    /// Rounded towards zero.
    fn trunc(self) -> Self;

    /// Without sign.
    fn abs(self) -> Self;

    /// The lesser of two; neither is NaN.
    fn least(self, other: Self) -> Self;

    /// The greater of two; neither is NaN.
    fn greatest(self, other: Self) -> Self;

    /// 1 where this is not below the other, else 0.
    fn is_at_least(self, other: Self) -> Self;

    /// Whether any lane is below zero.
    fn any_negative(self) -> bool;

    /// `2^bits` over the greatest power of two that is not above this;
    /// this is 1 or more.
    fn scale_to(self, bits: u32) -> Self;

    /// Of numbers of eight vertices in Morton order: the sum; and by axis the
    /// sum of the differences along its four edges, in the first three lanes,
    /// beside zeros. Whole numbers below 2^50.
    fn sums(self) -> (f64, Self);

    /// The first four lanes.
    fn first(self) -> [f64; 4];
}

/// The exponent field of an `f64`.
pub(super) const EXPONENT: u64 = 0x7ff << 52;

/// What an exponent field is taken from for [`Reals::scale_to`].
#[inline(always)]
pub(super) fn scale_base(bits: u32) -> u64 {
    (2 * 1023 + u64::from(bits)) << 52
}

/// The scalar twin.
#[derive(Debug, Clone, Copy)]
pub(in crate::fast) struct ScalarReals(pub(super) [f64; 8]);

impl ScalarReals {
    #[inline(always)]
    fn with(mut self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        for i in 0..8 {
            self.0[i] = f(self.0[i], other.0[i]);
        }
        self
    }
}

impl Add for ScalarReals {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }
}

impl Sub for ScalarReals {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }
}

impl Mul for ScalarReals {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.with(other, |a, b| a * b)
    }
}

impl Reals for ScalarReals {
    fn over(self, by: Self) -> Self {
        self.with(by, |a, b| a / b)
    }

    fn fused(self, by: Self, plus: Self) -> Self {
        let mut result = plus;
        for i in 0..8 {
            result.0[i] = self.0[i].mul_add(by.0[i], plus.0[i]);
        }
        result
    }

    fn floor(self) -> Self {
        Self(self.0.map(f64::floor))
    }

    fn trunc(self) -> Self {
        Self(self.0.map(f64::trunc))
    }

    fn abs(self) -> Self {
        Self(self.0.map(f64::abs))
    }

    fn least(self, other: Self) -> Self {
        self.with(other, |a, b| if a < b { a } else { b })
    }

    fn greatest(self, other: Self) -> Self {
        self.with(other, |a, b| if a > b { a } else { b })
    }

    fn is_at_least(self, other: Self) -> Self {
        self.with(other, |a, b| if a >= b { 1.0 } else { 0.0 })
    }

    fn any_negative(self) -> bool {
        self.0.iter().any(|&v| v < 0.0)
    }

    fn scale_to(self, bits: u32) -> Self {
        let scale = |v: f64| f64::from_bits(scale_base(bits) - (v.to_bits() & EXPONENT));
        Self(self.0.map(scale))
    }

    fn sums(self) -> (f64, Self) {
        let mut total = 0.0;
        let mut edges = [0.0; 8];
        for (i, value) in self.0.into_iter().enumerate() {
            total += value;
            for axis in 0..3 {
                let is_upper = i >> (2 - axis) & 1 != 0;
                edges[axis] += if is_upper { value } else { -value };
            }
        }
        (total, Self(edges))
    }

    fn first(self) -> [f64; 4] {
        let [a, b, c, d, ..] = self.0;
        [a, b, c, d]
    }
}
