//! The integers of line functions: planes of at most 127 bits times ray directions of at most 2^18. Only the most
//! extreme views need [`Wide`].

use std::ops::{Add, Sub};

pub(super) trait Number:
    Copy + Send + Sync + Add<Output = Self> + Sub<Output = Self>
{
    /// `plane . ray`; `ray` has components in `0..=2^18`.
    fn dot(plane: [i128; 3], ray: [i64; 3]) -> Self;
    /// Times `2^levels`, `levels` at most 30.
    fn times_power(self, levels: u32) -> Self;
    fn sign(self) -> i32;
}

impl Number for i128 {
    #[inline]
    fn dot(plane: [i128; 3], ray: [i64; 3]) -> Self {
        (0..3).map(|c| plane[c] * Self::from(ray[c])).sum()
    }

    #[inline]
    fn times_power(self, levels: u32) -> Self {
        self << levels
    }

    #[inline]
    fn sign(self) -> i32 {
        self.signum() as i32
    }
}

/// `high * 2^64 + low`: 192 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Wide {
    high: i128,
    low: u64,
}

impl Add for Wide {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (low, carry) = self.low.overflowing_add(other.low);
        Self {
            high: self.high + other.high + i128::from(carry),
            low,
        }
    }
}

impl Sub for Wide {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        let (low, borrow) = self.low.overflowing_sub(other.low);
        Self {
            high: self.high - other.high - i128::from(borrow),
            low,
        }
    }
}

impl Number for Wide {
    fn dot(plane: [i128; 3], ray: [i64; 3]) -> Self {
        let mut high = 0i128;
        let mut low = 0i128;
        for c in 0..3 {
            // Also below zero, a number is `(number >> 64) * 2^64` plus its lowest 64 bits.
            high += (plane[c] >> 64) * i128::from(ray[c]);
            low += i128::from(plane[c] as u64) * i128::from(ray[c]);
        }
        Self {
            high: high + (low >> 64),
            low: low as u64,
        }
    }

    fn times_power(self, levels: u32) -> Self {
        if levels == 0 {
            return self;
        }
        Self {
            high: self.high << levels | i128::from(self.low >> (64 - levels)),
            low: self.low << levels,
        }
    }

    fn sign(self) -> i32 {
        if self.high == 0 && self.low == 0 {
            0
        } else if self.high < 0 {
            -1
        } else {
            1
        }
    }
}

#[cfg(test)]
mod tests {
    use num_bigint::BigInt;

    use super::*;

    #[test]
    fn wide_is_exact_where_128_bits_overflow() {
        let big = |wide: Wide| (BigInt::from(wide.high) << 64) + BigInt::from(wide.low);
        let planes = [
            [i128::MAX, i128::MIN + 1, -1],
            [-(1 << 100) + 7, 1 << 125, i128::MIN],
            [0, 0, 0],
            [-(1 << 64), 1 << 64, (1 << 64) - 1],
        ];
        let rays = [[1, 3, 1 << 18], [262_143, 1, 65_536], [5, 5, 8]];
        for (plane, ray) in planes.into_iter().flat_map(|of| rays.map(|ray| (of, ray))) {
            let wide = Wide::dot(plane, ray);
            let exact: BigInt = (0..3).map(|c| BigInt::from(plane[c]) * ray[c]).sum();
            assert_eq!(wide.sign().cmp(&0), exact.cmp(&BigInt::ZERO));
            assert_eq!(big(wide), exact);
            for other in planes.map(|plane| Wide::dot(plane, [1, 2, 3])) {
                assert_eq!(big(wide + other), big(wide) + big(other));
                assert_eq!(big(wide - other), big(wide) - big(other));
            }
            let small = Wide::dot(plane.map(|c| c >> 40), ray);
            for levels in [0, 1, 13, 29] {
                assert_eq!(big(small.times_power(levels)), big(small) << levels);
            }
        }
    }
}
