//! Distances of a picture from its reference.

use super::reference::Reference;
use crate::measure::{ColorError, CoverageBias, Flip, SizeError};
use crate::report::{Cell, Row};

pub(super) struct Judge<'r> {
    reference: &'r Reference,
    flip: Flip,
}

impl<'r> Judge<'r> {
    pub(super) fn new(reference: &'r Reference) -> Self {
        let flip = Flip::new((reference.width, reference.height, &reference.rgba));
        Self { reference, flip }
    }

    /// Sets the columns of errors: of colours, and of the covered share of each pixel.
    pub(super) fn put(
        &self,
        row: &mut Row,
        rgba: &[[u8; 4]],
        shares: &[f32],
    ) -> Result<(), SizeError> {
        let (width, height) = (self.reference.width, self.reference.height);
        let picture = (width, height, rgba);
        let color = ColorError::between(picture, (width, height, &self.reference.rgba))?;
        let flip = Flip::new(picture).mean_error(&self.flip);
        let right = (width as usize, self.reference.shares.as_slice());
        let CoverageBias { all, thin } = CoverageBias::between(shares, right);
        let percent = |share: f64| Cell::Number(100.0 * share, 2);
        row.put("psnr", Cell::Number(color.psnr_linear, 2));
        row.put("flip", Cell::Number(flip, 4));
        row.put("ssim", Cell::Number(color.ssim, 4));
        row.put("rms_linear", Cell::Number(libm::sqrt(color.mse_linear), 5));
        row.put("bias_percent", percent(all.bias()));
        row.put("coverage_percent", percent(all.relative()));
        if thin.area > 0.0 {
            row.put("thin_bias_percent", percent(thin.bias()));
            row.put("thin_coverage_percent", percent(thin.relative()));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_notices_another_picture() {
        let reference = Reference {
            width: 16,
            height: 16,
            rgba: (0..256u32)
                .map(|i| [i as u8, (i * 7 % 256) as u8, 90, 255])
                .collect(),
            shares: (0..256).map(|i| (i % 5) as f32 / 4.0).collect(),
        };
        let judged = |rgba: &[[u8; 4]], shares: &[f32]| {
            let mut row = Row::default();
            Judge::new(&reference).put(&mut row, rgba, shares).unwrap();
            ["rms_linear", "flip", "ssim", "bias_percent", "psnr"].map(|name| row.number(name))
        };
        let [rms, flip, ssim, bias, psnr] = judged(&reference.rgba, &reference.shares);
        assert_eq!((rms, flip, bias, psnr), (0.0, 0.0, 0.0, f64::INFINITY));
        assert!((ssim - 1.0).abs() < 1e-12);
        let darker: Vec<_> = reference
            .rgba
            .iter()
            .map(|[r, g, b, a]| [r / 2, g / 2, b / 2, *a])
            .collect();
        let [rms, flip, ssim, bias, psnr] = judged(&darker, &[0.0; 256]);
        assert!(rms > 0.05 && flip > 0.05 && ssim < 0.95);
        assert!((psnr + 20.0 * libm::log10(rms)).abs() < 1e-9);
        assert_eq!(bias, -100.0);
    }
}
