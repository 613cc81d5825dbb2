//! Numbers whose every step the host is told of.

use std::cmp::Ordering;
use std::ops::{Add, AddAssign, BitAnd, Div, Mul, Neg, Shl, Shr, Sub};

use super::{Host, Kind, Step};

/// What a number can be.
pub(crate) trait Number:
    Copy + PartialOrd + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// What it counts as.
    const KIND: Kind;

    /// The larger of both.
    fn larger(self, other: Self) -> Self;
}

impl Number for f64 {
    const KIND: Kind = Kind::Float;

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        self.max(other)
    }
}

macro_rules! integer {
    ($type:ty, $kind:expr) => {
        impl Number for $type {
            const KIND: Kind = $kind;

            #[inline(always)]
            fn larger(self, other: Self) -> Self {
                Ord::max(self, other)
            }
        }
    };
}

integer!(u64, Kind::Integer);
integer!(i64, Kind::Integer);
integer!(i128, Kind::LongInteger);

/// A number, and who is told of what is done to it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Num<H, T> {
    pub(crate) value: T,
    pub(crate) by: H,
}

/// A real number.
pub(crate) type Real<H> = Num<H, f64>;
/// An integer in which products of two of 64 bits have room.
pub(crate) type Whole<H> = Num<H, i128>;

impl<H: Host, T: Number> Num<H, T> {
    /// Tells of a step, and is its result.
    #[inline(always)]
    fn told<U: Number>(self, step: Step, value: U) -> Num<H, U> {
        self.by.tell(step, U::KIND);
        Num { value, by: self.by }
    }

    /// Tells of a comparison.
    #[inline(always)]
    fn compared<R>(self, result: R) -> R {
        self.by.tell(Step::Compare, T::KIND);
        result
    }

    /// The larger of both.
    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        self.told(Step::MinMax, self.value.larger(other.value))
    }
}

/// An operator between two numbers, or a number and a constant.
macro_rules! operator {
    ($trait:ident, $method:ident, $step:expr) => {
        impl<H: Host, T: Number + $trait<Output = T>> $trait for Num<H, T> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.told($step, self.value.$method(other.value))
            }
        }

        impl<H: Host, T: Number + $trait<Output = T>> $trait<T> for Num<H, T> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: T) -> Self {
                self.told($step, self.value.$method(other))
            }
        }
    };
}

operator!(Add, add, Step::Add);
operator!(Sub, sub, Step::Add);
operator!(Mul, mul, Step::Multiply);

impl<H: Host> Div for Real<H> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.told(Step::Divide, self.value / other.value)
    }
}

impl<H: Host> Div<f64> for Real<H> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: f64) -> Self {
        self.told(Step::Divide, self.value / other)
    }
}

impl<H: Host, T: Number> AddAssign for Num<H, T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<H: Host, T: Number + Neg<Output = T>> Neg for Num<H, T> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.told(Step::Sign, -self.value)
    }
}

impl<H: Host, T: Number + Shl<u32, Output = T>> Shl<u32> for Num<H, T> {
    type Output = Self;

    #[inline(always)]
    fn shl(self, places: u32) -> Self {
        self.told(Step::Shift, self.value << places)
    }
}

impl<H: Host, T: Number + Shr<u32, Output = T>> Shr<u32> for Num<H, T> {
    type Output = Self;

    #[inline(always)]
    fn shr(self, places: u32) -> Self {
        self.told(Step::Shift, self.value >> places)
    }
}

impl<H: Host, T: Number + BitAnd<Output = T>> BitAnd<T> for Num<H, T> {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: T) -> Self {
        self.told(Step::Logic, self.value & other)
    }
}

impl<H: Host, T: Number> PartialEq for Num<H, T> {
    #[inline(always)]
    fn eq(&self, other: &Self) -> bool {
        self.compared(self.value == other.value)
    }
}

impl<H: Host, T: Number> PartialEq<T> for Num<H, T> {
    #[inline(always)]
    fn eq(&self, other: &T) -> bool {
        self.compared(self.value == *other)
    }
}

impl<H: Host, T: Number> PartialOrd for Num<H, T> {
    #[inline(always)]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.compared(self.value.partial_cmp(&other.value))
    }
}

impl<H: Host, T: Number> PartialOrd<T> for Num<H, T> {
    #[inline(always)]
    fn partial_cmp(&self, other: &T) -> Option<Ordering> {
        self.compared(self.value.partial_cmp(other))
    }
}

impl<H: Host> Real<H> {
    /// Square root.
    pub(crate) fn sqrt(self) -> Self {
        self.told(Step::SquareRoot, libm::sqrt(self.value))
    }

    /// Logarithm to base 2.
    pub(crate) fn log2(self) -> Self {
        self.told(Step::Logarithm, libm::log2(self.value))
    }

    /// Tangent.
    pub(crate) fn tan(self) -> Self {
        self.told(Step::Tangent, libm::tan(self.value))
    }

    /// Without its sign.
    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        self.told(Step::Sign, self.value.abs())
    }

    /// Rounded down.
    pub(crate) fn floor(self) -> Self {
        self.told(Step::Round, libm::floor(self.value))
    }

    /// Rounded up.
    pub(crate) fn ceil(self) -> Self {
        self.told(Step::Round, libm::ceil(self.value))
    }

    /// The nearest integer; halves away from zero.
    pub(crate) fn round(self) -> Self {
        self.told(Step::Round, libm::round(self.value))
    }

    /// Times `2^exponent`.
    pub(crate) fn scaled(self, exponent: i32) -> Self {
        self.told(Step::Scale, libm::ldexp(self.value, exponent))
    }

    /// Neither infinite nor not a number.
    pub(crate) fn is_finite(self) -> bool {
        self.compared(self.value.is_finite())
    }

    /// Infinite, of either sign.
    pub(crate) fn is_infinite(self) -> bool {
        self.compared(self.value.is_infinite())
    }

    /// Not a number.
    pub(crate) fn is_nan(self) -> bool {
        self.compared(self.value.is_nan())
    }

    /// The integer that it is; cut to the nearest where it has no room.
    pub(crate) fn to_i64(self) -> Num<H, i64> {
        self.told(Step::Convert, self.value as i64)
    }
}

impl<H: Host> Num<H, u64> {
    /// As a float, rounded to the nearest.
    pub(crate) fn to_real(self) -> Real<H> {
        self.told(Step::Convert, self.value as f64)
    }

    /// Bits without the zeros in front.
    pub(crate) fn significant_bits(self) -> u32 {
        self.by.tell(Step::Logic, Kind::Integer);
        u64::BITS - self.value.leading_zeros()
    }
}

impl<H: Host> Num<H, i64> {
    /// As a float, rounded to the nearest.
    pub(crate) fn to_real(self) -> Real<H> {
        self.told(Step::Convert, self.value as f64)
    }

    /// With more bits.
    pub(crate) fn widened(self) -> Whole<H> {
        self.told(Step::Convert, i128::from(self.value))
    }

    /// Without its sign.
    pub(crate) fn unsigned_abs(self) -> Num<H, u64> {
        self.told(Step::Sign, self.value.unsigned_abs())
    }

    /// The nearest from `low` to `high`.
    pub(crate) fn clamped(self, low: i64, high: i64) -> Self {
        let raised = self.told(Step::MinMax, self.value.max(low));
        raised.told(Step::MinMax, raised.value.min(high))
    }
}

impl<H: Host> Whole<H> {
    /// Without its sign.
    pub(crate) fn abs(self) -> Self {
        self.told(Step::Sign, self.value.abs())
    }

    /// -1, 0 or 1.
    pub(crate) fn signum(self) -> Self {
        self.told(Step::Sign, self.value.signum())
    }

    /// The product, if it fits.
    pub(crate) fn checked_mul(self, other: Self) -> Option<Self> {
        let product = self.value.checked_mul(other.value);
        self.by.tell(Step::Multiply, Kind::LongInteger);
        product.map(|value| Num { value, by: self.by })
    }

    /// The sum, if it fits.
    pub(crate) fn checked_add(self, other: Self) -> Option<Self> {
        let sum = self.value.checked_add(other.value);
        self.by.tell(Step::Add, Kind::LongInteger);
        sum.map(|value| Num { value, by: self.by })
    }

    /// The quotient by a positive number, rounded down.
    pub(crate) fn div_floor(self, by: Self) -> Self {
        self.told(Step::Divide, self.value.div_euclid(by.value))
    }

    /// The remainder of that.
    pub(crate) fn rem_floor(self, by: Self) -> Self {
        self.told(Step::Divide, self.value.rem_euclid(by.value))
    }

    /// With 64 bits, if it fits.
    pub(crate) fn narrowed(self) -> Option<Num<H, i64>> {
        self.by.tell(Step::Convert, Kind::Integer);
        let value = i64::try_from(self.value).ok()?;
        Some(Num { value, by: self.by })
    }

    /// With 64 bits; beyond them the nearest.
    pub(crate) fn clamped_to_i64(self) -> Num<H, i64> {
        let most = if self.value < 0 { i64::MIN } else { i64::MAX };
        self.told(Step::Convert, i64::try_from(self.value).unwrap_or(most))
    }
}
