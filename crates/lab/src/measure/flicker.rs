//! How restless a film is: what changes from frame to frame and should not.

use super::color::on_black;
use shiftvox::picture::Linear;

/// A picture in linear light, 0 to 1 a channel.
pub(crate) type Light = Vec<[f32; 3]>;

/// The light of sRGB bytes, as they appear on black.
pub(crate) fn light_of(rgba: &[[u8; 4]]) -> Light {
    let linear = Linear::tables();
    let light = |&pixel: &[u8; 4]| linear.decode(on_black(pixel)).map(|c| c as f32 / 65535.0);
    rgba.iter().map(light).collect()
}

/// Flicker of a film `T` against a reference film `R` of the same moments: the root of the mean
/// square, over pixels, channels and frames, of `(T_t - T_(t-1)) - (R_t - R_(t-1))`. Also that of
/// the worst step. A steady error does not flicker, and neither does what moves as the reference
/// moves. `None` for films of different lengths or sizes.
pub(crate) fn flicker(film: &[Light], truth: &[Light]) -> Option<(f64, f64)> {
    let pixels = truth.first().map_or(0, Vec::len);
    let has_size = |picture: &Light| picture.len() == pixels;
    if film.len() != truth.len() || !film.iter().chain(truth).all(has_size) {
        return None;
    }
    let steps: Vec<f64> = film
        .windows(2)
        .zip(truth.windows(2))
        .map(|(film, truth)| mean_square([film, truth].map(|of| [&of[0], &of[1]])))
        .collect();
    let mean = steps.iter().sum::<f64>() / steps.len().max(1) as f64;
    let worst = steps.into_iter().fold(0.0, f64::max);
    Some((libm::sqrt(mean), libm::sqrt(worst)))
}

fn mean_square([test, reference]: [[&Light; 2]; 2]) -> f64 {
    let step =
        |[before, now]: [&Light; 2], at: usize, c: usize| f64::from(now[at][c] - before[at][c]);
    let pixel = |at: usize| -> f64 {
        let squares = (0..3).map(|c| {
            let apart = step(test, at, c) - step(reference, at, c);
            apart * apart
        });
        squares.sum()
    };
    let pixels = test[0].len();
    (0..pixels).map(pixel).sum::<f64>() / (3.0 * pixels.max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film<const N: usize>(frames: [f32; N]) -> Vec<Light> {
        frames.map(|value| vec![[value; 3]; 2]).into()
    }

    #[test]
    fn what_changes_alone_flickers() {
        let both = |value| Some((value, value));
        let black = vec![[0.0; 3]; 2];
        let one_channel = vec![[0.0; 3], [0.0, 0.0, 0.75]];
        for (test, truth, expected) in [
            // Steady errors and true motion do not.
            (film([0.5, 0.5, 0.5]), film([0.25, 0.25, 0.25]), both(0.0)),
            (film([0.5, 0.75]), film([0.25, 0.5]), both(0.0)),
            (film([0.5]), film([0.0]), both(0.0)),
            (film([0.5, 0.5]), film([0.0, 1.0]), both(1.0)),
            (film([0., 1., 1., 1., 1.]), film([0.5; 5]), Some((0.5, 1.0))),
            // A sixth of the numbers.
            (
                vec![black, one_channel],
                film([0.0, 0.0]),
                both(libm::sqrt(0.5625 / 6.0)),
            ),
            (film([0.5]), film([0.5, 0.5]), None),
            (vec![vec![]; 2], film([0.5, 0.5]), None),
        ] {
            assert_eq!(flicker(&test, &truth), expected, "{test:?}");
        }
    }

    #[test]
    fn light_of_bytes() {
        let light = light_of(&[[255, 0, 188, 255], [255, 255, 255, 0]]);
        assert_eq!((light[0][0], light[0][1], light[1]), (1.0, 0.0, [0.0; 3]));
        assert!((light[0][2] - 0.503).abs() < 0.001, "{light:?}");
    }
}
