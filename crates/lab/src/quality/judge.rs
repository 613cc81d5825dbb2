//! Distances of a picture from its reference.

use super::reference::Reference;
use crate::measure::{ColorError, CoverageBias, Flip, SizeError};

/// Distances of a picture from a reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PictureError {
    /// Root of the mean squared difference of a channel, linear light from 0 to 1.
    pub rms_linear: f64,
    /// The same in decibels, `-20 log10`. Infinite for equal pictures.
    pub psnr_linear: f64,
    /// Structural similarity of the luma, 1 for equal pictures.
    pub ssim: f64,
    /// Mean FLIP error, 0 to 1.
    pub flip: f64,
    /// Excess and lack of covered area.
    pub coverage: CoverageBias,
}

/// A reference, made ready to be compared with many pictures.
pub struct Judge<'r> {
    reference: &'r Reference,
    flip: Flip,
}

impl<'r> Judge<'r> {
    /// Makes a reference ready.
    #[must_use]
    pub fn new(reference: &'r Reference) -> Self {
        let Reference {
            width,
            height,
            rgba,
            ..
        } = reference;
        Self {
            reference,
            flip: Flip::new((*width, *height, rgba)),
        }
    }

    /// The errors of a picture of the reference's size: colours, and the covered share of each
    /// pixel.
    ///
    /// # Errors
    /// When the sizes differ.
    pub fn judge(&self, rgba: &[[u8; 4]], shares: &[f32]) -> Result<PictureError, SizeError> {
        let (width, height) = (self.reference.width, self.reference.height);
        let picture = (width, height, rgba);
        let right = (width, height, self.reference.rgba.as_slice());
        let color = ColorError::between(picture, right)?;
        let flip = Flip::new(picture).compare(&self.flip)?;
        let coverage = CoverageBias::between(
            (width, height, shares),
            (width, height, &self.reference.shares),
        )?;
        Ok(PictureError {
            rms_linear: libm::sqrt(color.mse_linear),
            psnr_linear: color.psnr_linear,
            ssim: color.ssim,
            flip: flip.mean(),
            coverage,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reference() -> Reference {
        let rgba: Vec<_> = (0..256u32)
            .map(|i| [i as u8, (i * 7 % 256) as u8, 90, 255])
            .collect();
        Reference {
            width: 16,
            height: 16,
            rgba,
            shares: (0..256).map(|i| (i % 5) as f32 / 4.0).collect(),
        }
    }

    #[test]
    fn the_reference_itself_has_no_error() {
        let reference = reference();
        let judge = Judge::new(&reference);
        let error = judge.judge(&reference.rgba, &reference.shares).unwrap();
        assert_eq!((error.rms_linear, error.flip), (0.0, 0.0));
        assert_eq!(error.psnr_linear, f64::INFINITY);
        assert!((error.ssim - 1.0).abs() < 1e-12);
        assert_eq!(error.coverage.all.absolute, 0.0);
    }

    #[test]
    fn every_number_notices_another_picture() {
        let reference = reference();
        let judge = Judge::new(&reference);
        let darker: Vec<_> = reference
            .rgba
            .iter()
            .map(|p| p.map(|c| c / 2 + 127 * u8::from(c == 255)))
            .collect();
        let none = vec![0.0; 256];
        let error = judge.judge(&darker, &none).unwrap();
        assert!(error.rms_linear > 0.05 && error.flip > 0.05 && error.ssim < 0.95);
        assert!((error.psnr_linear + 20.0 * libm::log10(error.rms_linear)).abs() < 1e-9);
        assert_eq!(error.coverage.all.bias(), -1.0);
    }
}
