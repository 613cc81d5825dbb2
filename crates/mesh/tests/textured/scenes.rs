//! Meshes for tests of textured voxels.
#![expect(unreachable_pub, reason = "a module of a test crate")]

use glam::DVec3;
use proptest::prelude::*;
use shiftvox::graph::Silent;
use shiftvox_mesh::raster::RasterCamera;
use shiftvox_mesh::textured::store::encode;
use shiftvox_mesh::textured::{BuildOptions, Element, TexturedData, TexturedFile, build};
use shiftvox_mesh::{Material, Mesh, MeshBuilder};

use super::shared::{self, Corners, looking, shape, soup};

/// Without triangles that have no area.
pub fn mesh_of(triangles: &[Corners]) -> Option<Mesh> {
    let mut builder = MeshBuilder::new();
    let has_area = |corners: &&Corners| {
        let [a, b, c] = corners.map(|p| glam::Vec3::from(p).as_dvec3());
        (b - a).cross(c - a) != DVec3::ZERO
    };
    for (number, &corners) in triangles.iter().filter(has_area).enumerate() {
        let color = color_of(number as u32);
        let material = builder.material(Material::of_srgb("own", color));
        shared::triangle(&mut builder, corners, material);
    }
    builder.finish("a random mesh").ok()
}

pub fn color_of(number: u32) -> [u8; 3] {
    let [r, g, b, _] = (number * 77 + 5).to_le_bytes();
    [r, g, b]
}

pub fn rectangle(z: f32, low: [f32; 2], high: [f32; 2]) -> [Corners; 2] {
    let [a, b] = [[low[0], low[1], z], [high[0], low[1], z]];
    let [c, d] = [[high[0], high[1], z], [low[0], high[1], z]];
    [[a, b, c], [a, c, d]]
}

/// Many corners lie on borders of cells and on middles of texels.
pub fn random_triangles() -> impl Strategy<Value = Vec<Corners>> {
    let coarse = (0u8..=16).prop_map(|n| f32::from(n) * 0.5);
    let any = (0u32..1 << 20).prop_map(|n| n as f32 / 131_072.0);
    let coordinate = prop_oneof![3 => coarse, 1 => any];
    let corner = prop::array::uniform3(coordinate);
    prop::collection::vec(prop::array::uniform3(corner), 1..24)
}

pub fn small_grids() -> impl Strategy<Value = (u32, u32, Element)> {
    let cells = prop::sample::select(vec![2u32, 4, 6, 8]);
    let element = prop::sample::select(vec![Element::Cube, Element::Sides]);
    (cells, 1u32..6, element)
}

pub fn options(grids: &[u32], texels: u32, element: Element) -> BuildOptions {
    BuildOptions {
        grids: grids.to_vec(),
        texels,
        element,
    }
}

pub fn built(mesh: &Mesh, cells: u32, texels: u32, element: Element) -> TexturedData {
    build(mesh, &options(&[cells], texels, element), &Silent).unwrap()
}

pub fn file_of(data: &TexturedData) -> TexturedFile {
    TexturedFile::from_bytes(&encode(data).unwrap()).unwrap()
}

/// A cloud of balls: closed surfaces with gaps between, and depth.
pub fn balls() -> Mesh {
    let mut state = 11u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1u32 << 24)
    };
    let balls = shape(|builder| {
        for _ in 0..60 {
            let middle = DVec3::new(random() * 8.0, random() * 5.0, random() * 8.0);
            let radius = 0.3 + random() * 0.5;
            shared::sphere(builder, middle, radius, [8, 10], 0);
        }
    });
    mesh_of(&soup(&balls)).unwrap()
}

pub fn middle(file: &TexturedFile) -> DVec3 {
    let (low, high) = file.bounds();
    (low + high) * 0.5
}

pub fn view(eye: DVec3, target: DVec3, side: u32, fov_degrees: f64) -> RasterCamera {
    let focal_px = f64::from(side) / 2.0 / libm::tan(fov_degrees.to_radians() / 2.0);
    RasterCamera {
        near: 1e-4,
        ..looking(eye, target, [side; 2], focal_px)
    }
}
