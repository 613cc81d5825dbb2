//! Meshes that tests build textured voxels of.
#![expect(unreachable_pub, reason = "a module of a test crate")]

use proptest::prelude::*;
use shiftvox::graph::Silent;
use shiftvox_mesh::textured::store::encode;
use shiftvox_mesh::textured::{BuildOptions, Element, TexturedData, TexturedFile, build};
use shiftvox_mesh::{Material, Mesh, MeshBuilder};

/// Triangles, each of a colour of its own: [`color_of`] its number.
pub fn mesh_of(triangles: &[[[f32; 3]; 3]]) -> Option<Mesh> {
    let mut builder = MeshBuilder::new();
    let mut added = 0;
    for corners in triangles {
        let [a, b, c] = corners.map(|p| p.map(f64::from).into());
        let (a, b, c): (glam::DVec3, glam::DVec3, glam::DVec3) = (a, b, c);
        // Triangles that the builder leaves out must not take a number.
        if (b - a).cross(c - a) == glam::DVec3::ZERO {
            continue;
        }
        let material = builder.material(Material::of_srgb("own", color_of(added)));
        let numbers = corners.map(|p| builder.position(p));
        builder.triangle(numbers, None, material).unwrap();
        added += 1;
    }
    builder.finish("a random mesh").ok()
}

/// The colour of triangle `number`.
pub fn color_of(number: u32) -> [u8; 3] {
    let [r, g, b, _] = (number * 77 + 5).to_le_bytes();
    [r, g, b]
}

/// Triangles with corners on a coarse lattice, so that many lie on the borders
/// of cells and through the middles of texels, and some with corners anywhere.
pub fn random_triangles() -> impl Strategy<Value = Vec<[[f32; 3]; 3]>> {
    let coarse = (0u8..=16).prop_map(|n| f32::from(n) * 0.5);
    let any = (0u32..1 << 20).prop_map(|n| n as f32 / 131_072.0);
    let coordinate = prop_oneof![3 => coarse, 1 => any];
    let corner = prop::array::uniform3(coordinate);
    prop::collection::vec(prop::array::uniform3(corner), 1..24)
}

/// Cells and texels of a small grid.
pub fn small_grids() -> impl Strategy<Value = (u32, u32, Element)> {
    let cells = prop_oneof![Just(2u32), Just(4), Just(6), Just(8)];
    let element = prop_oneof![Just(Element::Cube), Just(Element::Sides)];
    (cells, 1u32..6, element)
}

/// Builds with one grid.
pub fn built(mesh: &Mesh, cells: u32, texels: u32, element: Element) -> TexturedData {
    let options = BuildOptions {
        grids: vec![cells],
        texels,
        element,
    };
    build(mesh, &options, &Silent).unwrap()
}

/// The built data as a file.
pub fn file_of(data: &TexturedData) -> TexturedFile {
    TexturedFile::from_bytes(&encode(data).unwrap()).unwrap()
}

/// A cloud of balls: closed surfaces with gaps between, and depth.
pub fn balls() -> Mesh {
    let mut triangles = Vec::new();
    let mut state = 11u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1u32 << 24) as f32
    };
    for _ in 0..60 {
        let middle = [random() * 8.0, random() * 5.0, random() * 8.0];
        ball(middle, 0.3 + random() * 0.5, &mut triangles);
    }
    mesh_of(&triangles).unwrap()
}

/// A ball of 160 triangles.
fn ball(middle: [f32; 3], radius: f32, triangles: &mut Vec<[[f32; 3]; 3]>) {
    let point = |i: u32, j: u32| {
        let (down, around) = (i as f64 / 8.0, (j % 10) as f64 / 10.0);
        let (s, c) = (down * std::f64::consts::PI).sin_cos();
        let (u, v) = (around * std::f64::consts::TAU).sin_cos();
        let unit = [s * u, c, s * v];
        std::array::from_fn(|k| middle[k] + radius * unit[k] as f32)
    };
    for i in 0..8 {
        for j in 0..10 {
            let [a, b, c, d] = [
                point(i, j),
                point(i + 1, j),
                point(i + 1, j + 1),
                point(i, j + 1),
            ];
            triangles.push([a, b, c]);
            triangles.push([a, c, d]);
        }
    }
}
