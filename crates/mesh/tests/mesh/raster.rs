//! Triangles to pixels, against ray casting.

use glam::{DVec2, DVec3};
use shiftvox::graph::Silent;
use shiftvox::split_mix::SplitMix;
use shiftvox_mesh::raster::{self, RasterCamera, RasterOptions, RasterPicture};
use shiftvox_mesh::{Material, Mesh, Surface};

use super::shared::{ball, looking, mesh_of, on_threads, one_box, plain, quad, shape};

fn view(eye: impl Into<DVec3>, target: impl Into<DVec3>, size: [u32; 2]) -> RasterCamera {
    looking(eye.into(), target.into(), size, f64::from(size[1]))
}

fn draw(mesh: &Mesh, view: &RasterCamera, options: &RasterOptions) -> RasterPicture {
    raster::draw(mesh, view, options, &Silent).unwrap()
}

/// Compares depths with those of a ray caster. Where they differ, a ray nearby has that of the picture.
fn check_depths(mesh: &Mesh, view: &RasterCamera) {
    // The raster's lattice has 1/4096 of a pixel; the rest is single precision.
    const NEAR_PX: f64 = 0.005;
    let around = [-1.0, 0.0, 1.0].map(|x| [-1.0, 0.0, 1.0].map(|y| DVec2::new(x, y) * NEAR_PX));
    let picture = draw(mesh, view, &plain(1));
    let corners: Vec<[DVec3; 3]> = (0..mesh.len()).map(|n| Surface::corners(mesh, n)).collect();
    for (at, &depth) in picture.depth.iter().enumerate() {
        let [x, y] = [at as u32 % view.width, at as u32 / view.width].map(f64::from);
        let size = DVec2::new(view.width.into(), view.height.into());
        let sample = DVec2::new(x, y) + 0.5 - size / 2.0;
        let depth = f64::from(depth);
        let is_same = |offset: &DVec2| {
            let cast = cast(&corners, view, (sample + *offset) / view.focal_px);
            cast == depth || (cast - depth).abs() < 2e-5 * depth
        };
        let is_explained = is_same(&DVec2::ZERO) || around.as_flattened().iter().any(is_same);
        assert!(is_explained, "{x}, {y} from {}", view.eye);
    }
}

/// The depth at which a ray meets the nearest triangle: Moeller and Trumbore's test.
fn cast(triangles: &[[DVec3; 3]], view: &RasterCamera, slopes: DVec2) -> f64 {
    let direction = view.forward + view.right * slopes.x - view.up * slopes.y;
    let depths = triangles.iter().map(|&[a, b, c]| {
        let (to_second, to_third, to_eye) = (b - a, c - a, view.eye - a);
        let across = direction.cross(to_third);
        let over = to_eye.cross(to_second);
        let [u, v, t] = [to_eye.dot(across), direction.dot(over), to_third.dot(over)]
            .map(|volume| volume / to_second.dot(across));
        let is_hit = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= view.near;
        if is_hit { t } else { f64::INFINITY }
    });
    depths.fold(f64::INFINITY, f64::min)
}

#[test]
fn pictures_agree_with_ray_casting() {
    for angle in [0.0, 1.0, 2.0, 3.0, 4.0, 5.0f64] {
        let eye = DVec3::new(angle.sin(), 0.4 * (angle * 3.0).cos(), angle.cos()) * (2.0 + angle);
        check_depths(&ball(20), &view(eye, DVec3::ZERO, [96, 72]));
    }
    // Random triangles cross each other.
    let mut dice = SplitMix::new(3);
    let mut random = || dice.unit() as f32 * 2.0 - 1.0;
    let mesh = mesh_of((0..400).map(|_| {
        let at = [random(), random(), random()];
        [0; 3].map(|_| at.map(|c| c + 0.3 * random()))
    }));
    check_depths(&mesh, &view([0.5, 1.0, 4.0], DVec3::ZERO, [200, 200]));
    // A room has no gap. Corners are behind the eye, at the near plane and far outside the guard band.
    let room = one_box([-3.0, -1.0, -2.0], [4.0, 2.5, 5.0]);
    for (eye, target) in [
        ([0.1, 0.2, 0.3], [5.0, 0.3, -2.0]),
        // The wall is half a thousandth away.
        ([-2.9995, 0.0, 0.0], [-2.9, 1.0, 4.0]),
        ([3.0, 2.0, -1.0], [3.0, -4.0, -1.1]),
    ] {
        let mut view = view(eye, target, [90, 70]);
        view.near = 1e-5;
        let picture = draw(&room, &view, &plain(16));
        assert!(picture.coverage.iter().all(|&c| c == 1.0), "{eye:?}");
        check_depths(&room, &view);
    }
}

/// A red square, after the same in blue, from behind and with the other diagonal. One coordinate is rounded differently.
fn two_sided(alpha: f32, far: f32) -> Mesh {
    shape(|builder| {
        let [red, blue] = [[255, 0, 0], [0, 0, 255]].map(|color| {
            let mut material = Material::of_srgb("side", color);
            material.alpha = alpha;
            builder.material(material)
        });
        let square = |top: f32| {
            let corners = [
                [0.11, 0.0, 0.07],
                [1.37, 0.0, 0.83],
                [1.37, 1.3, 0.83],
                [0.11, top, 0.07],
            ];
            corners.map(|[x, y, z]: [f32; 3]| [x + far, y, z])
        };
        let [a, b, c, d] = square(1.3f32.next_up());
        quad(builder, [d, c, b, a], blue);
        quad(builder, square(1.3), red);
    })
}

#[test]
fn of_two_faces_at_one_place_the_one_towards_the_eye_is_seen() {
    for (alpha, far) in [(1.0, 0.0), (0.5, 0.0), (1.0, 10.0), (0.5, 10.0)] {
        let mesh = two_sided(alpha, far);
        let middle = DVec3::new(0.74 + f64::from(far), 0.65, 0.45);
        for (eye, color) in [
            ([-2.0, 0.7, 3.3], [255, 0, 0]),
            ([2.0, 0.3, -3.0], [0, 0, 255]),
        ] {
            for (side, samples) in [(7, 1), (64, 1), (64, 16), (200, 4)] {
                let view = view(middle + DVec3::from(eye), middle, [side; 2]);
                let picture = draw(&mesh, &view, &plain(samples));
                let seen = picture.rgba.iter().filter(|pixel| pixel[3] > 0);
                assert!(seen.clone().count() > 0);
                assert!(
                    seen.clone().all(|pixel| pixel[..3] == color),
                    "{alpha} {far} {eye:?} {side}"
                );
                assert!(picture.coverage.iter().all(|&c| c <= alpha));
            }
        }
    }
    // A hair's breadth is a distance, also from afar.
    let mesh = shape(|builder| {
        let [red, blue] = [[255, 0, 0], [0, 0, 255]];
        let [red, blue] = [red, blue].map(|c| builder.material(Material::of_srgb("side", c)));
        let square = |z: f32| [[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]];
        quad(builder, square(0.0), red);
        let [a, b, c, d] = square(1e-6);
        quad(builder, [d, c, b, a], blue);
    });
    let mut view = view([0.5, 0.5, 4000.0], [0.5, 0.5, 0.0], [20; 2]);
    view.focal_px *= 4000.0;
    let picture = draw(&mesh, &view, &plain(1));
    assert!(picture.rgba.iter().all(|&pixel| pixel == [0, 0, 255, 255]));
}

#[test]
fn threads_change_nothing_and_invalid_views_are_refused() {
    let mesh = ball(16);
    let view = view([1.0, 0.7, 2.0], DVec3::ZERO, [100, 75]);
    let [one, three] = [1, 3].map(|n| on_threads(n, || draw(&mesh, &view, &plain(4))));
    assert!(one == three);
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
