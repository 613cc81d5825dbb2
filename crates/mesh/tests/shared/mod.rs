//! Cameras, pictures of reference and simple meshes that several test crates use.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "each test crate uses a part of it"
)]

use std::path::PathBuf;

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox_mesh::raster::{
    self, Light, Pattern, RasterCamera, RasterOptions, RasterPicture, Samples,
};
use shiftvox_mesh::{Mesh, MeshBuilder, Surface};

/// A camera at `eye` that looks at `target`; a length of 1 at a distance of 1 is `focal_px` pixels.
pub fn looking(
    eye: DVec3,
    target: DVec3,
    [width, height]: [u32; 2],
    focal_px: f64,
) -> RasterCamera {
    let forward = (target - eye).normalize();
    let helper = match forward.y.abs() > 0.99 {
        true => DVec3::X,
        false => DVec3::Y,
    };
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

/// A view in which the bounds of a mesh fill about `size` pixels, from `distance` of its sizes away.
pub fn around(mesh: &Mesh, towards: DVec3, distance: f64, size: u32) -> RasterCamera {
    let (low, high) = Surface::bounds(mesh);
    let (middle, side) = ((low + high) / 2.0, (high - low).length());
    let eye = middle + towards.normalize() * side * distance;
    looking(eye, middle, [size; 2], f64::from(size) * distance)
}

/// Directions spread over the sphere.
pub fn directions(count: u32) -> impl Iterator<Item = DVec3> {
    (0..count).map(move |i| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
        let ring = libm::sqrt(1.0 - z * z);
        let (sin, cos) = libm::sincos(f64::from(i) * 2.399_963_229_728_653);
        DVec3::new(ring * cos, ring * sin, z)
    })
}

/// The triangles of a surface, drawn with a regular pattern of samples.
pub fn triangles<S: Surface + ?Sized>(
    surface: &S,
    view: &RasterCamera,
    samples: u32,
    light: Option<Light>,
    background: Option<[u8; 3]>,
) -> RasterPicture {
    let options = RasterOptions {
        samples: Samples::new(samples, Pattern::Regular).unwrap(),
        light,
        background,
    };
    raster::draw(surface, view, &options, &Silent).unwrap()
}

/// The sum of a picture's coverage, in pixels.
pub fn area(coverage: &[f32]) -> f64 {
    coverage.iter().map(|&share| f64::from(share)).sum()
}

/// Root mean square difference of the red, green and blue bytes of two pictures, after a conversion of each byte.
pub fn difference(a: &[[u8; 4]], b: &[[u8; 4]], value: impl Fn(u8) -> f64) -> f64 {
    let square = |(a, b): (&[u8; 4], &[u8; 4])| -> f64 {
        (0..3).map(|k| (value(a[k]) - value(b[k])).powi(2)).sum()
    };
    let sum: f64 = a.iter().zip(b).map(square).sum();
    (sum / (3 * a.len()) as f64).sqrt()
}

/// Adds a box to a mesh, two triangles per face.
pub fn cuboid(builder: &mut MeshBuilder, low: [f32; 3], high: [f32; 3], material: u32) {
    let corners: Vec<u32> = (0..8)
        .map(|i| {
            let pick = |k: usize| if i >> k & 1 == 1 { high[k] } else { low[k] };
            builder.position([pick(0), pick(1), pick(2)])
        })
        .collect();
    for face in [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ] {
        quad(builder, face.map(|i: usize| corners[i]), material);
    }
}

/// Adds two triangles.
pub fn quad(builder: &mut MeshBuilder, [a, b, c, d]: [u32; 4], material: u32) {
    for triangle in [[a, b, c], [a, c, d]] {
        builder.triangle(triangle, None, material).unwrap();
    }
}

/// Runs work on a number of threads.
pub fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap().install(work)
}

/// A model of the shared data, which `SHIFTVOX_DATA` names.
pub fn model(name: &str) -> PathBuf {
    let folder = std::env::var_os("SHIFTVOX_DATA").expect("SHIFTVOX_DATA names the shared data");
    PathBuf::from(folder).join("mesh").join(name)
}
