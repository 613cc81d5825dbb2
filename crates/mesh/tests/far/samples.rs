//! Several samples per pixel, and options that a view refuses.

use shiftvox_mesh::far::view::{FarViewer, Opacity, ViewError, ViewOptions};
use shiftvox_mesh::raster::RasterCamera;
use shiftvox_mesh::srgb_to_linear;

use super::city::{draw, far, file_of, lit, view};

fn linear(byte: u8) -> f64 {
    f64::from(srgb_to_linear(byte))
}

#[test]
fn a_pixel_is_the_mean_of_its_samples() {
    let file = file_of(&far());
    for (opacity, distance, across) in [
        (Opacity::None, 60.0, 2),
        (Opacity::None, 300.0, 4),
        (Opacity::Six, 60.0, 2),
        (Opacity::Six, 300.0, 4),
    ] {
        let view = view(30.0, 0.5, distance, 48);
        let options = ViewOptions {
            samples_across: across,
            opacity,
            ..lit(&view, 1.0)
        };
        let (picture, _) = draw(&file, &view, &options);
        // Each pixel of the larger picture is a sample of the smaller one.
        let larger = RasterCamera {
            focal_px: view.focal_px * f64::from(across),
            width: view.width * across,
            height: view.height * across,
            ..view
        };
        let options = ViewOptions {
            samples_across: 1,
            voxel_px: f64::from(across),
            ..options
        };
        let (samples, _) = draw(&file, &larger, &options);
        for number in 0..48 * 48u32 {
            let (x, y) = (number % 48 * across, number / 48 * across);
            let at = |i: u32, j: u32| ((y + j) * larger.width + x + i) as usize;
            let own = (0..across * across).map(|i| at(i % across, i / across));
            let mean = |of: &dyn Fn(usize) -> f64| {
                own.clone().map(of).sum::<f64>() / f64::from(across * across)
            };
            let number = number as usize;
            for (k, &byte) in picture.rgba[number][..3].iter().enumerate() {
                let mean = mean(&|i| linear(samples.rgba[i][k]));
                // Samples and pixels are each rounded to a byte.
                let steps = [byte.saturating_sub(1), byte.saturating_add(1)].map(linear);
                let is_near = (steps[0]..=steps[1]).contains(&mean);
                assert!(is_near, "{opacity:?}, pixel {number}, {k}");
            }
            let coverage = mean(&|i| f64::from(samples.coverage[i]));
            assert!((coverage - f64::from(picture.coverage[number])).abs() < 1e-5);
            let middle = at(across / 2, across / 2);
            assert_eq!(picture.depth[number], samples.depth[middle]);
            assert_eq!(picture.node[number], samples.node[middle]);
        }
    }
}

#[test]
fn invalid_options_are_refused() {
    let file = file_of(&far());
    let refused = |voxel_px: f64, samples_across: u32, width: u32| {
        let options = ViewOptions {
            voxel_px,
            samples_across,
            ..ViewOptions::default()
        };
        let view = RasterCamera {
            width,
            ..view(0.0, 0.5, 60.0, 8)
        };
        FarViewer::new(&file).draw(&view, &options).unwrap_err()
    };
    for samples in [0, 17] {
        assert!(matches!(refused(1.0, samples, 8), ViewError::Samples(_)));
    }
    for voxel_px in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(refused(voxel_px, 1, 8), ViewError::VoxelSize(_)));
    }
    assert!(matches!(refused(1.0, 1, 0), ViewError::Raster(_)));
}
