//! How restless a film is: what changes from frame to frame and should not.

use super::SizeError;
use super::color::{Colors, check_sizes, on_black};
use shiftvox::picture::Linear;

/// A picture in linear light, 0 to 1 a channel.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearPicture {
    size: (u32, u32),
    rgb: Vec<[f32; 3]>,
}

impl LinearPicture {
    /// The light of a picture of sRGB bytes, as it appears on black.
    #[must_use]
    pub fn of((width, height, rgba): Colors<'_>) -> Self {
        let linear = Linear::tables();
        let light = |&pixel: &[u8; 4]| {
            let light = linear.decode(on_black(pixel));
            light.map(|c| c as f32 / 65535.0)
        };
        Self {
            size: (width, height),
            rgb: rgba.iter().map(light).collect(),
        }
    }

    /// A picture of light, row by row from the top left; as long as the size requires.
    #[must_use]
    pub fn new(width: u32, height: u32, rgb: Vec<[f32; 3]>) -> Self {
        Self {
            size: (width, height),
            rgb,
        }
    }

    /// Root of the mean squared difference of a channel, 0 to 1.
    ///
    /// # Errors
    /// When the sizes differ.
    pub fn rms(&self, other: &Self) -> Result<f64, SizeError> {
        check_sizes(self.size, other.size)?;
        let pairs = self.rgb.iter().zip(&other.rgb);
        let sum = pairs.map(|(a, b)| squared(*a, *b)).sum::<f64>();
        Ok(libm::sqrt(sum / self.channels()))
    }

    fn channels(&self) -> f64 {
        3.0 * self.rgb.len().max(1) as f64
    }
}

fn squared(a: [f32; 3], b: [f32; 3]) -> f64 {
    (0..3)
        .map(|c| {
            let apart = f64::from(a[c]) - f64::from(b[c]);
            apart * apart
        })
        .sum()
}

/// Flicker of a film `T` against a reference film `R` of the same moments:
/// the root of the mean square, over pixels, channels and frames, of
/// `(T_t - T_(t-1)) - (R_t - R_(t-1))`. A steady error does not flicker, and
/// neither does what moves as the reference moves.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Flicker {
    last: Option<(LinearPicture, LinearPicture)>,
    /// Mean square of each step.
    steps: Vec<f64>,
}

impl Flicker {
    /// The film's next frame, and the reference's.
    ///
    /// # Errors
    /// When sizes differ, also from those of the last frame.
    pub fn push(&mut self, test: LinearPicture, reference: LinearPicture) -> Result<(), SizeError> {
        check_sizes(test.size, reference.size)?;
        if let Some((last_test, last_reference)) = &self.last {
            check_sizes(test.size, last_test.size)?;
            let sum: f64 = (0..test.rgb.len())
                .map(|i| {
                    let step = |now: &LinearPicture, before: &LinearPicture| {
                        [0, 1, 2].map(|c| now.rgb[i][c] - before.rgb[i][c])
                    };
                    squared(step(&test, last_test), step(&reference, last_reference))
                })
                .sum();
            self.steps.push(sum / test.channels());
        }
        self.last = Some((test, reference));
        Ok(())
    }

    /// The flicker of the whole film; 0 before the second frame.
    #[must_use]
    pub fn rms(&self) -> f64 {
        let steps = self.steps.len().max(1) as f64;
        libm::sqrt(self.steps.iter().sum::<f64>() / steps)
    }

    /// The flicker of each step, from the second frame on.
    #[must_use]
    pub fn by_step(&self) -> Vec<f64> {
        self.steps.iter().map(|&mean| libm::sqrt(mean)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(value: f32) -> LinearPicture {
        LinearPicture::new(2, 1, vec![[value; 3]; 2])
    }

    fn film(frames: &[(f32, f32)]) -> Flicker {
        let mut flicker = Flicker::default();
        for &(test, reference) in frames {
            flicker.push(grey(test), grey(reference)).unwrap();
        }
        flicker
    }

    #[test]
    fn steady_errors_and_true_motion_do_not_flicker() {
        assert_eq!(film(&[(0.5, 0.25), (0.5, 0.25), (0.5, 0.25)]).rms(), 0.0);
        assert_eq!(film(&[(0.5, 0.25), (0.75, 0.5)]).rms(), 0.0);
        assert_eq!(film(&[(0.5, 0.0)]).rms(), 0.0);
    }

    #[test]
    fn what_changes_alone_flickers() {
        let still = film(&[(0.0, 0.5), (1.0, 0.5), (1.0, 0.5)]);
        assert_eq!(still.by_step(), [1.0, 0.0]);
        assert!((still.rms() - libm::sqrt(0.5)).abs() < 1e-12);
        // A reference that changes alone flickers as much.
        assert_eq!(film(&[(0.5, 0.0), (0.5, 1.0)]).rms(), 1.0);
        // One channel of two pixels, by a quarter.
        let mut flicker = Flicker::default();
        let mut moved = grey(0.0);
        flicker.push(grey(0.0), grey(0.0)).unwrap();
        moved.rgb[1][2] = 0.25;
        flicker.push(moved, grey(0.0)).unwrap();
        assert!((flicker.rms() - 0.25 / libm::sqrt(6.0)).abs() < 1e-12);
    }

    #[test]
    fn light_and_sizes() {
        let bytes = [[255, 0, 188, 255], [255, 255, 255, 0]];
        let picture = LinearPicture::of((2, 1, &bytes));
        assert_eq!((picture.rgb[0][0], picture.rgb[0][1]), (1.0, 0.0));
        assert!((picture.rgb[0][2] - 0.503).abs() < 0.001, "{picture:?}");
        assert_eq!(picture.rgb[1], [0.0; 3]);
        assert_eq!(picture.rms(&picture), Ok(0.0));
        assert_eq!(grey(0.25).rms(&grey(0.75)), Ok(0.5));
        let other = LinearPicture::new(1, 2, vec![[0.0; 3]; 2]);
        assert!(picture.rms(&other).is_err());
        assert!(film(&[(0.0, 0.0)]).push(other.clone(), other).is_err());
    }
}
