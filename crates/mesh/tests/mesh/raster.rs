//! Triangles to pixels: known answers, no cracks, ray casting, more samples.

use glam::{DVec2, DVec3};
use proptest::prelude::*;
use shiftvox::graph::Silent;
use shiftvox::split_mix::SplitMix;
use shiftvox_mesh::raster::{
    self, Light, NO_TRIANGLE, Pattern, RasterCamera, RasterOptions, RasterPicture, Samples,
};
use shiftvox_mesh::{Mesh, MeshBuilder, Surface};

use super::shapes::{ball, cuboid, mesh_of, point, soup};
use super::shared::{area, looking, on_threads};

fn view(eye: DVec3, target: DVec3, size: [u32; 2]) -> RasterCamera {
    looking(eye, target, size, f64::from(size[1]))
}

/// A square of side 2 in the plane z = 0.
fn square(right: f32) -> Mesh {
    let corners = [[-1.0, -1.0], [right, -1.0], [right, 1.0], [-1.0, 1.0]];
    mesh_of(&corners.map(|[x, y]| [x, y, 0.0]), &[[0, 1, 2], [0, 2, 3]])
}

fn plain(per_pixel: u32) -> RasterOptions {
    RasterOptions {
        samples: Samples::new(per_pixel, Pattern::Regular).unwrap(),
        light: None,
        background: None,
    }
}

fn draw<S: Surface>(surface: &S, view: &RasterCamera, options: &RasterOptions) -> RasterPicture {
    raster::draw(surface, view, options, &Silent).unwrap()
}

/// One unit of the plane z = 0 is `64` pixels, and the origin is the middle of the picture.
fn facing() -> RasterCamera {
    view(DVec3::Z, DVec3::ZERO, [64, 64])
}

#[test]
fn coverage_of_halves_and_quarters() {
    // The left half of pixel (32, 31), and its lower half beyond that.
    let px = 1.0 / 64.0;
    let half = square(0.5 * px);
    for (per_pixel, expected) in [(1, 0.0), (4, 0.5), (16, 0.5), (256, 0.5)] {
        let picture = draw(&half, &facing(), &plain(per_pixel));
        let at = |x: usize, y: usize| picture.coverage[y * 64 + x];
        assert_eq!(at(31, 31), 1.0);
        assert_eq!(at(33, 31), 0.0);
        // One sample lies on the right edge, which is not the triangle's.
        assert_eq!(at(32, 31), expected, "{per_pixel}");
        assert_eq!(picture.depth[31 * 64 + 31], 1.0);
        assert_eq!(picture.depth[31 * 64 + 33], f32::INFINITY);
        assert_eq!(picture.rgba[31 * 64 + 31], [90, 120, 150, 255]);
    }
}

#[test]
fn light_is_that_of_voxels() {
    let square = square(1.0);
    let mut options = plain(1);
    // From the front in full; from behind, the other side is seen: full too.
    for eye in [DVec3::Z, DVec3::NEG_Z] {
        options.light = Some(Light {
            towards: eye,
            ambient: 64,
        });
        let picture = draw(&square, &view(eye, DVec3::ZERO, [8, 8]), &options);
        assert_eq!(picture.rgba[0], [90, 120, 150, 255]);
    }
    // At a right angle only the ambient quarter is left: 150 is 0.305 of the light.
    options.light = Some(Light {
        towards: DVec3::X,
        ambient: 64,
    });
    let picture = draw(&square, &view(DVec3::Z, DVec3::ZERO, [8, 8]), &options);
    assert_eq!(picture.rgba[0][2], 78);
}

#[test]
fn inside_a_room_there_is_no_gap() {
    // Corners behind the eye, at the near plane, far outside the guard band.
    let room = cuboid([-3.0, -1.0, -2.0], [4.0, 2.5, 5.0]);
    for (eye, target) in [
        (DVec3::new(0.1, 0.2, 0.3), DVec3::new(5.0, 0.3, -2.0)),
        (DVec3::new(-2.9995, 0.0, 0.0), DVec3::new(-2.9, 1.0, 4.0)),
        (DVec3::new(3.0, 2.0, -1.0), DVec3::new(3.0, -4.0, -1.1)),
    ] {
        for per_pixel in [1, 16] {
            // The wall is half a thousandth away.
            let view = RasterCamera {
                near: 1e-5,
                ..view(eye, target, [90, 70])
            };
            let picture = draw(&room, &view, &plain(per_pixel));
            assert!(picture.coverage.iter().all(|&c| c == 1.0), "{eye}");
            // Each pixel's depth is the room's wall along its ray.
            for (i, &depth) in picture.depth.iter().enumerate().filter(|_| per_pixel == 1) {
                let ray = ray_of(&view, i as f64 % 90.0 + 0.5, f64::from(i as u32 / 90) + 0.5);
                let (low, high) = Surface::bounds(&room);
                let exit = (0..3)
                    .map(|k| ((if ray[k] > 0.0 { high[k] } else { low[k] }) - eye[k]) / ray[k])
                    .fold(f64::INFINITY, f64::min);
                assert!(
                    (f64::from(depth) - exit).abs() < 1e-5 * exit + 1e-7,
                    "{i}: {depth} {exit}"
                );
            }
        }
    }
}

/// The ray through a place of the picture, one unit deep.
fn ray_of(view: &RasterCamera, x: f64, y: f64) -> DVec3 {
    view.forward
        + view.right * ((x - f64::from(view.width) / 2.0) / view.focal_px)
        + view.up * ((f64::from(view.height) / 2.0 - y) / view.focal_px)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// A bent and torn net of triangles, seen from near and far, drawn as a
    /// whole and triangle by triangle: each sample belongs to one triangle.
    #[test]
    fn neighbours_leave_no_crack_and_share_no_sample(
        bends in prop::collection::vec((-0.4f32..0.4, -0.4f32..0.4, -0.3f32..0.3), 36),
        eye in (-1.5f64..1.5, -1.5f64..1.5, 0.6f64..9.0),
    ) {
        let inner = |i: usize| (1..5).contains(&i);
        let mut positions = Vec::new();
        for row in 0..6usize {
            for column in 0..6usize {
                let (dx, dy, dz) = bends[row * 6 + column];
                let (dx, dy) = if inner(row) && inner(column) { (dx, dy) } else { (0.0, 0.0) };
                positions.push([column as f32 - 2.5 + dx, row as f32 - 2.5 + dy, dz]);
            }
        }
        let mut triangles = Vec::new();
        for row in 0..5u32 {
            for column in 0..5u32 {
                let a = row * 6 + column;
                triangles.extend([[a, a + 1, a + 7], [a, a + 7, a + 6]]);
            }
        }
        let net = mesh_of(&positions, &triangles);
        let view = view(DVec3::new(eye.0, eye.1, eye.2), DVec3::new(0.0, 0.1, 0.0), [40, 40]);
        let options = plain(16);
        let whole = draw(&net, &view, &options);
        let mut sum = vec![0.0f32; 1600];
        for &triangle in &triangles {
            let single = mesh_of(&positions, &[triangle]);
            let part = draw(&single, &view, &options);
            for (sum, coverage) in sum.iter_mut().zip(&part.coverage) {
                *sum += coverage;
            }
        }
        // The net is one over the plane, seen from above, unless it folds on the picture.
        let folds = soup(&net).iter().any(|t| {
            let [a, b, c] = t.map(point);
            (b - a).cross(c - a).dot(view.eye - a) <= 0.0
        });
        for (i, (&whole, &sum)) in whole.coverage.iter().zip(&sum).enumerate() {
            if folds {
                prop_assert!(whole <= sum);
            } else {
                prop_assert_eq!(whole, sum, "pixel {}", i);
            }
        }
    }
}

/// How many pixels the rasteriser and the ray caster see differently, without an edge of either triangle within
/// `near_px` of the sample, and with different depths.
pub(super) fn against_rays(mesh: &Mesh, view: &RasterCamera, near_px: f64) -> usize {
    let picture = draw(mesh, view, &plain(1));
    let soup = soup(mesh);
    let cast = cast(&soup, view);
    let is_unexplained = |at: &usize| {
        let (x, y) = (*at as u32 % view.width, *at as u32 / view.width);
        let sample = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let (depth, cast) = cast[*at];
        let drawn = picture.triangle[*at];
        let is_near = |t: u32| {
            t != NO_TRIANGLE
                && distance_to_edges(view, soup[t as usize].map(point), sample) < near_px
        };
        // The ray's direction is one unit deep: its length is the depth.
        let other = f64::from(picture.depth[*at]);
        let same_depth = (depth - other).abs() < 2e-5 * other;
        cast != drawn && !is_near(cast) && !is_near(drawn) && !same_depth
    };
    (0..cast.len()).filter(is_unexplained).count()
}

/// By pixel, the distance along the ray through its middle, in lengths of the ray's direction, at which it meets the
/// nearest triangle, and which one that is: Moeller and Trumbore's test in `f64`, of each triangle with each ray that
/// passes its box in the picture.
fn cast(soup: &[[[f32; 3]; 3]], view: &RasterCamera) -> Vec<(f64, u32)> {
    let (width, height) = (view.width as usize, view.height as usize);
    let mut nearest = vec![(f64::INFINITY, NO_TRIANGLE); width * height];
    for (number, corners) in soup.iter().enumerate() {
        let corners = corners.map(|corner| point(corner) - view.eye);
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for corner in corners {
            let depth = corner.dot(view.forward);
            let slopes = DVec2::new(corner.dot(view.right), -corner.dot(view.up)) / depth;
            let at = slopes * view.focal_px + DVec2::new(width as f64, height as f64) / 2.0;
            (low, high) = match depth > view.near {
                true => (low.min(at), high.max(at)),
                false => (DVec2::NEG_INFINITY, DVec2::INFINITY),
            };
        }
        let range = |low: f64, high: f64, end: usize| {
            (low - 1.0).max(0.0) as usize..((high + 2.0).max(0.0) as usize).min(end)
        };
        let (to_second, to_third) = (corners[1] - corners[0], corners[2] - corners[0]);
        for y in range(low.y, high.y, height) {
            for x in range(low.x, high.x, width) {
                let direction = ray_of(view, x as f64 + 0.5, y as f64 + 0.5);
                let across = direction.cross(to_third);
                let scale = to_second.dot(across);
                let over = (-corners[0]).cross(to_second);
                let u = (-corners[0]).dot(across) / scale;
                let v = direction.dot(over) / scale;
                let t = to_third.dot(over) / scale;
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
    let seen = corners.map(|corner| {
        let offset = corner - view.eye;
        let depth = offset.dot(view.forward);
        DVec2::new(
            f64::from(view.width) / 2.0 + offset.dot(view.right) / depth * view.focal_px,
            f64::from(view.height) / 2.0 - offset.dot(view.up) / depth * view.focal_px,
        )
    });
    (0..3)
        .map(|i| {
            let (a, b) = (seen[i], seen[(i + 1) % 3]);
            let along = b - a;
            let t = ((sample - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            sample.distance(a + along * t)
        })
        .fold(f64::INFINITY, f64::min)
}

/// Pixels from an edge within which a ray caster in 32 bits may see another
/// triangle: the raster's lattice has 1/4096 pixel, the rest is `f32`.
pub(super) const NEAR_PX: f64 = 0.005;

#[test]
fn the_picture_is_that_of_ray_casting() {
    let mesh = ball(20);
    for i in 0..6 {
        let angle = f64::from(i);
        let eye = DVec3::new(angle.sin(), 0.4 * (angle * 3.0).cos(), angle.cos()) * (2.0 + angle);
        let view = view(eye, DVec3::ZERO, [160, 120]);
        assert_eq!(against_rays(&mesh, &view, NEAR_PX), 0, "{eye}");
    }
    // Random triangles through each other.
    let mut dice = SplitMix::new(3);
    let mut random = || dice.unit() as f32 * 2.0 - 1.0;
    let mut builder = MeshBuilder::new();
    for _ in 0..400 {
        let at = [random(), random(), random()];
        let corners =
            [0, 1, 2].map(|_| builder.position([0, 1, 2].map(|k| at[k] + 0.3 * random())));
        builder.triangle(corners, None, 0).unwrap();
    }
    let mesh = builder.finish("random").unwrap();
    let view = view(DVec3::new(0.5, 1.0, 4.0), DVec3::ZERO, [200, 200]);
    assert_eq!(against_rays(&mesh, &view, NEAR_PX), 0);
}

#[test]
fn more_samples_agree_with_each_other() {
    let mesh = ball(20);
    let view = view(DVec3::new(1.0, 0.7, 3.0), DVec3::ZERO, [120, 120]);
    let finest = draw(&mesh, &view, &plain(256));
    let area = |picture: &RasterPicture| area(&picture.coverage);
    let mut last = f64::INFINITY;
    for per_pixel in [1, 4, 16] {
        let picture = draw(&mesh, &view, &plain(per_pixel));
        let pairs = picture.coverage.iter().zip(&finest.coverage);
        let error = pairs.map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / area(&finest);
        assert!(error < last / 2.0, "{per_pixel}: {error} after {last}");
        assert!(
            (area(&picture) / area(&finest) - 1.0).abs() < 0.002,
            "{per_pixel}"
        );
        last = error;
    }
    assert!(last < 0.002, "{last}");
    // Samples at random: the same to within chance, other for another seed, the same for the same.
    let stratified = |seed| RasterOptions {
        samples: Samples::new(16, Pattern::Stratified { seed }).unwrap(),
        ..plain(16)
    };
    let [a, b, again] = [1, 2, 1].map(|seed| draw(&mesh, &view, &stratified(seed)));
    assert_eq!(a, again);
    assert_ne!(a.coverage, b.coverage);
    for picture in [&a, &b] {
        assert!((area(picture) / area(&finest) - 1.0).abs() < 0.001);
        for (i, (x, y)) in picture.coverage.iter().zip(&finest.coverage).enumerate() {
            assert!((x - y).abs() < 0.3, "pixel {i}: {x} {y}");
        }
    }
}

#[test]
fn threads_change_nothing_and_wrong_views_are_refused() {
    let mesh = ball(16);
    let view = view(DVec3::new(1.0, 0.7, 2.0), DVec3::ZERO, [100, 75]);
    let [one, three] = [1, 3].map(|n| on_threads(n, || draw(&mesh, &view, &plain(4))));
    assert_eq!(one, three);
    for wrong in [
        RasterCamera { width: 0, ..view },
        RasterCamera {
            height: 32769,
            ..view
        },
        RasterCamera { near: 0.0, ..view },
        RasterCamera {
            focal_px: f64::NAN,
            ..view
        },
        RasterCamera {
            eye: DVec3::NAN,
            ..view
        },
    ] {
        assert!(raster::draw(&mesh, &wrong, &plain(1), &Silent).is_err());
    }
}
