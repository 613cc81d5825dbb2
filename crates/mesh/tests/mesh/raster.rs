//! Triangles to pixels: known answers, ray casting, more samples.

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

fn view(eye: DVec3, target: DVec3, size: [u32; 2]) -> RasterCamera {
    looking(eye, target, size, f64::from(size[1]))
}

/// The rectangle from x = -1 to `right` and y = -1 to 1 in the plane z = 0.
fn rectangle(right: f32) -> Mesh {
    let corners = [[-1.0, -1.0], [right, -1.0], [right, 1.0], [-1.0, 1.0]];
    shape(|builder| quad(builder, corners.map(|[x, y]| [x, y, 0.0]), 0))
}

fn draw<S: Surface>(surface: &S, view: &RasterCamera, options: &RasterOptions) -> RasterPicture {
    raster::draw(surface, view, options, &Silent).unwrap()
}

#[test]
fn half_a_pixel_is_half_covered() {
    // One unit is 64 pixels, and the origin is the middle of the picture.
    let facing = view(DVec3::Z, DVec3::ZERO, [64, 64]);
    // The left half of pixel (32, 31).
    let half = rectangle(0.5 / 64.0);
    // The one sample lies on the right edge, which does not belong to the triangle.
    for (per_pixel, expected) in [(1, 0.0), (4, 0.5), (16, 0.5), (256, 0.5)] {
        let picture = draw(&half, &facing, &plain(per_pixel));
        let row = 31 * 64;
        let coverage = [31, 32, 33].map(|x| picture.coverage[row + x]);
        assert_eq!(coverage, [1.0, expected, 0.0], "{per_pixel}");
        let depth = [31, 33].map(|x| picture.depth[row + x]);
        assert_eq!(depth, [1.0, f32::INFINITY]);
        assert_eq!(picture.rgba[row + 31], [90, 120, 150, 255]);
    }
}

#[test]
fn triangles_are_lit_like_voxels() {
    for (eye, light, blue) in [
        (DVec3::Z, DVec3::Z, 150),
        // From behind, the other side is seen.
        (DVec3::NEG_Z, DVec3::NEG_Z, 150),
        // At a right angle only the ambient quarter is left; 150 is 0.305 of the light.
        (DVec3::Z, DVec3::X, 78),
    ] {
        let light = Light {
            towards: light,
            ambient: 64,
        };
        let view = view(eye, DVec3::ZERO, [8, 8]);
        let picture = triangles(&rectangle(1.0), &view, 1, Some(light), None);
        assert_eq!(picture.rgba[0][2], blue, "{eye} {light:?}");
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
            ..view(eye.into(), target.into(), [90, 70])
        };
        for per_pixel in [1, 16] {
            let picture = draw(&room, &view, &plain(per_pixel));
            assert!(picture.coverage.iter().all(|&c| c == 1.0), "{eye:?}");
        }
        assert_eq!(against_rays(&room, &view), 0, "{eye:?}");
    }
}

/// The ray through a place of the picture, one unit deep.
fn ray_of(view: &RasterCamera, x: f64, y: f64) -> DVec3 {
    view.forward
        + view.right * ((x - f64::from(view.width) / 2.0) / view.focal_px)
        + view.up * ((f64::from(view.height) / 2.0 - y) / view.focal_px)
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
    let cast = cast(&corners, view);
    let is_unexplained = |at: &usize| {
        let (x, y) = (*at as u32 % view.width, *at as u32 / view.width);
        let sample = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let (depth, cast) = cast[*at];
        let is_near = |t: u32| {
            t != NO_TRIANGLE && distance_to_edges(view, corners[t as usize], sample) < NEAR_PX
        };
        let other = f64::from(picture.depth[*at]);
        let is_same = depth == other || (depth - other).abs() < 2e-5 * other;
        !is_same && !is_near(cast) && !is_near(picture.triangle[*at])
    };
    (0..cast.len()).filter(is_unexplained).count()
}

/// By pixel, the depth at which the ray through its middle meets the nearest triangle, and the triangle's number:
/// Moeller and Trumbore's test for each ray that passes a triangle's box in the picture.
fn cast(triangles: &[[DVec3; 3]], view: &RasterCamera) -> Vec<(f64, u32)> {
    let (width, height) = (view.width as usize, view.height as usize);
    let mut nearest = vec![(f64::INFINITY, NO_TRIANGLE); width * height];
    for (number, &[a, b, c]) in triangles.iter().enumerate() {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for corner in [a, b, c] {
            let is_before = (corner - view.eye).dot(view.forward) > view.near;
            let at = seen(view, corner);
            low = low.min(if is_before { at } else { DVec2::NEG_INFINITY });
            high = high.max(if is_before { at } else { DVec2::INFINITY });
        }
        let range = |low: f64, high: f64, end: usize| {
            (low - 1.0).max(0.0) as usize..((high + 2.0).max(0.0) as usize).min(end)
        };
        let (to_second, to_third, to_eye) = (b - a, c - a, view.eye - a);
        for y in range(low.y, high.y, height) {
            for x in range(low.x, high.x, width) {
                let direction = ray_of(view, x as f64 + 0.5, y as f64 + 0.5);
                let across = direction.cross(to_third);
                let over = to_eye.cross(to_second);
                let [u, v, t] = [to_eye.dot(across), direction.dot(over), to_third.dot(over)]
                    .map(|volume| volume / to_second.dot(across));
                let best = &mut nearest[y * width + x];
                if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= view.near && t < best.0 {
                    *best = (t, number as u32);
                }
            }
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
        let view = view(eye, DVec3::ZERO, [160, 120]);
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
    let view = view(DVec3::new(0.5, 1.0, 4.0), DVec3::ZERO, [200, 200]);
    assert_eq!(against_rays(&mesh, &view), 0);
}

#[test]
fn more_samples_come_nearer_to_the_true_coverage() {
    let mesh = ball(20);
    let view = view(DVec3::new(1.0, 0.7, 3.0), DVec3::ZERO, [120, 120]);
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
    let stratified = |seed| RasterOptions {
        samples: Samples::new(16, Pattern::Stratified { seed }).unwrap(),
        ..plain(16)
    };
    let [a, b, again] = [1, 2, 1].map(|seed| draw(&mesh, &view, &stratified(seed)));
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
    let view = view(DVec3::new(1.0, 0.7, 2.0), DVec3::ZERO, [100, 75]);
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
