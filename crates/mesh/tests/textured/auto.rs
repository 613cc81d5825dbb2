//! The level that is chosen automatically is about as good as the triangles.

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox_mesh::generate::{Kind, generate};
use shiftvox_mesh::raster::{Pattern, RasterCamera, Samples};
use shiftvox_mesh::textured::view::{Detail, ViewOptions, draw};
use shiftvox_mesh::textured::{BuildOptions, Element, TexturedFile, build};

use super::scenes::file_of;
use super::shared::{difference, triangles};
use super::view::view;

const BACKGROUND: Option<[u8; 3]> = Some([20, 20, 30]);

/// Decibel, over all of the picture.
fn psnr(reference: &[[u8; 4]], picture: &[[u8; 4]]) -> f64 {
    -20.0 * libm::log10(difference(reference, picture, |b| f64::from(b) / 255.0).max(1e-5))
}

fn drawn(file: &TexturedFile, view: &RasterCamera, detail: Detail) -> (Vec<[u8; 4]>, f64) {
    let options = ViewOptions {
        detail,
        samples: Samples::new(1, Pattern::Regular).unwrap(),
        light: None,
        background: BACKGROUND,
    };
    let (picture, counts) = draw(file, view, &options).unwrap();
    (picture.rgba, counts.choice.texel_px)
}

#[test]
fn auto_is_about_as_good_as_triangles_at_one_sample() {
    let mut worst_by_texels: f64 = 0.0;
    let mut levels = 0;
    for kind in [Kind::Village, Kind::Tree, Kind::Wheel, Kind::Garden] {
        let mesh = generate(kind, 3);
        let grids = BuildOptions {
            grids: vec![4, 16, 64],
            texels: 16,
            element: Element::Sides,
        };
        let file = file_of(&build(&mesh, &grids, &Silent).unwrap());
        let (low, high) = mesh.bounds();
        let (middle, radius) = ((low + high) * 0.5, (high - low).length() * 0.5);
        for direction in [
            DVec3::new(0.3, 1.0, 0.2),
            DVec3::new(1.0, 0.6, 0.8),
            DVec3::new(0.05, 0.1, -1.0),
        ] {
            for away in [3.0, 12.0, 60.0, 400.0] {
                let eye = middle + direction.normalize() * radius * away;
                let view = view(eye, middle, 128, 40.0);
                let picture = |samples| triangles(&mesh, &view, samples, None, BACKGROUND).rgba;
                let reference = picture(256);
                let rival = psnr(&reference, &picture(1));
                let (auto, texel) = drawn(&file, &view, Detail::Auto { texel_px: 1.0 });
                let auto = psnr(&reference, &auto);
                // From 48 dB on the error is less than a step of a byte.
                assert!(
                    auto > (rival - 1.0).min(48.0),
                    "{kind:?} from {direction} {away}: {auto} dB, triangles {rival}"
                );
                levels += u32::from(texel > 0.0);
                // The level that texels of a pixel alone would allow.
                let (coarse, texel) = drawn(&file, &view, Detail::Level { grid: 2, level: 0 });
                if texel <= 1.0 {
                    worst_by_texels = worst_by_texels.max(rival - psnr(&reference, &coarse));
                }
            }
        }
    }
    assert!(
        worst_by_texels > 3.0,
        "texels alone are no measure: {worst_by_texels} dB"
    );
    assert!(levels > 0, "from afar textures are used");
}
