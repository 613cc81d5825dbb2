//! Colour error between two pictures.

use super::ssim::ssim;
use shiftvox::picture::Linear;

/// Colours of a picture as the metrics take them: size and sRGB with alpha.
pub type Colors<'p> = (u32, u32, &'p [[u8; 4]]);

/// Two pictures of different sizes, which cannot be compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the pictures differ in size: {}x{} and {}x{}", .0.0, .0.1, .1.0, .1.1)]
pub struct SizeError(
    /// Width and height of the first.
    pub (u32, u32),
    /// Width and height of the second.
    pub (u32, u32),
);

/// How far the colours of two pictures are apart.
///
/// `differing` and `max_abs` compare all four stored channels. The others compare the colours on a
/// black background: red, green and blue, each times alpha.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColorError {
    /// Pixels of a picture.
    pub pixels: u64,
    /// Pixels with any difference.
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
    /// Structural similarity of the luma, 1 for equal pictures.
    pub ssim: f64,
}

impl ColorError {
    /// Compares two pictures of the same size.
    ///
    /// # Errors
    /// When the sizes differ.
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
            ssim: ssim(a.0 as usize, a.1 as usize, &luma(a.2), &luma(b.2)),
        })
    }
}

/// A picture of where two pictures differ: each channel's absolute difference
/// (alpha's is added to all three), four times as bright, on opaque black.
///
/// # Errors
/// When the sizes differ.
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
    let (a, b) = ((a.0, a.1), (b.0, b.1));
    (a == b).then_some(()).ok_or(SizeError(a, b))
}

fn decibel(mse: f64) -> f64 {
    -10.0 * libm::log10(mse)
}

pub(super) fn on_black([r, g, b, alpha]: [u8; 4]) -> [u8; 3] {
    [r, g, b].map(|c| ((u32::from(c) * u32::from(alpha) + 127) / 255) as u8)
}

/// Luma (Rec. 709 weights on sRGB values), 0..=255.
fn luma(rgba: &[[u8; 4]]) -> Vec<f64> {
    rgba.iter()
        .map(|&pixel| {
            let [r, g, b] = on_black(pixel).map(f64::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey() -> Vec<[u8; 4]> {
        vec![[100, 100, 100, 255]; 4]
    }

    #[test]
    fn one_channel_of_one_pixel() {
        let a = grey();
        let same = ColorError::between((2, 2, &a), (2, 2, &a)).unwrap();
        assert_eq!((same.differing, same.max_abs), (0, 0));
        assert_eq!(
            (same.psnr_srgb, same.psnr_linear),
            (f64::INFINITY, f64::INFINITY)
        );
        let mut b = a.clone();
        b[2][1] = 151;
        let error = ColorError::between((2, 2, &a), (2, 2, &b)).unwrap();
        assert_eq!((error.differing, error.max_abs), (1, 51));
        assert!((error.mean_abs - 51.0 / 12.0).abs() < 1e-12);
        assert!((error.mse_srgb - 0.04 / 12.0).abs() < 1e-12);
        // -10 log10(0.04 / 12)
        assert!((error.psnr_srgb - 24.771_212_547).abs() < 1e-8);
        // Linear light of 100 and 151 by the sRGB standard: 0.127438 and 0.309469.
        let expected = (0.309_469f64 - 0.127_438).powi(2) / 12.0;
        assert!((error.mse_linear / expected - 1.0).abs() < 1e-3);
        assert!(error.ssim < 1.0);
        let apart = difference((2, 2, &a), (2, 2, &b)).unwrap();
        assert_eq!((apart[2], apart[0]), ([0, 204, 0, 255], [0, 0, 0, 255]));
        let error = ColorError::between((2, 2, &a), (4, 1, &a)).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the pictures differ in size: 2x2 and 4x1"
        );
    }

    #[test]
    fn invisible_colours_count_as_differing_only() {
        let error =
            ColorError::between((1, 1, &[[9, 9, 9, 0]]), (1, 1, &[[200, 9, 9, 0]])).unwrap();
        assert_eq!((error.differing, error.mse_srgb), (1, 0.0));
    }
}
