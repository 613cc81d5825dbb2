//! The automatically chosen level is about as good as the triangles.

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox_mesh::generate::{Kind, generate};
use shiftvox_mesh::textured::view::{Detail, draw};
use shiftvox_mesh::textured::{Element, build};

use super::scenes::{file_of, options};
use super::shared::{difference, triangles};
use super::view::{shown, view};

/// Decibel, over all of the picture.
fn psnr(reference: &[[u8; 4]], picture: &[[u8; 4]]) -> f64 {
    -20.0 * libm::log10(difference(reference, picture, |b| f64::from(b) / 255.0).max(1e-5))
}

#[test]
fn the_automatic_level_is_about_as_good_as_triangles_at_one_sample() {
    let background = Some([20, 20, 30]);
    // Texels of a pixel alone would allow levels that are worse by so many decibel.
    let mut worst_by_texels: f64 = 0.0;
    let mut with_textures = 0;
    for kind in [Kind::Village, Kind::Tree, Kind::Wheel, Kind::Garden] {
        let mesh = generate(kind, 3);
        let grids = options(&[4, 16, 64], 16, Element::Sides);
        let file = file_of(&build(&mesh, &grids, &Silent).unwrap());
        let (low, high) = mesh.bounds();
        let (middle, radius) = ((low + high) * 0.5, (high - low).length() * 0.5);
        for direction in [[0.3, 1.0, 0.2], [1.0, 0.6, 0.8], [0.05, 0.1, -1.0]] {
            for away in [3.0, 12.0, 60.0, 400.0] {
                let eye = middle + DVec3::from_array(direction).normalize() * radius * away;
                let view = view(eye, middle, 128, 40.0);
                let [reference, one] =
                    [256, 1].map(|samples| triangles(&mesh, &view, samples, None, background).rgba);
                let drawn = |detail| {
                    let mut options = shown(detail);
                    options.raster.background = background;
                    let (picture, counts) = draw(&file, &view, &options).unwrap();
                    (psnr(&reference, &picture.rgba), counts.choice.texel_px)
                };
                let rival = psnr(&reference, &one);
                let (auto, texel) = drawn(Detail::Auto { texel_px: 1.0 });
                // From 48 dB on the error is less than a step of a byte.
                assert!(
                    auto > (rival - 1.0).min(48.0),
                    "{kind:?} from {direction:?} {away}: {auto} dB, triangles {rival}"
                );
                with_textures += u32::from(texel > 0.0);
                let (coarse, texel) = drawn(Detail::Level { grid: 2, level: 0 });
                if texel <= 1.0 {
                    worst_by_texels = worst_by_texels.max(rival - coarse);
                }
            }
        }
    }
    assert!(worst_by_texels > 3.0, "{worst_by_texels} dB");
    assert!(with_textures > 0);
}
