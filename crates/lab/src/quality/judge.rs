//! Distances of a picture from its reference.

use super::reference::Reference;
use crate::measure::{ColorError, Colors, CoverageBias, Flip, SizeError};
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
        picture: Colors<'_>,
        shares: &[f32],
    ) -> Result<(), SizeError> {
        let (width, height) = (self.reference.width, self.reference.height);
        let color = ColorError::between(picture, (width, height, &self.reference.rgba))?;
        let flip = Flip::new(picture).mean_error(&self.flip);
        let right = (width as usize, self.reference.shares.as_slice());
        let CoverageBias { all, thin } = CoverageBias::between(shares, right);
        let percent = |share: f64| Cell::Number(100.0 * share, 2);
        row.put("psnr", Cell::Number(color.psnr_linear, 2));
        row.put("flip", Cell::Number(flip, 4));
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
        let pixel = |i: u32| [i as u8, (i * 7) as u8, 90, 255];
        let reference = Reference {
            width: 16,
            height: 16,
            rgba: (0..256).map(pixel).collect(),
            shares: (0..256).map(|i| (i % 5) as f32 / 4.0).collect(),
        };
        let judged = |rgba: &[[u8; 4]], shares: &[f32]| {
            let mut row = Row::default();
            let judged = Judge::new(&reference).put(&mut row, (16, 16, rgba), shares);
            judged.map(|()| {
                ["rms_linear", "flip", "bias_percent", "psnr"].map(|name| row.number(name))
            })
        };
        let same = judged(&reference.rgba, &reference.shares).unwrap();
        assert_eq!(same.map(|of| of.clamp(-1.0, 999.0)), [0.0, 0.0, 0.0, 999.0]);
        let darker: Vec<_> = (0..256)
            .map(pixel)
            .map(|[r, g, b, a]| [r / 2, g / 2, b / 2, a])
            .collect();
        let [rms, flip, bias, psnr] = judged(&darker, &[0.0; 256]).unwrap();
        assert!(rms > 0.05 && flip > 0.05 && bias == -100.0);
        assert!((psnr + 20.0 * libm::log10(rms)).abs() < 1e-9);
        assert!(judged(&darker[1..], &[0.0; 255]).is_err());
    }
}
