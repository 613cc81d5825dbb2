//! Structural similarity (Wang, Bovik, Sheikh, Simoncelli 2004).
//!
//! The mean over all Gaussian windows of 11 x 11 pixels inside the picture, with a standard deviation
//! of 1.5, `K1 = 0.01`, `K2 = 0.03` and range 255. A picture with a side below 11 pixels is one
//! window with equal weights.

use super::flip::filtered;

const RADIUS: usize = 5;
const WINDOW: usize = 2 * RADIUS + 1;
const SIGMA: f64 = 1.5;
const C1: f64 = (0.01 * 255.0) * (0.01 * 255.0);
const C2: f64 = (0.03 * 255.0) * (0.03 * 255.0);

/// Mean structural similarity of two luma planes, values 0..=255; 1 for empty ones.
pub(super) fn ssim(width: usize, height: usize, a: &[f64], b: &[f64]) -> f64 {
    if a.is_empty() {
        return 1.0;
    }
    let product = |p: &[f64], q: &[f64]| p.iter().zip(q).map(|(x, y)| x * y).collect::<Vec<_>>();
    let mean = |plane: &[f64]| match width < WINDOW || height < WINDOW {
        true => vec![plane.iter().sum::<f64>() / plane.len() as f64],
        false => windows(width, height, plane),
    };
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (square_a, square_b) = (mean(&product(a, a)), mean(&product(b, b)));
    let both = mean(&product(a, b));
    let window = |i: usize| {
        let (ma, mb) = (mean_a[i], mean_b[i]);
        let variances = square_a[i] - ma * ma + (square_b[i] - mb * mb);
        let covariance = both[i] - ma * mb;
        (2.0 * ma * mb + C1) * (2.0 * covariance + C2)
            / ((ma * ma + mb * mb + C1) * (variances + C2))
    };
    (0..mean_a.len()).map(window).sum::<f64>() / mean_a.len() as f64
}

fn windows(width: usize, height: usize, plane: &[f64]) -> Vec<f64> {
    let bell: [f64; WINDOW] = std::array::from_fn(|k| {
        let away = k as f64 - RADIUS as f64;
        libm::exp(-away * away / (2.0 * SIGMA * SIGMA))
    });
    let sum: f64 = bell.iter().sum();
    let weights = bell.map(|weight| weight / sum);
    let all = filtered((width, height), plane, &weights, &weights);
    let rows = all.chunks_exact(width).take(height - RADIUS).skip(RADIUS);
    rows.flat_map(|row| &row[RADIUS..width - RADIUS])
        .copied()
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_worked_out_by_hand() {
        let plain = |value: f64| move |_| value;
        let striped = |i: usize| (i % 2 * 255) as f64;
        // No variance: the luminance term alone.
        let expected = (2.0 * 50.0 * 100.0 + C1) / (50.0 * 50.0 + 100.0 * 100.0 + C1);
        let of = |side: usize, a: &dyn Fn(usize) -> f64, b: &dyn Fn(usize) -> f64| {
            let [a, b] = [a, b].map(|plane| (0..side * side).map(plane).collect::<Vec<_>>());
            ssim(side, side, &a, &b)
        };
        for side in [4, 20] {
            let found = of(side, &plain(50.0), &plain(100.0));
            assert!((found - expected).abs() < 1e-9, "{side}: {found}");
        }
        assert!(of(20, &striped, &|i| 255.0 - striped(i)) < -0.9);
        assert!((of(20, &striped, &striped) - 1.0).abs() < 1e-12);
    }
}
