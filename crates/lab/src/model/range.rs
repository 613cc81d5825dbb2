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
    #[must_use]
    pub const fn new((value, low, high): (f64, f64, f64)) -> Self {
        Self { value, low, high }
    }

    /// The figure and its ends, times a number that is not negative.
    #[must_use]
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
    #[must_use]
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
    #[must_use]
    pub fn at_equal_prices(light: Range, ray_caster: Range) -> Self {
        if light.low < ray_caster.low && light.high < ray_caster.high {
            Self::Light
        } else if ray_caster.low < light.low && ray_caster.high < light.high {
            Self::RayCaster
        } else {
            Self::Neither
        }
    }

    #[must_use]
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
        let range = |low: f64, high: f64| Range::new((f64::midpoint(low, high), low, high));
        let (a, b) = (range(1.0, 2.0), range(3.0, 4.0));
        assert_eq!(Winner::by_ranges(a, b), Winner::Light);
        assert_eq!(Winner::by_ranges(b, a), Winner::RayCaster);
        let wide = range(1.5, 3.5);
        assert_eq!(Winner::by_ranges(a, wide), Winner::Neither);
        assert_eq!(Winner::at_equal_prices(a, wide), Winner::Light);
        assert_eq!(Winner::at_equal_prices(b, wide), Winner::RayCaster);
        // A range within another.
        assert_eq!(
            Winner::at_equal_prices(range(2.0, 3.0), wide),
            Winner::Neither
        );
        // Touching is overlapping.
        assert_eq!(Winner::by_ranges(a, range(2.0, 4.0)), Winner::Neither);
    }
}
