//! Cameras that are hard on arithmetic.

use glam::DVec3;

use shiftvox::project::Camera;
use shiftvox::split_mix::SplitMix;

/// The standard viewpoints of a cube of `2^depth` voxels, in pictures of `pixels` per side, and `random` more: camera
/// and shift.
pub(super) fn viewpoints(
    depth: u32,
    pixels: u32,
    random: u32,
    numbers: &mut SplitMix,
) -> Vec<(Camera, i64)> {
    let side = (1u64 << depth) as f64;
    let v = DVec3::new;
    let middle = DVec3::splat(side / 2.0);
    let direction = v(1.0, -0.9, 0.6).normalize();
    let outside = middle + direction * side * 1.7;
    // A place on the lattice near the middle, and off it.
    let lattice = DVec3::splat((side / 2.0).floor());
    let odd = v(0.37, 0.41, 0.46) * side;
    // The cube's diagonal is half a pixel: it covers one pixel or none.
    let slope = libm::tan(30f64.to_radians());
    let one_pixel = middle + direction * (side * f64::from(pixels) / slope);
    let far = middle + direction * side * 60.0;
    let near = middle + direction * side;
    let front = v(side / 2.0, -side, side / 2.0);
    let grazing = [
        v(-0.3 * side, 0.4 * side, side + 0.013),
        v(side, 0.5 * side, side * 0.999),
    ];
    let face = lattice + v(0.0, 0.3, 0.6);
    let centre = lattice + DVec3::splat(0.5);
    let corner = v(side, side, side * 0.9);
    let mut views = vec![
        (outside, middle, 60.0, 0),
        (front, middle, 60.0, 0),
        (grazing[0], grazing[1], 60.0, 0),
        // On a voxel's face, on a corner, and at a voxel's centre.
        (face, lattice + v(3.0, 1.0, 0.5), 70.0, 0),
        (lattice, corner, 80.0, 0),
        (centre, lattice + v(0.5, 2.5, 0.5), 90.0, 0),
        // Inside.
        (odd, v(0.1, 0.9, 0.3) * side, 90.0, 0),
        (one_pixel, middle, 60.0, 0),
        (far, middle, 1.0, 0),
        (near, middle, 170.0, 0),
        (odd, middle, 170.0, 0),
        (outside, middle, 60.0, 1_000_000_007),
        (outside, middle, 60.0, -1_000_000_000_039),
    ];
    for _ in 0..random {
        let mut point = |low: f64, high: f64| {
            DVec3::from_array([0; 3].map(|_| low + (high - low) * numbers.unit()))
        };
        let (eye, target) = (point(-1.2, 2.2) * side, point(0.0, 1.0) * side);
        views.push((eye, target, 20.0 + 100.0 * numbers.unit(), 0));
    }
    let viewpoint = |(eye, target, fov_degrees, shift): (DVec3, DVec3, _, _)| {
        let forward = target - eye;
        let is_vertical = forward.x.abs() + forward.y.abs() < 1e-3 * forward.length();
        let camera = Camera {
            up: if is_vertical { DVec3::Y } else { DVec3::Z },
            ..Camera::looking(eye, target, fov_degrees, (pixels, pixels))
        };
        (camera, shift)
    };
    views.into_iter().map(viewpoint).collect()
}
