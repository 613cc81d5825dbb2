//! Parts of large objects stay opaque, thin ones keep their area, with both kinds of opacity.

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox_mesh::far::view::{FarPicture, Opacity, ViewOptions};
use shiftvox_mesh::far::{BuildOptions, FarFile, build};
use shiftvox_mesh::{Material, Mesh, MeshBuilder};

use super::city::{draw, file_of};
use super::shared::{area, around, directions, shape, sheet, sphere, triangles};

fn far(mesh: &Mesh) -> FarFile {
    file_of(&build(mesh, &BuildOptions::default(), &Silent).unwrap())
}

fn options(opacity: Opacity) -> ViewOptions {
    ViewOptions {
        opacity,
        background: Some([255; 3]),
        ..ViewOptions::default()
    }
}

/// A white sphere of radius 10 and so many rows around a red one.
pub(crate) fn nested_spheres(rows: u32, inner: f64) -> Mesh {
    let mut builder = MeshBuilder::new();
    let white = builder.material(Material::of_srgb("white", [255; 3]));
    let red = builder.material(Material::of_srgb("red", [255, 0, 0]));
    sphere(&mut builder, DVec3::ZERO, 10.0, [rows, rows], white);
    sphere(&mut builder, DVec3::ZERO, inner, [40, 40], red);
    builder.finish("spheres").unwrap()
}

/// Draws white around red from all sides, in four sizes, and fails if red shows anywhere.
pub(crate) fn check_hidden(
    (mesh, file): (&Mesh, &FarFile),
    distance: impl Fn(f64) -> f64,
    opacity: Opacity,
    mut see: impl FnMut(&FarPicture, u32),
) {
    for size in [12, 40, 120, 400] {
        for (number, towards) in directions(12).enumerate() {
            let view = around(mesh, towards, distance(number as f64), size);
            let (picture, _) = draw(file, &view, &options(opacity));
            // Everything else is white.
            let is_red = |p: &&[u8; 4]| p[0].abs_diff(p[1]) > 2;
            let red = picture.rgba.iter().filter(is_red).count();
            assert_eq!(red, 0, "red pixels: {opacity:?}, {size}, {towards}");
            see(&picture, size);
        }
    }
}

#[test]
fn a_closed_sphere_hides_everything_inside() {
    let mesh = nested_spheres(64, 9.0);
    let file = far(&mesh);
    let mut voxels = 0;
    for opacity in [Opacity::Scalar, Opacity::Six] {
        check_hidden(
            (&mesh, &file),
            |n| 1.5 + n,
            opacity,
            |picture, _| {
                let nodes = picture.node.iter().filter_map(|&n| usize::try_from(n).ok());
                voxels += nodes.filter(|&n| !file.nodes()[n].is_leaf()).count();
            },
        );
    }
    assert!(voxels > 1000, "{voxels}");
}

/// Spokes of a wheel.
fn spokes(radius: f64) -> Mesh {
    shape(|builder| {
        for k in 0..24 {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / 24.0);
            let side = if k % 2 == 0 { 0.1 } else { -0.1 };
            let from = DVec3::new(0.1 * cos, 0.1 * sin, side);
            let axis = DVec3::new(cos, sin, 0.0) - from;
            let (right, up) = axis.normalize().any_orthonormal_pair();
            sheet(builder, [6, 8], 0, |part, side| {
                let angle = std::f64::consts::TAU * f64::from(side % 8) / 8.0;
                let (sin, cos) = libm::sincos(angle);
                from + axis * (f64::from(part) / 6.0) + (right * cos + up * sin) * radius
            });
        }
    })
}

/// Spokes thinner than a voxel keep their area within a tenth. Spokes of two voxels, of which several lie behind each
/// other at the edge, grow by less than a quarter.
#[test]
fn thin_tubes_keep_their_area() {
    for (radius, most) in [(0.003, 0.1), (0.01, 0.1), (0.03, 0.25)] {
        let mesh = spokes(radius);
        let file = far(&mesh);
        for size in [64, 32, 16] {
            let (mut scalar, mut six, mut expected) = (0.0, 0.0, 0.0);
            for towards in directions(16) {
                let view = around(&mesh, towards, 2.0, size);
                let drawn = |opacity| area(&draw(&file, &view, &options(opacity)).0.coverage);
                scalar += drawn(Opacity::Scalar);
                six += drawn(Opacity::Six);
                expected += area(&triangles(&mesh, &view, 256, None, None).coverage);
            }
            for drawn in [scalar, six] {
                let bias: f64 = drawn / expected - 1.0;
                assert!(bias.abs() < most, "{radius}, {size} pixels: {bias:+.3}");
            }
        }
    }
}
