//! How work grows: power laws fitted to points.

use serde::Serialize;

/// `y = factor * x^exponent`, fitted by least squares to the logarithms.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PowerLaw {
    /// Growth: 1 is in proportion, 0 is not at all.
    pub exponent: f64,
    /// Value at `x = 1`.
    pub factor: f64,
    /// Points that it is fitted to.
    pub points: usize,
    /// Share of the logarithms' variance that the law explains; `None` for
    /// two points, which every law fits, and for values that do not vary.
    pub r_squared: Option<f64>,
    /// Greatest factor, 1 or more, by which a point and the law differ.
    pub worst_ratio: f64,
}

impl PowerLaw {
    /// The law of points `(x, y)`, of which those not above 0 are left out.
    /// `None` unless there are two different `x`.
    #[must_use]
    pub fn fit(points: &[(f64, f64)]) -> Option<Self> {
        let logs: Vec<(f64, f64)> = points
            .iter()
            .filter(|(x, y)| *x > 0.0 && *y > 0.0 && x.is_finite() && y.is_finite())
            .map(|&(x, y)| (libm::log(x), libm::log(y)))
            .collect();
        let count = logs.len() as f64;
        let mean_x = logs.iter().map(|p| p.0).sum::<f64>() / count;
        let mean_y = logs.iter().map(|p| p.1).sum::<f64>() / count;
        let sum = |term: &dyn Fn(f64, f64) -> f64| -> f64 {
            logs.iter()
                .map(|&(x, y)| term(x - mean_x, y - mean_y))
                .sum()
        };
        let (xx, xy, yy) = (sum(&|x, _| x * x), sum(&|x, y| x * y), sum(&|_, y| y * y));
        // Also where there is no point at all: the means are then not numbers.
        if xx.is_nan() || xx <= 0.0 {
            return None;
        }
        let exponent = xy / xx;
        let residuals = sum(&|x, y| (y - exponent * x) * (y - exponent * x));
        let worst = logs
            .iter()
            .map(|&(x, y)| (y - mean_y - exponent * (x - mean_x)).abs())
            .fold(0.0, f64::max);
        Some(Self {
            exponent,
            factor: libm::exp(mean_y - exponent * mean_x),
            points: logs.len(),
            r_squared: (logs.len() > 2 && yy > 0.0).then(|| 1.0 - residuals / yy),
            worst_ratio: libm::exp(worst),
        })
    }

    /// The law's value at `x`.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        self.factor * libm::pow(x, self.exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() <= 1e-9 * b.abs().max(1.0), "{a} and {b}");
    }

    #[test]
    fn a_power_law_is_found_again() {
        let points: Vec<(f64, f64)> = (6..=12)
            .map(|k| f64::from(1u32 << k))
            .map(|x| (x, 0.25 * libm::pow(x, 1.7)))
            .collect();
        let law = PowerLaw::fit(&points).unwrap();
        close(law.exponent, 1.7);
        close(law.factor, 0.25);
        close(law.r_squared.unwrap(), 1.0);
        close(law.worst_ratio, 1.0);
        close(law.at(100.0), 0.25 * libm::pow(100.0, 1.7));
        assert_eq!(law.points, 7);
    }

    #[test]
    fn residuals_worked_out_by_hand() {
        // Logarithms to base 2: (0, 0), (1, 3), (2, 0). The slope is 0, the mean 1, and residuals are
        // -1, 2, -1.
        let law = PowerLaw::fit(&[(1.0, 1.0), (2.0, 8.0), (4.0, 1.0)]).unwrap();
        let found = [
            law.exponent,
            law.factor,
            law.r_squared.unwrap(),
            law.worst_ratio,
        ];
        found
            .iter()
            .zip([0.0, 2.0, 0.0, 4.0])
            .for_each(|(is, was)| close(*is, was));
        // (0, 0), (1, 1), (2, 4): slope 2, residuals 1/3, -2/3, 1/3. Of 26/3, 6/9 are unexplained.
        let law = PowerLaw::fit(&[(1.0, 1.0), (2.0, 2.0), (4.0, 16.0)]).unwrap();
        close(law.exponent, 2.0);
        close(law.r_squared.unwrap(), 1.0 - 6.0 / 9.0 / (26.0 / 3.0));
        close(law.worst_ratio, libm::pow(2.0, 2.0 / 3.0));
    }

    #[test]
    fn too_few_points_have_no_law() {
        let few: [&[(f64, f64)]; 4] = [
            &[],
            &[(2.0, 3.0)],
            &[(2.0, 3.0), (2.0, 4.0)],
            &[(2.0, 3.0), (4.0, 0.0)],
        ];
        assert!(few.iter().all(|points| PowerLaw::fit(points).is_none()));
        let two = PowerLaw::fit(&[(1.0, 3.0), (4.0, 12.0)]).unwrap();
        close(two.exponent, 1.0);
        assert_eq!(two.r_squared, None);
    }
}
