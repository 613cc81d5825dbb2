//! Statistics of a few times of the same work.

use serde::Serialize;

/// Order statistics of some times. With times that other work on the machine
/// can only lengthen, `min` and `median` are better estimates than a mean.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Summary {
    pub runs: usize,
    /// Least, milliseconds.
    pub min_ms: f64,
    /// Middle, milliseconds; of an even number the mean of two.
    pub median_ms: f64,
    /// Greatest, milliseconds.
    pub max_ms: f64,
    /// Median of the absolute deviations from the median, milliseconds.
    pub deviation_ms: f64,
}

impl Summary {
    pub fn of(times_ms: &[f64]) -> Self {
        let mut sorted = times_ms.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (Some(&min_ms), Some(&max_ms)) = (sorted.first(), sorted.last()) else {
            return Self::default();
        };
        let median_ms = middle(&sorted);
        let mut deviations: Vec<f64> = sorted.iter().map(|t| (t - median_ms).abs()).collect();
        deviations.sort_by(f64::total_cmp);
        Self {
            runs: sorted.len(),
            min_ms,
            median_ms,
            max_ms,
            deviation_ms: middle(&deviations),
        }
    }
}

fn middle(sorted: &[f64]) -> f64 {
    let half = sorted.len() / 2;
    match sorted {
        [] => 0.0,
        _ if sorted.len() % 2 == 1 => sorted[half],
        _ => (sorted[half - 1] + sorted[half]) / 2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_statistics() {
        for (times, expected) in [
            // Deviations 3, 1, 0.
            (&[5.0, 1.0, 2.0][..], [1.0, 2.0, 5.0, 1.0]),
            // Deviations 6.5, 1.5, 0.5, 0.5.
            (&[10.0, 2.0, 4.0, 3.0], [2.0, 3.5, 10.0, 1.0]),
            (&[7.0], [7.0, 7.0, 7.0, 0.0]),
            (&[], [0.0; 4]),
        ] {
            let of = Summary::of(times);
            assert_eq!(
                [of.min_ms, of.median_ms, of.max_ms, of.deviation_ms],
                expected
            );
        }
    }
}
