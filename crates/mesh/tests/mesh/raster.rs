//! Triangles to pixels: light, ray casting, more samples.

use glam::{DVec2, DVec3};
use shiftvox::graph::Silent;
use shiftvox::split_mix::SplitMix;
use shiftvox_mesh::raster::{
    self, Light, NO_TRIANGLE, Pattern, RasterCamera, RasterOptions, RasterPicture, Samples,
};
use shiftvox_mesh::{Mesh, Surface};

use super::shared::{
    area, ball, looking, on_any_threads, one_box, plain, quad, shape, triangle, triangles,
};

fn view(eye: impl Into<DVec3>, target: impl Into<DVec3>, size: [u32; 2]) -> RasterCamera {
    looking(eye.into(), target.into(), size, f64::from(size[1]))
}

fn draw(mesh: &Mesh, view: &RasterCamera, options: &RasterOptions) -> RasterPicture {
    raster::draw(mesh, view, options, &Silent).unwrap()
}

#[test]
fn triangles_are_lit_like_voxels_on_both_sides() {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let square = shape(|builder| quad(builder, corners.map(|[x, y]| [x, y, 0.0]), 0));
    for (eye, towards, color) in [
        (DVec3::Z, DVec3::Z, [90, 120, 150, 255]),
        (DVec3::NEG_Z, DVec3::NEG_Z, [90, 120, 150, 255]),
        // At a right angle only the ambient quarter is left; 150 is 0.305 of the light.
        (DVec3::Z, DVec3::X, [44, 61, 78, 255]),
    ] {
        let light = Light {
            towards,
            ambient: 64,
        };
        let view = view(eye, DVec3::ZERO, [8, 8]);
        let picture = triangles(&square, &view, 1, Some(light), None);
        assert_eq!(picture.rgba[0], color, "{eye} {light:?}");
    }
}

#[test]
fn the_inside_of_a_room_has_no_gap() {
    // Corners are behind the eye, at the near plane and far outside the guard band.
    let room = one_box([-3.0, -1.0, -2.0], [4.0, 2.5, 5.0]);
    for (eye, target) in [
        ([0.1, 0.2, 0.3], [5.0, 0.3, -2.0]),
        // The wall is half a thousandth away.
        ([-2.9995, 0.0, 0.0], [-2.9, 1.0, 4.0]),
        ([3.0, 2.0, -1.0], [3.0, -4.0, -1.1]),
    ] {
        let view = RasterCamera {
            near: 1e-5,
            ..view(eye, target, [90, 70])
        };
        let picture = draw(&room, &view, &plain(16));
        assert!(picture.coverage.iter().all(|&c| c == 1.0), "{eye:?}");
        assert_eq!(against_rays(&room, &view), 0, "{eye:?}");
    }
}

/// Where a point before the eye is in the picture, in pixels.
fn seen(view: &RasterCamera, point: DVec3) -> DVec2 {
    let offset = point - view.eye;
    let slopes = DVec2::new(offset.dot(view.right), -offset.dot(view.up));
    let middle = DVec2::new(f64::from(view.width), f64::from(view.height)) / 2.0;
    middle + slopes / offset.dot(view.forward) * view.focal_px
}

/// The number of pixels where the rasteriser and a ray caster see different triangles or depths, unless an edge of
/// either triangle is near the sample.
pub(super) fn against_rays(mesh: &Mesh, view: &RasterCamera) -> usize {
    // The raster's lattice has 1/4096 of a pixel; the rest is single precision.
    const NEAR_PX: f64 = 0.005;
    let picture = draw(mesh, view, &plain(1));
    let corners: Vec<[DVec3; 3]> = (0..mesh.len()).map(|n| Surface::corners(mesh, n)).collect();
    let is_unexplained = |at: &usize| {
        let (x, y) = (*at as u32 % view.width, *at as u32 / view.width);
        let sample = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
        let (depth, cast) = cast(&corners, view, sample);
        let is_near = |t: u32| {
            t != NO_TRIANGLE && distance_to_edges(view, corners[t as usize], sample) < NEAR_PX
        };
        let other = f64::from(picture.depth[*at]);
        let is_same = depth == other || (depth - other).abs() < 2e-5 * other;
        !is_same && !is_near(cast) && !is_near(picture.triangle[*at])
    };
    (0..picture.depth.len()).filter(is_unexplained).count()
}

/// The depth at which the ray through a place of the picture meets the nearest triangle, and the triangle's number:
/// Moeller and Trumbore's test.
fn cast(triangles: &[[DVec3; 3]], view: &RasterCamera, at: DVec2) -> (f64, u32) {
    let slopes = (at - seen(view, view.eye + view.forward)) / view.focal_px;
    let direction = view.forward + view.right * slopes.x - view.up * slopes.y;
    let mut nearest = (f64::INFINITY, NO_TRIANGLE);
    for (number, &[a, b, c]) in triangles.iter().enumerate() {
        let (to_second, to_third, to_eye) = (b - a, c - a, view.eye - a);
        let across = direction.cross(to_third);
        let over = to_eye.cross(to_second);
        let [u, v, t] = [to_eye.dot(across), direction.dot(over), to_third.dot(over)]
            .map(|volume| volume / to_second.dot(across));
        if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= view.near && t < nearest.0 {
            nearest = (t, number as u32);
        }
    }
    nearest
}

/// Pixels from a sample to the nearest edge of a triangle in the picture.
fn distance_to_edges(view: &RasterCamera, corners: [DVec3; 3], sample: DVec2) -> f64 {
    let seen = corners.map(|corner| seen(view, corner));
    let distances = [0, 1, 2].map(|i| {
        let (a, along) = (seen[i], seen[(i + 1) % 3] - seen[i]);
        let t = ((sample - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        sample.distance(a + along * t)
    });
    distances.into_iter().fold(f64::INFINITY, f64::min)
}

#[test]
fn pictures_agree_with_ray_casting() {
    let mesh = ball(20);
    for i in 0..6 {
        let angle = f64::from(i);
        let eye = DVec3::new(angle.sin(), 0.4 * (angle * 3.0).cos(), angle.cos()) * (2.0 + angle);
        let view = view(eye, DVec3::ZERO, [96, 72]);
        assert_eq!(against_rays(&mesh, &view), 0, "{eye}");
    }
    // Random triangles cross each other.
    let mut dice = SplitMix::new(3);
    let mut random = || dice.unit() as f32 * 2.0 - 1.0;
    let mesh = shape(|builder| {
        for _ in 0..400 {
            let at = [random(), random(), random()];
            let corners = [0; 3].map(|_| at.map(|c| c + 0.3 * random()));
            triangle(builder, corners, 0);
        }
    });
    let view = view([0.5, 1.0, 4.0], DVec3::ZERO, [200, 200]);
    assert_eq!(against_rays(&mesh, &view), 0);
}

#[test]
fn more_samples_come_nearer_to_the_true_coverage() {
    let mesh = ball(20);
    let view = view([1.0, 0.7, 3.0], DVec3::ZERO, [120, 120]);
    let finest = draw(&mesh, &view, &plain(256)).coverage;
    let bias = |picture: &RasterPicture| (area(&picture.coverage) / area(&finest) - 1.0).abs();
    let mut last = f64::INFINITY;
    for per_pixel in [1, 4, 16] {
        let picture = draw(&mesh, &view, &plain(per_pixel));
        let pairs = picture.coverage.iter().zip(&finest);
        let error = pairs.map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / area(&finest);
        assert!(error < last / 2.0, "{per_pixel}: {error} after {last}");
        assert!(bias(&picture) < 0.002, "{per_pixel}");
        last = error;
    }
    assert!(last < 0.002, "{last}");
    // Random samples agree within chance. Their seed decides them.
    let [a, b, again] = [1, 2, 1].map(|seed| {
        let samples = Samples::new(16, Pattern::Stratified { seed }).unwrap();
        let options = RasterOptions {
            samples,
            ..plain(16)
        };
        draw(&mesh, &view, &options)
    });
    assert_eq!(a, again);
    assert_ne!(a.coverage, b.coverage);
    for picture in [a, b] {
        assert!(bias(&picture) < 0.001);
        let mut pairs = picture.coverage.iter().zip(&finest);
        assert!(pairs.all(|(x, y)| (x - y).abs() < 0.3));
    }
}

#[test]
fn threads_change_nothing_and_invalid_views_are_refused() {
    let mesh = ball(16);
    let view = view([1.0, 0.7, 2.0], DVec3::ZERO, [100, 75]);
    on_any_threads(|| draw(&mesh, &view, &plain(4)));
    let faults: [fn(&mut RasterCamera); 5] = [
        |view| view.width = 0,
        |view| view.height = 32769,
        |view| view.near = 0.0,
        |view| view.focal_px = f64::NAN,
        |view| view.eye = DVec3::NAN,
    ];
    for (number, fault) in faults.into_iter().enumerate() {
        let mut wrong = view;
        fault(&mut wrong);
        let drawn = raster::draw(&mesh, &wrong, &plain(1), &Silent);
        assert!(drawn.is_err(), "fault {number}");
    }
}
