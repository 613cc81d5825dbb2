//! Mean, worst, and what all but a thousandth stay below.

use serde::Serialize;

/// Statistics of errors, in the errors' units.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Spread {
    /// How many errors there are.
    pub count: u64,
    /// Their mean; 0 for none.
    pub mean: f64,
    /// Their 99.9th percentile (nearest rank).
    pub percentile_99_9: f64,
    /// The greatest.
    pub worst: f64,
}

impl Spread {
    /// Statistics of errors, none of them below 0.
    #[must_use]
    pub fn of(mut errors: Vec<f64>) -> Self {
        errors.sort_unstable_by(f64::total_cmp);
        let Some(&worst) = errors.last() else {
            return Self::default();
        };
        let rank = (errors.len() * 999).div_ceil(1000);
        Self {
            count: errors.len() as u64,
            mean: errors.iter().sum::<f64>() / errors.len() as f64,
            percentile_99_9: errors[rank - 1],
            worst,
        }
    }

    /// How far two depth buffers are apart, in voxels of side `voxel`, over the
    /// pixels at which both see something (elsewhere depth is infinite).
    #[must_use]
    pub fn of_depths(test: &[f32], reference: &[f32], voxel: f64) -> Self {
        let both = test.iter().zip(reference);
        let seen = both.filter(|(t, r)| t.is_finite() && r.is_finite());
        Self::of(
            seen.map(|(t, r)| (f64::from(*t) - f64::from(*r)).abs() / voxel)
                .collect(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks() {
        let spread = Spread::of((1..=2000).rev().map(f64::from).collect());
        assert_eq!((spread.count, spread.worst), (2000, 2000.0));
        assert_eq!((spread.mean, spread.percentile_99_9), (1000.5, 1998.0));
        let one = Spread::of(vec![3.0]);
        assert_eq!((one.mean, one.percentile_99_9, one.worst), (3.0, 3.0, 3.0));
        assert_eq!(Spread::of(Vec::new()), Spread::default());
    }

    #[test]
    fn depths_where_both_see_something() {
        const NONE: f32 = f32::INFINITY;
        let test = [10.0, NONE, 12.0, 5.0, NONE];
        let reference = [10.0, 3.0, 11.0, NONE, NONE];
        let spread = Spread::of_depths(&test, &reference, 0.5);
        assert_eq!((spread.count, spread.worst, spread.mean), (2, 2.0, 1.0));
        assert_eq!(Spread::of_depths(&reference, &test, 0.5), spread);
        assert_eq!(Spread::of_depths(&test, &test, 1.0).worst, 0.0);
    }
}
