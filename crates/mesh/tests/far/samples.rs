//! More than one sample a pixel.

use shiftvox::graph::Silent;
use shiftvox_mesh::far::FarFile;
use shiftvox_mesh::far::store::encode;
use shiftvox_mesh::far::view::{FarPicture, FarViewer, Opacity, ViewError, ViewOptions};
use shiftvox_mesh::raster::{self, Pattern, RasterCamera, RasterOptions, Samples};

use super::city::{city, far, light, options, view};

fn file() -> FarFile {
    FarFile::from_bytes(&encode(&far(&options())).unwrap()).unwrap()
}

fn draw(
    file: &FarFile,
    view: &RasterCamera,
    samples_across: u32,
    voxel_px: f64,
    opacity: Opacity,
) -> FarPicture {
    let options = ViewOptions {
        voxel_px,
        samples_across,
        opacity,
        light: light(view),
        background: Some([240, 240, 245]),
        ..ViewOptions::default()
    };
    FarViewer::new(file).draw(view, &options).unwrap().0
}

/// sRGB to linear light, by its definition.
fn linear(byte: u8) -> f64 {
    let value = f64::from(byte) / 255.0;
    if value <= 0.04045 {
        value / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    }
}

#[test]
fn a_pixel_is_the_mean_of_its_samples() {
    let file = file();
    for opacity in [Opacity::None, Opacity::Six] {
        for (distance, across) in [(60.0, 2u32), (300.0, 4)] {
            let view = view(30.0, 0.5, distance, 48);
            let picture = draw(&file, &view, across, 1.0, opacity);
            // The same, drawn larger: what is a pixel there is a sample here.
            let larger = RasterCamera {
                focal_px: view.focal_px * f64::from(across),
                width: view.width * across,
                height: view.height * across,
                ..view
            };
            let samples = draw(&file, &larger, 1, f64::from(across), opacity);
            for (number, (pixel, coverage)) in
                picture.rgba.iter().zip(&picture.coverage).enumerate()
            {
                let (x, y) = (number as u32 % 48 * across, number as u32 / 48 * across);
                let all = (0..across * across)
                    .map(|i| ((y + i / across) * larger.width + x + i % across) as usize);
                let count = f64::from(across * across);
                for k in 0..3 {
                    let mean = all.clone().map(|i| linear(samples.rgba[i][k])).sum::<f64>() / count;
                    // Samples and pixels are rounded to a byte each.
                    let steps = [-1i32, 1]
                        .map(|step| linear((i32::from(pixel[k]) + step).clamp(0, 255) as u8));
                    assert!(
                        (steps[0]..=steps[1]).contains(&mean),
                        "{opacity:?}, pixel {number}, {k}"
                    );
                }
                let mean = all
                    .clone()
                    .map(|i| f64::from(samples.coverage[i]))
                    .sum::<f64>()
                    / count;
                assert!((mean - f64::from(*coverage)).abs() < 1e-5);
                let middle = ((y + across / 2) * larger.width + x + across / 2) as usize;
                assert_eq!(picture.depth[number], samples.depth[middle]);
                assert_eq!(picture.node[number], samples.node[middle]);
            }
        }
    }
}

/// Root mean square distance of linear light from 256 samples a pixel.
fn error(picture: &FarPicture, view: &RasterCamera) -> f64 {
    let options = RasterOptions {
        samples: Samples::new(256, Pattern::Stratified { seed: 3 }).unwrap(),
        light: light(view),
        background: Some([240, 240, 245]),
    };
    let reference = raster::draw(&city(), view, &options, &Silent).unwrap();
    let square = |(a, b): (&[u8; 4], &[u8; 4])| {
        (0..3)
            .map(|k| (linear(a[k]) - linear(b[k])).powi(2))
            .sum::<f64>()
    };
    let sum: f64 = picture.rgba.iter().zip(&reference.rgba).map(square).sum();
    (sum / (3 * picture.rgba.len()) as f64).sqrt()
}

#[test]
fn more_samples_are_nearer_to_the_truth() {
    let file = file();
    // Near: leaves. From there on: voxels too, then alone.
    for (distance, ratio) in [(40.0, 0.7), (110.0, 0.8), (300.0, 0.9)] {
        let view = view(30.0, 0.6, distance, 160);
        let errors =
            [1, 2, 4].map(|across| error(&draw(&file, &view, across, 1.0, Opacity::Six), &view));
        assert!(
            errors[0] > errors[1] && errors[1] > errors[2],
            "{distance}: {errors:?}"
        );
        assert!(errors[2] < ratio * errors[0], "{distance}: {errors:?}");
    }
}

#[test]
fn pictures_of_no_or_too_many_samples_are_refused() {
    let file = file();
    for samples_across in [0, 17] {
        let options = ViewOptions {
            samples_across,
            ..ViewOptions::default()
        };
        let drawn = FarViewer::new(&file).draw(&view(0.0, 0.5, 60.0, 8), &options);
        assert!(matches!(drawn, Err(ViewError::Samples(_))));
    }
}
