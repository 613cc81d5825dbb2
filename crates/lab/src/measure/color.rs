//! Colour error between two pictures.

use shiftvox::picture::Linear;

/// Colours of a picture as the metrics take them: size and sRGB with alpha.
pub type Colors<'p> = (u32, u32, &'p [[u8; 4]]);

/// Two pictures of different sizes, which cannot be compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the pictures differ in size: {}x{} and {}x{}", .0.0, .0.1, .1.0, .1.1)]
pub struct SizeError(pub (u32, u32), pub (u32, u32));

/// How far the colours of two pictures are apart.
///
/// `differing` and `max_abs` compare all four stored channels. The others compare the colours on a
/// black background: red, green and blue, each times alpha.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColorError {
    pub pixels: u64,
    pub differing: u64,
    /// Largest difference of a channel, 0..=255.
    pub max_abs: u8,
    /// Mean difference of a channel in sRGB bytes, 0..=255.
    pub mean_abs: f64,
    /// Mean squared difference of a channel, sRGB values from 0 to 1.
    pub mse_srgb: f64,
    /// `-10 log10(mse_srgb)`, decibel; infinite for equal pictures.
    pub psnr_srgb: f64,
    /// Mean squared difference of a channel, linear light from 0 to 1.
    pub mse_linear: f64,
    /// `-10 log10(mse_linear)`, decibel; infinite for equal pictures.
    pub psnr_linear: f64,
}

impl ColorError {
    /// Compares two pictures of the same size.
    pub fn between(a: Colors<'_>, b: Colors<'_>) -> Result<Self, SizeError> {
        check_sizes(a, b)?;
        let linear = Linear::tables();
        let (mut differing, mut max_abs) = (0u64, 0u8);
        let (mut sum_abs, mut sum_srgb) = (0u64, 0u64);
        let mut sum_linear = 0.0f64;
        for (&p, &q) in a.2.iter().zip(b.2) {
            if p == q {
                continue;
            }
            differing += 1;
            for (x, y) in p.iter().zip(q) {
                max_abs = max_abs.max(x.abs_diff(y));
            }
            let (p, q) = (on_black(p), on_black(q));
            for (x, y) in p.iter().zip(q) {
                let apart = u64::from(x.abs_diff(y));
                sum_abs += apart;
                sum_srgb += apart * apart;
            }
            for (x, y) in linear.decode(p).iter().zip(linear.decode(q)) {
                let apart = f64::from(x.abs_diff(y)) / 65535.0;
                sum_linear += apart * apart;
            }
        }
        let pixels = a.2.len() as u64;
        let channels = 3.0 * pixels.max(1) as f64;
        let mse_srgb = sum_srgb as f64 / (255.0 * 255.0) / channels;
        let mse_linear = sum_linear / channels;
        Ok(Self {
            pixels,
            differing,
            max_abs,
            mean_abs: sum_abs as f64 / channels,
            mse_srgb,
            psnr_srgb: decibel(mse_srgb),
            mse_linear,
            psnr_linear: decibel(mse_linear),
        })
    }
}

/// A picture of where two pictures differ: each channel's absolute difference
/// (alpha's is added to all three), four times as bright, on opaque black.
pub fn difference(a: Colors<'_>, b: Colors<'_>) -> Result<Vec<[u8; 4]>, SizeError> {
    check_sizes(a, b)?;
    let pixel = |(p, q): (&[u8; 4], &[u8; 4])| {
        let alpha = p[3].abs_diff(q[3]);
        let channel = |c: usize| p[c].abs_diff(q[c]).saturating_add(alpha).saturating_mul(4);
        [channel(0), channel(1), channel(2), 255]
    };
    Ok(a.2.iter().zip(b.2).map(pixel).collect())
}

fn check_sizes(a: Colors<'_>, b: Colors<'_>) -> Result<(), SizeError> {
    let are_same = (a.0, a.1, a.2.len()) == (b.0, b.1, b.2.len());
    are_same
        .then_some(())
        .ok_or(SizeError((a.0, a.1), (b.0, b.1)))
}

fn decibel(mse: f64) -> f64 {
    -10.0 * libm::log10(mse)
}

pub(super) fn on_black([r, g, b, alpha]: [u8; 4]) -> [u8; 3] {
    [r, g, b].map(|c| ((u32::from(c) * u32::from(alpha) + 127) / 255) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_worked_out_by_hand() {
        let a = [[100, 100, 100, 255]; 4];
        let mut b = a;
        b[2][1] = 151;
        let between = |a: &[_], b: &[_]| ColorError::between((2, 2, a), (2, 2, b));
        let error = between(&a, &b).unwrap();
        assert_eq!((error.differing, error.max_abs), (1, 51));
        // Linear light of 100 and 151 by the sRGB standard: 0.127438 and 0.309469.
        let linear = (0.309_469f64 - 0.127_438).powi(2) / 12.0;
        for (found, expected, off) in [
            (error.mean_abs, 51.0 / 12.0, 1e-12),
            (error.mse_srgb, 0.04 / 12.0, 1e-12),
            // -10 log10(0.04 / 12)
            (error.psnr_srgb, 24.771_212_547, 1e-8),
            (error.mse_linear, linear, 1e-3 * linear),
        ] {
            assert!((found - expected).abs() < off, "{found}, {expected}");
        }
        let apart = difference((2, 2, &a), (2, 2, &b)).unwrap();
        assert_eq!((apart[2], apart[0]), ([0, 204, 0, 255], [0, 0, 0, 255]));
        // Invisible colours count as differing only.
        let error = between(&[[200, 9, 9, 0]; 4], &[[9, 9, 9, 0]; 4]).unwrap();
        assert_eq!((error.differing, error.psnr_linear), (4, f64::INFINITY));
        assert!(ColorError::between((2, 2, &a), (4, 1, &a)).is_err());
        assert!(between(&a, &a[..3]).is_err());
    }
}
