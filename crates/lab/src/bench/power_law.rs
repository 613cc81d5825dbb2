//! How work grows: power laws fitted to points.

/// `y = c * x^exponent`, fitted by least squares to the logarithms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PowerLaw {
    pub(crate) exponent: f64,
    /// Share of the logarithms' variance that the law explains; `None` for two points, which every
    /// law fits, and for values that do not vary.
    pub(super) r_squared: Option<f64>,
}

impl PowerLaw {
    /// The law of points `(x, y)`, of which those not above 0 are left out.
    /// `None` unless there are two different `x`.
    pub(crate) fn fit(points: impl IntoIterator<Item = (f64, f64)>) -> Option<Self> {
        let logs: Vec<(f64, f64)> = points
            .into_iter()
            .filter(|(x, y)| *x > 0.0 && *y > 0.0 && x.is_finite() && y.is_finite())
            .map(|(x, y)| (libm::log(x), libm::log(y)))
            .collect();
        let count = logs.len() as f64;
        let mean_x = logs.iter().map(|p| p.0).sum::<f64>() / count;
        let mean_y = logs.iter().map(|p| p.1).sum::<f64>() / count;
        let sum = |term: &dyn Fn(f64, f64) -> f64| -> f64 {
            let terms = logs.iter().map(|&(x, y)| term(x - mean_x, y - mean_y));
            terms.sum()
        };
        let (xx, xy, yy) = (sum(&|x, _| x * x), sum(&|x, y| x * y), sum(&|_, y| y * y));
        // Also where there is no point at all: the means are then not numbers.
        if xx.is_nan() || xx <= 0.0 {
            return None;
        }
        let exponent = xy / xx;
        let residuals = sum(&|x, y| (y - exponent * x) * (y - exponent * x));
        Some(Self {
            exponent,
            r_squared: (logs.len() > 2 && yy > 0.0).then(|| 1.0 - residuals / yy),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn laws_worked_out_by_hand() {
        let power = |x: f64| (x, 0.25 * libm::pow(x, 1.7));
        let exact = [64.0, 128.0, 1024.0].map(power);
        // Rounded to nine digits.
        let round = |value: f64| libm::round(value * 1e9) / 1e9;
        let explained = Some(round(12.0 / 13.0));
        for (points, expected) in [
            (&exact[..], Some((1.7, Some(1.0)))),
            // Logarithms to base 2: (0, 0), (1, 3), (2, 0), with residuals -1, 2, -1.
            (&[(1., 1.), (2., 8.), (4., 1.)], Some((0.0, Some(0.0)))),
            // (0, 0), (1, 1), (2, 4): residuals 1/3, -2/3, 1/3. Of 26/3, 6/9 are unexplained.
            (&[(1., 1.), (2., 2.), (4., 16.)], Some((2.0, explained))),
            (&[(1., 3.), (4., 12.)], Some((1.0, None))),
            (&[(1., 3.), (4., 3.), (5., 3.)], Some((0.0, None))),
            (&[(2., 3.)], None),
            (&[(2., 3.), (2., 4.)], None),
            (&[(2., 3.), (4., 0.)], None),
        ] {
            let law = PowerLaw::fit(points.iter().copied());
            let law = law.map(|law| (round(law.exponent), law.r_squared.map(round)));
            assert_eq!(law, expected, "{points:?}");
        }
    }
}
