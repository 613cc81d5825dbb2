//! Several samples per pixel, and options that a view refuses.

use shiftvox_mesh::far::FarFile;
use shiftvox_mesh::far::view::{FarPicture, FarViewer, Opacity, ViewError, ViewOptions};
use shiftvox_mesh::raster::RasterCamera;
use shiftvox_mesh::srgb_to_linear;

use super::city::{city, far, file_of, light, options, view};
use super::shared::{difference, triangles};

const BACKGROUND: Option<[u8; 3]> = Some([240, 240, 245]);

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
        background: BACKGROUND,
        ..ViewOptions::default()
    };
    FarViewer::new(file).draw(view, &options).unwrap().0
}

fn linear(byte: u8) -> f64 {
    f64::from(srgb_to_linear(byte))
}

#[test]
fn a_pixel_is_the_mean_of_its_samples() {
    let file = file_of(&far(&options()));
    for opacity in [Opacity::None, Opacity::Six] {
        for (distance, across) in [(60.0, 2u32), (300.0, 4)] {
            let view = view(30.0, 0.5, distance, 48);
            let picture = draw(&file, &view, across, 1.0, opacity);
            // Each pixel of the larger picture is a sample of the smaller one.
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

#[test]
fn more_samples_are_nearer_to_the_triangles() {
    let file = file_of(&far(&options()));
    // Near: leaves. Farther away: leaves and voxels, then voxels alone.
    for (distance, ratio) in [(40.0, 0.7), (110.0, 0.8), (300.0, 0.9)] {
        let view = view(30.0, 0.6, distance, 160);
        let reference = triangles(&city(), &view, 256, light(&view), BACKGROUND);
        let errors = [1, 2, 4].map(|across| {
            let picture = draw(&file, &view, across, 1.0, Opacity::Six);
            difference(&picture.rgba, &reference.rgba, linear)
        });
        assert!(
            errors.is_sorted_by(|a, b| a > b) && errors[2] < ratio * errors[0],
            "{distance}: {errors:?}"
        );
    }
}

#[test]
fn options_that_cannot_be_drawn_are_refused() {
    let file = file_of(&far(&options()));
    let refused = |voxel_px: f64, samples_across: u32, width: u32| {
        let options = ViewOptions {
            voxel_px,
            samples_across,
            ..ViewOptions::default()
        };
        let mut view = view(0.0, 0.5, 60.0, 8);
        view.width = width;
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
