//! Figures with a low and a high end, and when one is less than another.

use hwmodel::cost::Breakdown;
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Range {
    /// The figure: the middle of its parts' ranges.
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

impl Range {
    pub const fn new((value, low, high): (f64, f64, f64)) -> Self {
        Self { value, low, high }
    }

    /// The figure and its ends, times a number that is not negative.
    pub fn times(self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            low: self.low * factor,
            high: self.high * factor,
        }
    }
}

impl From<&Breakdown> for Range {
    fn from(sum: &Breakdown) -> Self {
        Self::new((sum.total, sum.low, sum.high))
    }
}

impl std::ops::Add for Range {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            low: self.low + other.low,
            high: self.high + other.high,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Winner {
    Light,
    RayCaster,
    /// Neither: the ranges overlap.
    Neither,
}

impl Winner {
    /// The one whose high end is below the other's low end.
    pub fn by_ranges(light: Range, ray_caster: Range) -> Self {
        if light.high < ray_caster.low {
            Self::Light
        } else if ray_caster.high < light.low {
            Self::RayCaster
        } else {
            Self::Neither
        }
    }

    /// The one that needs less at the low end of all prices and at their high end. Both pay the same for a word of
    /// outer memory then.
    pub fn at_equal_prices(light: Range, ray_caster: Range) -> Self {
        if light.low < ray_caster.low && light.high < ray_caster.high {
            Self::Light
        } else if ray_caster.low < light.low && ray_caster.high < light.high {
            Self::RayCaster
        } else {
            Self::Neither
        }
    }

    pub const fn name(self) -> &'static str {
        match self {
            Self::Light => "light hardware",
            Self::RayCaster => "ray caster",
            Self::Neither => "neither",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_that_overlap_have_no_winner() {
        use Winner::{Light, Neither, RayCaster};
        let range = |(low, high)| Range::new((f64::midpoint(low, high), low, high));
        for (a, b, by_ranges, at_equal_prices) in [
            ((1.0, 2.0), (3.0, 4.0), Light, Light),
            ((3.0, 4.0), (1.0, 2.0), RayCaster, RayCaster),
            ((1.0, 2.0), (1.5, 3.5), Neither, Light),
            ((3.0, 4.0), (1.5, 3.5), Neither, RayCaster),
            // A range within another.
            ((2.0, 3.0), (1.5, 3.5), Neither, Neither),
            // Touching is overlapping.
            ((1.0, 2.0), (2.0, 4.0), Neither, Light),
        ] {
            let (a, b) = (range(a), range(b));
            let found = (Winner::by_ranges(a, b), Winner::at_equal_prices(a, b));
            assert_eq!(found, (by_ranges, at_equal_prices), "{a:?}, {b:?}");
        }
    }
}
