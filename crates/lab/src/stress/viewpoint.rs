//! Cameras that are hard on arithmetic.

use glam::DVec3;

use shiftvox::project::Camera;
use shiftvox::split_mix::SplitMix;

/// A camera by name.
#[derive(Debug, Clone, PartialEq)]
pub struct Viewpoint {
    /// Its name.
    pub name: &'static str,
    /// The camera, in finest voxels from the object's lowest corner.
    pub camera: Camera,
    /// How far object and camera are from the world's origin, voxels.
    pub shift: i64,
}

/// The standard viewpoints of a cube of `2^depth` voxels, in pictures of
/// `pixels` a side, and `random` more that follow from `numbers`.
#[must_use]
pub fn viewpoints(depth: u32, pixels: u32, random: u32, numbers: &mut SplitMix) -> Vec<Viewpoint> {
    let side = (1u64 << depth) as f64;
    let middle = DVec3::splat(side / 2.0);
    let view = |name, eye: DVec3, target: DVec3, fov_degrees, shift| {
        let forward = target - eye;
        let up = if forward.x.abs() + forward.y.abs() < 1e-3 * forward.length() {
            DVec3::Y
        } else {
            DVec3::Z
        };
        Viewpoint {
            name,
            camera: Camera {
                eye,
                target,
                up,
                fov_degrees,
                width: pixels,
                height: pixels,
            },
            shift,
        }
    };
    let direction = DVec3::new(1.0, -0.9, 0.6).normalize();
    let outside = middle + direction * side * 1.7;
    let grazing = DVec3::new(-0.3 * side, 0.4 * side, side + 0.013);
    // A place on the lattice near the middle, and off it.
    let lattice = DVec3::splat((side / 2.0).floor());
    let odd = DVec3::new(0.37, 0.41, 0.46) * side;
    // The cube's diagonal is half a pixel: seen, it is one pixel or none.
    let slope = libm::tan(30f64.to_radians());
    let one_pixel = side * f64::from(pixels) / slope;
    let mut views = vec![
        view("outside", outside, middle, 60.0, 0),
        view(
            "in front",
            DVec3::new(side / 2.0, -side, side / 2.0),
            middle,
            60.0,
            0,
        ),
        view(
            "grazing",
            grazing,
            DVec3::new(side, 0.5 * side, side * 0.999),
            60.0,
            0,
        ),
        view(
            "on a voxel face",
            lattice + DVec3::new(0.0, 0.3, 0.6),
            lattice + DVec3::new(3.0, 1.0, 0.5),
            70.0,
            0,
        ),
        view(
            "on a corner",
            lattice,
            DVec3::new(side, side, side * 0.9),
            80.0,
            0,
        ),
        view(
            "at a voxel's centre",
            lattice + DVec3::splat(0.5),
            lattice + DVec3::new(0.5, 2.5, 0.5),
            90.0,
            0,
        ),
        view("inside", odd, DVec3::new(0.1, 0.9, 0.3) * side, 90.0, 0),
        view("one pixel", middle + direction * one_pixel, middle, 60.0, 0),
        view("1 degree", middle + direction * side * 60.0, middle, 1.0, 0),
        view("170 degrees", middle + direction * side, middle, 170.0, 0),
        view("170 degrees inside", odd, middle, 170.0, 0),
        view("shifted 10^9", outside, middle, 60.0, 1_000_000_007),
        view("shifted 10^12", outside, middle, 60.0, -1_000_000_000_039),
    ];
    for _ in 0..random {
        let mut point = |low: f64, high: f64| {
            DVec3::from_array([0; 3].map(|_| low + (high - low) * numbers.unit()))
        };
        let eye = point(-1.2, 2.2) * side;
        let target = point(0.0, 1.0) * side;
        views.push(view(
            "random",
            eye,
            target,
            20.0 + 100.0 * numbers.unit(),
            0,
        ));
    }
    views
}
