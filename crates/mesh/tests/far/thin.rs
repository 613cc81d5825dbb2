//! Hybrids keep thin things, and what cannot be decimated.

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox_mesh::far::view::{Opacity, ViewOptions};
use shiftvox_mesh::far::{BuildOptions, build};
use shiftvox_mesh::generate::{Kind, generate};
use shiftvox_mesh::{Material, Mesh, MeshBuilder, srgb_to_linear};

use super::city::{draw, file_of};
use super::shared::{area, around, directions, quad, shape, sheet, sphere, triangle, triangles};
use super::solid::hybrid;

const OPTIONS: ViewOptions = ViewOptions {
    voxel_px: 1.0,
    samples_across: 4,
    opacity: Opacity::Six,
    light: None,
    background: None,
};

/// A hybrid is at most half a decibel behind far voxels and triangles of the same mesh, at 40 pixels 0.8.
#[test]
fn thin_meshes_keep_their_area_and_are_as_good_as_the_best_method() {
    for kind in [Kind::Tower, Kind::Fence, Kind::Grass, Kind::Chains] {
        let mesh = generate(kind, 1);
        let files = [true, false].map(|hybrid| {
            let options = BuildOptions {
                hybrid,
                leaf_triangles: 4000,
                ..BuildOptions::default()
            };
            file_of(&build(&mesh, &options, &Silent).unwrap())
        });
        for (size, most) in [(190, 0.5), (60, 0.5), (40, 0.8), (20, 0.5)] {
            let (mut areas, mut squares) = ([0.0; 2], [0.0f64; 3]);
            for towards in directions(4) {
                let view = around(&mesh, towards, 2.0, size);
                let expected = triangles(&mesh, &view, 256, None).coverage;
                let [hybrid, far] = files.each_ref().map(|file| draw(file, &view, &OPTIONS).0);
                let all = triangles(&mesh, &view, 16, None);
                let drawn = [hybrid.coverage, far.coverage, all.coverage];
                areas[0] += area(&drawn[0]);
                areas[1] += area(&expected);
                for (sum, drawn) in squares.iter_mut().zip(&drawn) {
                    let both = drawn.iter().zip(&expected);
                    *sum += both.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>();
                }
            }
            let bias: f64 = areas[0] / areas[1] - 1.0;
            let behind = 10.0 * libm::log10(squares[0] / squares[1].min(squares[2]));
            assert!(bias.abs() < 0.12, "{kind:?}, {size} pixels: {bias:+.3}");
            assert!(behind < most, "{kind:?}, {size} pixels: {behind:+.2} dB");
        }
    }
}

/// A white lawn of which red leaves, less than a voxel above it, cover a fifth.
fn lawn() -> Mesh {
    let mut builder = MeshBuilder::new();
    let [white, red] = [[255; 3], [255, 0, 0]].map(|c| builder.material(Material::of_srgb("", c)));
    let place = |x: u32, z: u32, of: u32| [x, z].map(|c| 2.0 * f64::from(c) / f64::from(of) - 1.0);
    sheet(&mut builder, [40, 40], white, |x, z| {
        let [x, z] = place(x, z, 40);
        DVec3::new(x, 0.0, z)
    });
    for leaf in 0..1600 {
        let [x, z] = place(leaf % 40, leaf / 40, 40).map(|c| c as f32 + 0.01);
        let y = 0.002 * (1 + leaf * 7 % 10) as f32;
        let side = 0.022;
        let corners = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]];
        quad(&mut builder, corners.map(|[a, b]| [x + a, y, z + b]), red);
    }
    builder.finish("lawn").unwrap()
}

/// Neither a coat of leaves nor a bare lawn.
#[test]
fn a_thin_layer_before_a_surface_covers_its_share_of_it() {
    let mesh = lawn();
    let red = |rgba: &[[u8; 4]], coverage: &[f32]| {
        let red = |p: &[u8; 4]| srgb_to_linear(p[0]) - srgb_to_linear(p[1]);
        let all = rgba.iter().zip(coverage);
        all.map(|(p, cover)| red(p) * cover).sum::<f32>()
    };
    for is_hybrid in [false, true] {
        let options = BuildOptions {
            hybrid: is_hybrid,
            ..BuildOptions::default()
        };
        let file = file_of(&build(&mesh, &options, &Silent).unwrap());
        for size in [60, 20] {
            for towards in [[0.1, 1.0, 0.2], [0.6, 0.7, 0.1]] {
                let view = around(&mesh, DVec3::from(towards), 2.0, size);
                let (drawn, counts) = draw(&file, &view, &OPTIONS);
                assert_eq!(counts.leaves, 0);
                let expected = triangles(&mesh, &view, 16, None);
                let share =
                    red(&drawn.rgba, &drawn.coverage) / red(&expected.rgba, &expected.coverage);
                assert!((share - 1.0).abs() < 0.3, "{is_hybrid} {size}: {share}");
            }
        }
    }
}

/// Both sides of a card are at one place, and each has its colour.
#[test]
fn cards_show_the_side_towards_the_eye() {
    let mut builder = MeshBuilder::new();
    let [red, blue] =
        [[255, 0, 0], [0, 0, 255]].map(|c| builder.material(Material::of_srgb("", c)));
    for card in 0..900u16 {
        let [x, y] = [card % 30, card / 30].map(f32::from);
        let corners = [[0.0, 0.0], [0.9, 0.0], [0.9, 0.9], [0.0, 0.9]];
        let [a, b, c, d] = corners.map(|[a, b]| [x + a, y + b, 0.0]);
        quad(&mut builder, [a, b, c, d], red);
        quad(&mut builder, [d, c, b, a], blue);
    }
    let mesh = builder.finish("cards").unwrap();
    let file = file_of(&build(&mesh, &BuildOptions::default(), &Silent).unwrap());
    for (z, shown, hidden) in [(1.0, 0, 2), (-1.0, 2, 0)] {
        let view = around(&mesh, DVec3::new(0.2, 0.3, z), 2.0, 60);
        let (drawn, counts) = draw(&file, &view, &OPTIONS);
        assert_eq!(counts.leaves, 0);
        let sum = |c: usize| drawn.rgba.iter().map(|p| u32::from(p[c])).sum::<u32>();
        assert!(
            20 * sum(hidden) < sum(shown),
            "{z}: {} {}",
            sum(hidden),
            sum(shown)
        );
    }
}

/// Two spheres in one place, and a speck that is too small for numbers of single precision: its node has voxels.
#[test]
fn coincident_spheres_are_built_and_what_is_not_decimated_has_voxels() {
    let spheres = |speck: Option<f32>| {
        shape(|builder| {
            for _ in 0..2 {
                sphere(builder, DVec3::ZERO, 1.0, [24, 24], 0);
            }
            if let Some(side) = speck {
                triangle(builder, [[0.0; 3], [side, 0.0, 0.0], [0.0, side, 0.0]], 0);
            }
        })
    };
    for (speck, is_counted) in [(None, false), (Some(1e-22), true)] {
        let mesh = spheres(speck);
        let data = hybrid(&mesh, 300);
        assert_eq!(data.undecimated > 0, is_counted);
        let file = file_of(&data);
        for size in [60, 20] {
            let view = around(&mesh, DVec3::new(0.3, 0.5, 0.8), 2.0, size);
            let drawn = area(&draw(&file, &view, &OPTIONS).0.coverage);
            let expected = area(&triangles(&mesh, &view, 16, None).coverage);
            assert!(
                (drawn / expected - 1.0).abs() < 0.2,
                "{size} pixels: {drawn} {expected}"
            );
        }
    }
}
