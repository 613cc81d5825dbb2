//! Cameras, reference pictures and simple meshes for all tests of this crate.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "each test crate uses a part of it"
)]

use std::collections::HashMap;
use std::fmt::Debug;
use std::io::{self, Cursor};

use glam::DVec3;
use image::{ImageFormat, Rgba, RgbaImage};
use shiftvox::graph::Silent;
use shiftvox_mesh::raster::{self, Pattern, RasterCamera, RasterOptions, RasterPicture, Samples};
use shiftvox_mesh::{ColorSpace, Material, Mesh, MeshBuilder, MeshFormat, Surface, read};
use xxhash_rust::xxh3::xxh3_64;

pub type Corners = [[f32; 3]; 3];

/// A length of 1 at a distance of 1 is `focal_px` pixels.
pub fn looking(
    eye: DVec3,
    target: DVec3,
    [width, height]: [u32; 2],
    focal_px: f64,
) -> RasterCamera {
    let forward = (target - eye).normalize();
    let helper = [DVec3::Y, DVec3::X][usize::from(forward.y.abs() > 0.99)];
    let right = forward.cross(helper).normalize();
    RasterCamera {
        eye,
        right,
        up: right.cross(forward),
        forward,
        focal_px,
        width,
        height,
        near: 1e-3,
    }
}

/// The bounds of a mesh fill about `size` pixels, from `distance` of its sizes away.
pub fn around(mesh: &Mesh, towards: DVec3, distance: f64, size: u32) -> RasterCamera {
    let (low, high) = Surface::bounds(mesh);
    let (middle, side) = ((low + high) / 2.0, (high - low).length());
    let eye = middle + towards.normalize() * side * distance;
    looking(eye, middle, [size; 2], f64::from(size) * distance)
}

pub fn directions(count: u32) -> impl Iterator<Item = DVec3> {
    (0..count).map(move |i| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
        let ring = libm::sqrt(1.0 - z * z);
        let (sin, cos) = libm::sincos(f64::from(i) * 2.399_963_229_728_653);
        DVec3::new(ring * cos, ring * sin, z)
    })
}

/// Unlit, with a regular pattern of samples, without a background.
pub fn plain(samples: u32) -> RasterOptions {
    assert!([1, 4, 16, 64, 256].contains(&samples));
    RasterOptions {
        samples: Samples::new(samples.ilog2() / 2, Pattern::Regular),
        light: None,
        background: None,
    }
}

pub fn triangles(
    surface: &dyn Surface,
    view: &RasterCamera,
    samples: u32,
    background: Option<[u8; 3]>,
) -> RasterPicture {
    let options = RasterOptions {
        background,
        ..plain(samples)
    };
    raster::draw(surface, view, &options, &Silent).unwrap()
}

pub fn area(coverage: &[f32]) -> f64 {
    coverage.iter().map(|&share| f64::from(share)).sum()
}

/// The first half of a checksum.
pub fn hash(bytes: &[u8]) -> u32 {
    (xxh3_64(bytes) >> 32) as u32
}

/// Colours, depths and coverage.
pub fn bytes_of(picture: &RasterPicture) -> Vec<u8> {
    let reals = picture.depth.iter().chain(&picture.coverage);
    let mut bytes: Vec<u8> = reals.flat_map(|real| real.to_le_bytes()).collect();
    bytes.extend(picture.rgba.as_flattened());
    bytes
}

pub fn shape(fill: impl FnOnce(&mut MeshBuilder)) -> Mesh {
    let mut builder = MeshBuilder::new();
    builder.material(Material::of_srgb("grey", [90, 120, 150]));
    fill(&mut builder);
    builder.finish("a shape").unwrap()
}

pub fn mesh_of(triangles: impl IntoIterator<Item = Corners>) -> Mesh {
    shape(|builder| {
        for corners in triangles {
            triangle(builder, corners, 0);
        }
    })
}

pub fn soup(mesh: &Mesh) -> Vec<Corners> {
    let corner = |i: u32| mesh.positions()[i as usize].map(|c| c as f32);
    mesh.triangles().iter().map(|t| t.map(corner)).collect()
}

pub fn triangle(builder: &mut MeshBuilder, corners: Corners, material: u32) {
    let corners = corners.map(|p| builder.position(p));
    builder.triangle(corners, None, material).unwrap();
}

pub fn quad(builder: &mut MeshBuilder, [a, b, c, d]: [[f32; 3]; 4], material: u32) {
    triangle(builder, [a, b, c], material);
    triangle(builder, [a, c, d], material);
}

pub fn cuboid(builder: &mut MeshBuilder, low: [f32; 3], high: [f32; 3], material: u32) {
    let corner = |i: usize| [0, 1, 2].map(|k| [low[k], high[k]][i >> k & 1]);
    for face in [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ] {
        quad(builder, face.map(corner), material);
    }
}

/// Rows and columns of quads.
pub fn sheet(
    builder: &mut MeshBuilder,
    [rows, columns]: [u32; 2],
    material: u32,
    at: impl Fn(u32, u32) -> DVec3,
) {
    for i in 0..rows {
        for j in 0..columns {
            let corners = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)];
            let corners = corners.map(|(i, j)| at(i, j).as_vec3().to_array());
            quad(builder, corners, material);
        }
    }
}

/// Closed to the last bit.
pub fn sphere(
    builder: &mut MeshBuilder,
    middle: DVec3,
    radius: f64,
    [rows, columns]: [u32; 2],
    material: u32,
) {
    sheet(builder, [rows, columns], material, |i, j| {
        let (sin, cos) = libm::sincos(std::f64::consts::PI * f64::from(i) / f64::from(rows));
        let ring = if i == rows { 0.0 } else { radius * sin };
        let turn = f64::from(j % columns) / f64::from(columns);
        let (east, north) = libm::sincos(turn * std::f64::consts::TAU);
        middle + DVec3::new(ring * north, radius * cos, ring * east)
    });
}

pub fn ball(rows: u32) -> Mesh {
    shape(|builder| sphere(builder, DVec3::ZERO, 1.0, [rows, 2 * rows], 0))
}

pub fn one_box(low: [f32; 3], high: [f32; 3]) -> Mesh {
    shape(|builder| cuboid(builder, low, high, 0))
}

/// A square from (0, 0) to (1, 1), of so many cells a side, with a picture on it. Its corners are that share of the
/// picture inside.
pub fn card(picture: &RgbaImage, cells: u32, inside: f64, mtl: &str) -> Mesh {
    let mut png = Cursor::new(Vec::new());
    picture.write_to(&mut png, ImageFormat::Png).unwrap();
    let mtl = format!("newmtl a\n{mtl}\n").into_bytes();
    let files = HashMap::from([("a.mtl", mtl), ("a.png", png.into_inner())]);
    let files = files_of(|name| files.get(name).cloned());
    let mut obj = "mtllib a.mtl\nusemtl a\n".to_owned();
    for (i, j) in (0..cells * cells).map(|cell| (cell % cells, cell / cells)) {
        for [x, y] in [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]] {
            let [x, y] = [x, y].map(|c| f64::from(c) / f64::from(cells));
            let [u, v] = [x, y].map(|c| inside + c * (1.0 - 2.0 * inside));
            obj += &format!("v {x} {y} 0\nvt {u} {v}\n");
        }
        obj += "f -4/-4 -3/-3 -2/-2 -1/-1\n";
    }
    let (text, colors) = (obj.as_bytes(), ColorSpace::default());
    read(text, MeshFormat::Obj, "a.obj", &files, colors, &Silent).unwrap()
}

/// Files by a function of their name.
pub fn files_of(file: impl Fn(&str) -> Option<Vec<u8>>) -> impl Fn(&str) -> io::Result<Vec<u8>> {
    move |name| file(name).ok_or_else(|| io::ErrorKind::NotFound.into())
}

/// An opaque disc of a radius of 24 of 64 texels, and the opacity around it.
pub fn disc(around: u8) -> RgbaImage {
    RgbaImage::from_fn(64, 64, |x, y| {
        let [x, y] = [x, y].map(|c| f64::from(c) + 0.5 - 32.0);
        let alpha = if x * x + y * y < 576.0 { 255 } else { around };
        Rgba([255, 128, 0, alpha])
    })
}

/// The disc's share of the picture.
pub const DISC: f64 = std::f64::consts::PI * 0.375 * 0.375;

pub fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap().install(work)
}

#[track_caller]
pub fn has(text: impl Debug, parts: &[&str]) {
    let text = format!("{text:?}");
    for part in parts {
        assert!(text.contains(part), "expected {part}\n   found {text}");
    }
}
