//! Parts of large objects stay opaque, thin ones keep their area: both kinds of opacity.

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox_mesh::far::view::{FarPicture, FarViewer, Opacity, ViewOptions};
use shiftvox_mesh::far::{BuildOptions, FarFile, build};
use shiftvox_mesh::raster::RasterCamera;
use shiftvox_mesh::{Material, Mesh, MeshBuilder};

use super::city::file_of;
use super::shared::{area, around, directions, quad, triangles};

/// A sphere of 2 * n * n triangles about the origin.
fn sphere(builder: &mut MeshBuilder, radius: f64, n: u32, material: u32) {
    let at = |i: u32, j: u32| {
        let (sin, cos) = libm::sincos(std::f64::consts::PI * f64::from(i) / f64::from(n));
        // One pole, one first column: the sphere is closed to the last bit.
        let sin = if i == n { 0.0 } else { sin };
        let around = std::f64::consts::TAU * f64::from(j % n) / f64::from(n);
        let (s, c) = libm::sincos(around);
        [sin * c * radius, cos * radius, sin * s * radius].map(|c| c as f32)
    };
    for i in 0..n {
        for j in 0..n {
            let [a, b, c, d] = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)]
                .map(|(i, j)| builder.position(at(i, j)));
            quad(builder, [a, b, c, d], material);
        }
    }
}

/// A tube of `sides * parts * 2` triangles.
fn tube(builder: &mut MeshBuilder, from: DVec3, to: DVec3, radius: f64, [sides, parts]: [u32; 2]) {
    let axis = (to - from).normalize();
    let (right, up) = axis.any_orthonormal_pair();
    let at = |part: u32, side: u32| {
        let along = from + (to - from) * (f64::from(part) / f64::from(parts));
        let angle = std::f64::consts::TAU * f64::from(side % sides) / f64::from(sides);
        let (sin, cos) = libm::sincos(angle);
        let point = along + (right * cos + up * sin) * radius;
        point.to_array().map(|c| c as f32)
    };
    for part in 0..parts {
        for side in 0..sides {
            let [a, b, c, d] = [
                (part, side),
                (part, side + 1),
                (part + 1, side + 1),
                (part + 1, side),
            ]
            .map(|(part, side)| builder.position(at(part, side)));
            quad(builder, [a, b, c, d], 0);
        }
    }
}

fn far(mesh: &Mesh) -> FarFile {
    file_of(&build(mesh, &BuildOptions::default(), &Silent).unwrap())
}

/// A white sphere of radius 10 round a red one.
pub(crate) fn nested_spheres(n: u32, inner: f64) -> Mesh {
    let mut builder = MeshBuilder::new();
    let white = builder.material(Material::of_srgb("white", [255; 3]));
    let red = builder.material(Material::of_srgb("red", [255, 0, 0]));
    sphere(&mut builder, 10.0, n, white);
    sphere(&mut builder, inner, 40, red);
    builder.finish("spheres").unwrap()
}

pub(crate) fn draw(file: &FarFile, view: &RasterCamera, opacity: Opacity) -> FarPicture {
    let options = ViewOptions {
        opacity,
        background: Some([255; 3]),
        ..ViewOptions::default()
    };
    FarViewer::new(file).draw(view, &options).unwrap().0
}

/// A closed white sphere round a red one shows no red, from any side, at any distance.
#[test]
fn a_closed_sphere_hides_what_is_in_it() {
    let mesh = nested_spheres(64, 9.0);
    let file = far(&mesh);
    let mut voxels = 0;
    let mut told = String::new();
    for size in [12, 40, 120, 400] {
        for (number, towards) in directions(12).enumerate() {
            let view = around(&mesh, towards, 1.5 + number as f64, size);
            for opacity in [Opacity::Scalar, Opacity::Six] {
                let picture = draw(&file, &view, opacity);
                // All else is white.
                let red = picture.rgba.iter().map(|p| p[0].abs_diff(p[1])).max();
                let red = red.unwrap();
                if red > 2 {
                    let pixels = picture.rgba.iter().filter(|p| p[0].abs_diff(p[1]) > 2);
                    let pixels = pixels.count();
                    told += &format!("{pixels} pixels {red}: {opacity:?}, {size}, {towards}\n");
                }
                let is_inner =
                    |node: &&i32| usize::try_from(**node).is_ok_and(|n| !file.nodes()[n].is_leaf());
                voxels += picture.node.iter().filter(is_inner).count();
            }
        }
    }
    assert!(voxels > 1000, "{voxels}");
    assert!(told.is_empty(), "{told}");
}

/// Of all directions the mean of the area in the picture over that of the triangles, less 1.
fn bias(mesh: &Mesh, file: &FarFile, size: u32, opacity: Opacity) -> f64 {
    let mut areas = [0.0f64; 2];
    for towards in directions(16) {
        let view = around(mesh, towards, 2.0, size);
        let picture = draw(file, &view, opacity);
        areas[0] += area(&picture.coverage);
        areas[1] += area(&triangles(mesh, &view, 256, None, None).coverage);
    }
    areas[0] / areas[1] - 1.0
}

/// Spokes thinner than a voxel keep their area within a tenth; those of two voxels, of which
/// several lie behind each other at the tube's edge, grow by less than a quarter.
#[test]
fn thin_tubes_keep_their_area() {
    let of_radius = |radius: f64| {
        let mut builder = MeshBuilder::new();
        for k in 0..24 {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / 24.0);
            let side = if k % 2 == 0 { 0.1 } else { -0.1 };
            let hub = DVec3::new(0.1 * cos, 0.1 * sin, side);
            tube(&mut builder, hub, DVec3::new(cos, sin, 0.0), radius, [8, 6]);
        }
        builder.finish("spokes").unwrap()
    };
    let mut told = String::new();
    let mut is_kept = true;
    for (radius, most) in [(0.003, 0.1), (0.01, 0.1), (0.03, 0.25)] {
        let mesh = of_radius(radius);
        let file = far(&mesh);
        for size in [64, 32, 16] {
            for opacity in [Opacity::Scalar, Opacity::Six] {
                let bias = bias(&mesh, &file, size, opacity);
                told += &format!("radius {radius}, {size} pixels, {opacity:?}: {bias:+.3}\n");
                is_kept &= bias.abs() < most;
            }
        }
    }
    assert!(is_kept, "{told}");
}

/// Seen from outside, voxels are drawn wherever they are as small as asked for, however near.
#[test]
fn small_fitted_pictures_are_drawn_as_voxels() {
    let mut builder = MeshBuilder::new();
    sphere(&mut builder, 1.0, 64, 0);
    let mesh = builder.finish("sphere").unwrap();
    let file = far(&mesh);
    let counts = |size| {
        let view = around(&mesh, DVec3::new(0.3, 0.4, 1.0), 1.0, size);
        let mut viewer = FarViewer::new(&file);
        viewer.draw(&view, &ViewOptions::default()).unwrap().1
    };
    let small = counts(40);
    assert_eq!((small.leaves, small.voxel_nodes), (0, 1), "{small:?}");
    assert!(counts(2000).leaves > 0);
}
