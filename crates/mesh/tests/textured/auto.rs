//! The level that is chosen by itself is about as good as the triangles.

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox_mesh::raster::{self, Pattern, RasterCamera, RasterOptions, Samples};
use shiftvox_mesh::textured::view::{Detail, ViewOptions, draw};
use shiftvox_mesh::textured::{BuildOptions, Element, TexturedFile, build};
use shiftvox_mesh::{Material, Mesh, MeshBuilder};

use super::scenes::file_of;
use super::view::view;

type Triangles = Vec<[[f64; 3]; 3]>;

/// A mesh of parts, each of a colour of its own.
fn painted(parts: &[(Triangles, [u8; 3])]) -> Mesh {
    let mut builder = MeshBuilder::new();
    for (triangles, color) in parts {
        let material = builder.material(Material::of_srgb("part", *color));
        for corners in triangles {
            let numbers = corners.map(|corner| builder.position(corner));
            builder.triangle(numbers, None, material).unwrap();
        }
    }
    builder.finish("parts").unwrap()
}

fn quad([a, b, c, d]: [[f64; 3]; 4]) -> Triangles {
    vec![[a, b, c], [a, c, d]]
}

fn random(state: &mut u32) -> f64 {
    *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    f64::from(*state >> 8) / f64::from(1u32 << 24)
}

/// Houses with roofs around a tower: most of it lies below the middle plane.
fn village() -> Mesh {
    let mut parts = vec![(
        quad([
            [-9.0, 0.0, -9.0],
            [-9.0, 0.0, 9.0],
            [9.0, 0.0, 9.0],
            [9.0, 0.0, -9.0],
        ]),
        [70, 110, 60],
    )];
    let mut state = 3;
    for i in 0..49 {
        let (x, z) = (f64::from(i % 7 - 3) * 2.4, f64::from(i / 7 - 3) * 2.4);
        let high = if i == 24 {
            7.0
        } else {
            0.8 + random(&mut state)
        };
        let at = |dx: f64, y: f64, dz: f64| [x + dx, y, z + dz];
        let mut walls = Triangles::new();
        for [a, b, c, d] in [
            [-0.7, -0.7, 0.7, -0.7],
            [0.7, -0.7, 0.7, 0.7],
            [0.7, 0.7, -0.7, 0.7],
            [-0.7, 0.7, -0.7, -0.7],
        ] {
            walls.extend(quad([
                at(a, 0.0, b),
                at(c, 0.0, d),
                at(c, high, d),
                at(a, high, b),
            ]));
        }
        let grey = 150 + (random(&mut state) * 90.0) as u8;
        parts.push((walls, [grey, grey, grey - 20]));
        let top = high + 0.6;
        let (near, far) = (at(-0.9, top, 0.0), at(0.9, top, 0.0));
        let [a, b, c, d] =
            [[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]].map(|[x, z]| at(x, high, z));
        let mut roof = quad([a, near, far, b]);
        roof.extend(quad([c, far, near, d]));
        roof.extend([[a, d, near], [b, far, c]]);
        parts.push((roof, [180, 60, 40]));
    }
    painted(&parts)
}

fn tube(from: DVec3, to: DVec3, radius: f64) -> Triangles {
    let along = (to - from).normalize();
    let (u, v) = along.any_orthonormal_pair();
    let ring = |middle: DVec3, i: u32| {
        let (s, c) = (f64::from(i) / 10.0 * std::f64::consts::TAU).sin_cos();
        (middle + (u * c + v * s) * radius).to_array()
    };
    let wall = |i| {
        quad([
            ring(from, i),
            ring(from, i + 1),
            ring(to, i + 1),
            ring(to, i),
        ])
    };
    (0..10).flat_map(wall).collect()
}

fn tubes() -> Mesh {
    let mut state = 5;
    let mut point = || DVec3::from_array([(); 3].map(|()| random(&mut state) * 8.0));
    let parts = (0..40).map(|i| (tube(point(), point(), 0.12), [200, 60 + 4 * i, 40]));
    painted(&parts.collect::<Vec<_>>())
}

fn sphere() -> Mesh {
    let point = |i: u32, j: u32| {
        let (s, c) = (f64::from(i) / 24.0 * std::f64::consts::PI).sin_cos();
        let (x, z) = (f64::from(j) / 48.0 * std::f64::consts::TAU).sin_cos();
        [s * x, c, s * z]
    };
    let strip = |i: u32| {
        let quads = (0..48).flat_map(move |j| {
            quad([
                point(i, j),
                point(i + 1, j),
                point(i + 1, j + 1),
                point(i, j + 1),
            ])
        });
        let sound = quads.filter(|&[a, b, c]| a != b && b != c && a != c);
        (sound.collect(), [220, if i % 4 < 2 { 200 } else { 60 }, 60])
    };
    painted(&(0..24).map(strip).collect::<Vec<_>>())
}

fn foliage() -> Mesh {
    let mut state = 9;
    let mut point =
        |size: f64| DVec3::from_array([(); 3].map(|()| (random(&mut state) - 0.5) * size));
    let leaf = |i: u32| {
        let middle = point(6.0);
        let corners = [middle, middle + point(0.5), middle + point(0.5)];
        (
            vec![corners.map(|c| c.to_array())],
            [40, 90 + (i % 100) as u8, 30],
        )
    };
    painted(&(0..3000).map(leaf).collect::<Vec<_>>())
}

/// Over all of the picture, against triangles at 256 samples a pixel.
fn psnr(reference: &[[u8; 4]], picture: &[[u8; 4]]) -> f64 {
    let square = |(a, b): (&[u8; 4], &[u8; 4])| {
        let differences = (0..4).map(|k| (f64::from(a[k]) - f64::from(b[k])) / 255.0);
        differences.map(|d| d * d).sum::<f64>()
    };
    let sum: f64 = reference.iter().zip(picture).map(square).sum();
    -10.0 * libm::log10((sum / (4.0 * reference.len() as f64)).max(1e-9))
}

fn triangles(mesh: &Mesh, view: &RasterCamera, samples: u32) -> Vec<[u8; 4]> {
    let options = RasterOptions {
        samples: Samples::new(samples, Pattern::Regular).unwrap(),
        light: None,
        background: Some([20, 20, 30]),
    };
    raster::draw(mesh, view, &options, &Silent).unwrap().rgba
}

fn drawn(file: &TexturedFile, view: &RasterCamera, detail: Detail) -> (Vec<[u8; 4]>, f64) {
    let options = ViewOptions {
        detail,
        samples: Samples::new(1, Pattern::Regular).unwrap(),
        light: None,
        background: Some([20, 20, 30]),
    };
    let (picture, counts) = draw(file, view, &options).unwrap();
    (picture.rgba, counts.choice.texel_px)
}

#[test]
fn auto_is_about_as_good_as_triangles_at_one_sample() {
    let mut worst_by_texels: f64 = 0.0;
    let mut levels = 0;
    let meshes = [
        ("village", village()),
        ("tubes", tubes()),
        ("sphere", sphere()),
        ("foliage", foliage()),
    ];
    for (name, mesh) in meshes {
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
                let reference = triangles(&mesh, &view, 256);
                let rival = psnr(&reference, &triangles(&mesh, &view, 1));
                let (auto, texel) = drawn(&file, &view, Detail::Auto { texel_px: 1.0 });
                let auto = psnr(&reference, &auto);
                // From 48 dB on the error is less than a step of a byte.
                assert!(
                    auto > (rival - 1.0).min(48.0),
                    "{name} from {direction} {away}: {auto} dB, triangles {rival}"
                );
                levels += u32::from(texel > 0.0);
                // What texels of a pixel alone would have allowed.
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
