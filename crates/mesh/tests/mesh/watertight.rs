//! Triangles that share edges share no sample and leave none between them, also where edges run through samples.

use glam::DVec3;
use proptest::prelude::*;
use shiftvox::graph::Silent;
use shiftvox_mesh::Mesh;
use shiftvox_mesh::raster::{self, Pattern, RasterCamera, RasterOptions, Samples};

use super::shapes::mesh_of;

/// Pixels along a side of the picture.
const SIDE: i32 = 40;
/// Steps of a vertex in a pixel: samples of 1, 4 and 16 a pixel lie on this lattice.
const STEPS: i32 = 8;

/// A point of the lattice, right and down.
type Point = [i32; 2];

/// Twice the area of a triangle, with its sign.
fn area([a, b, c]: [Point; 3]) -> i32 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Triangles that tile a rectangle: two, then each point that falls within one cuts that into three.
fn tiling(low: Point, high: Point, points: &[(Point, bool, usize)]) -> Vec<[Point; 3]> {
    let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
    let mut triangles = vec![
        [corners[0], corners[1], corners[2]],
        [corners[0], corners[2], corners[3]],
    ];
    let mut known = corners.to_vec();
    for &(mut point, is_level, pick) in points {
        if is_level {
            // As high as a vertex that is there: makes horizontal edges.
            point[1] = known[pick % known.len()][1];
        }
        let is_within = |&[a, b, c]: &[Point; 3]| {
            let sign = area([a, b, c]).signum();
            [[a, b, point], [b, c, point], [c, a, point]]
                .iter()
                .all(|&part| area(part).signum() == sign)
        };
        let Some(at) = triangles.iter().position(is_within) else {
            continue;
        };
        let [a, b, c] = triangles.swap_remove(at);
        // Both ways around.
        triangles.extend([[a, b, point], [c, b, point], [c, a, point]]);
        known.push(point);
    }
    triangles
}

/// As a mesh before a camera for which a unit is a picture's side, so that the lattice is hit exactly.
fn mesh(triangles: &[[Point; 3]]) -> Mesh {
    let middle = SIDE * STEPS / 2;
    let place = |[x, y]: Point| {
        let scale = (SIDE * STEPS) as f32;
        [
            (x - middle) as f32 / scale,
            (middle - y) as f32 / scale,
            0.0,
        ]
    };
    let positions: Vec<[f32; 3]> = triangles.iter().flatten().map(|&p| place(p)).collect();
    let numbers: Vec<[u32; 3]> = (0..triangles.len() as u32)
        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
        .collect();
    mesh_of(&positions, &numbers)
}

/// The share of each pixel's samples that see anything, times their number.
fn covered(mesh: &Mesh, per_pixel: u32) -> Vec<u32> {
    let view = RasterCamera {
        eye: DVec3::Z,
        right: DVec3::X,
        up: DVec3::Y,
        forward: DVec3::NEG_Z,
        focal_px: f64::from(SIDE),
        width: SIDE as u32,
        height: SIDE as u32,
        near: 1e-3,
    };
    let options = RasterOptions {
        samples: Samples::new(per_pixel, Pattern::Regular).unwrap(),
        light: None,
        background: None,
    };
    let picture = raster::draw(mesh, &view, &options, &Silent).unwrap();
    let samples = |&share: &f32| (share * per_pixel as f32).round() as u32;
    picture.coverage.iter().map(samples).collect()
}

/// How many samples of each pixel lie in a rectangle, its left and upper side counted in.
fn expected(low: Point, high: Point, per_pixel: u32) -> Vec<u32> {
    let across = per_pixel.isqrt() as i32;
    // Samples in the middles of squares: an odd number of half squares, in steps.
    let along = |pixel: i32, k: usize| {
        let at = |sample: i32| pixel * STEPS + (2 * sample + 1) * STEPS / (2 * across);
        (0..across)
            .filter(|&s| (low[k]..high[k]).contains(&at(s)))
            .count() as u32
    };
    (0..SIDE * SIDE)
        .map(|pixel| along(pixel % SIDE, 0) * along(pixel / SIDE, 1))
        .collect()
}

fn check(low: Point, high: Point, points: &[(Point, bool, usize)]) {
    let triangles = tiling(low, high, points);
    let all = mesh(&triangles);
    for per_pixel in [1, 4, 16] {
        let expected = expected(low, high, per_pixel);
        // Together they leave no sample out, each alone they count none twice.
        assert_eq!(
            covered(&all, per_pixel),
            expected,
            "{per_pixel}: {triangles:?}"
        );
        let mut sum = vec![0; expected.len()];
        for triangle in &triangles {
            let alone = covered(&mesh(&[*triangle]), per_pixel);
            sum.iter_mut().zip(alone).for_each(|(sum, n)| *sum += n);
        }
        assert_eq!(sum, expected, "{per_pixel}, one by one: {triangles:?}");
    }
}

#[test]
fn a_level_edge_through_samples_is_one_triangles_own() {
    // Through the middles of pixels, and through those of their halves.
    for y in [
        20 * STEPS + STEPS / 2,
        20 * STEPS + STEPS / 4,
        20 * STEPS + STEPS / 8,
    ] {
        let (low, high) = ([4 * STEPS, 3 * STEPS], [35 * STEPS, y]);
        check(low, high, &[]);
        check(
            low,
            [high[0], 38 * STEPS],
            &[([9 * STEPS, y], false, 0), ([30 * STEPS, y], false, 0)],
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn triangles_that_tile_a_rectangle_cover_each_sample_once(
        low in prop::array::uniform2(1..12 * STEPS),
        high in prop::array::uniform2(24 * STEPS..SIDE * STEPS),
        points in prop::collection::vec((prop::array::uniform2(0..SIDE * STEPS), any::<bool>(), 0..64usize), 0..12),
    ) {
        check(low, high, &points);
    }
}
