//! Several samples per pixel: the view of a picture of samples, and pixels from it.

use super::Pixel;
use crate::raster::RasterCamera;

pub(super) fn finer(view: &RasterCamera, across: u32) -> RasterCamera {
    RasterCamera {
        focal_px: view.focal_px * f64::from(across),
        width: view.width.saturating_mul(across),
        height: view.height.saturating_mul(across),
        ..*view
    }
}

/// Means of a pixel's samples, in premultiplied linear light, without depth.
pub(super) fn averaged(samples: Vec<Pixel>, size: [usize; 2], across: usize) -> Vec<Pixel> {
    if across == 1 {
        return samples;
    }
    let [width, height] = size;
    let share = 1.0 / (across * across) as f32;
    let pixel = |number: usize| {
        let mut mean = Pixel::default();
        for row in 0..across {
            let first = (number / width * across + row) * width * across + number % width * across;
            for sample in &samples[first..first + across] {
                for (mean, light) in mean.light.iter_mut().zip(sample.light) {
                    *mean += light * share;
                }
                mean.coverage += sample.coverage * share;
            }
        }
        mean
    };
    (0..width * height).map(pixel).collect()
}

/// Of each pixel the sample right of and below its middle; with one sample that.
pub(super) fn middles<T: Copy>(samples: &[T], size: [usize; 2], across: usize) -> Vec<T> {
    let [width, height] = size;
    let middle = |number: usize| {
        let (x, y) = (number % width * across, number / width * across);
        samples[(y + across / 2) * width * across + x + across / 2]
    };
    (0..width * height).map(middle).collect()
}
