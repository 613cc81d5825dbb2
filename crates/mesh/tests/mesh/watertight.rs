//! Triangles that share edges share no sample and leave none between them, also where edges run through samples.

use glam::DVec3;
use proptest::prelude::*;

use super::shared::{looking, mesh_of, triangles as drawn};

/// Pixels along a side of the picture.
const SIDE: i32 = 40;
/// Steps of a vertex in a pixel: samples of 1, 4 and 16 per pixel lie on this lattice.
const STEPS: i32 = 8;

/// A point of the lattice, right and down.
type Point = [i32; 2];

fn area([a, b, c]: [Point; 3]) -> i32 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Triangles that tile a rectangle: two, then each point within one cuts that into three.
fn tiling(low: Point, high: Point, points: &[(Point, bool, usize)]) -> Vec<[Point; 3]> {
    let [a, b, c, d] = [low, [high[0], low[1]], high, [low[0], high[1]]];
    let mut triangles = vec![[a, b, c], [a, c, d]];
    let mut known = vec![a, b, c, d];
    for &(mut point, is_level, pick) in points {
        if is_level {
            // The height of a known vertex makes horizontal edges.
            point[1] = known[pick % known.len()][1];
        }
        let is_within = |&[a, b, c]: &[Point; 3]| {
            let sign = area([a, b, c]).signum();
            let parts = [[a, b, point], [b, c, point], [c, a, point]];
            parts.iter().all(|&part| area(part).signum() == sign)
        };
        if let Some(at) = triangles.iter().position(is_within) {
            let [a, b, c] = triangles.swap_remove(at);
            // Both orders of corners.
            triangles.extend([[a, b, point], [c, b, point], [c, a, point]]);
            known.push(point);
        }
    }
    triangles
}

/// The number of each pixel's samples that see a triangle. A unit is a picture's side, so that vertices are exactly on
/// the lattice.
fn covered(part: &[[Point; 3]], per_pixel: u32) -> Vec<u32> {
    let place = |point: Point| {
        let [x, y] = point.map(|c| (c - SIDE * STEPS / 2) as f32 / (SIDE * STEPS) as f32);
        [x, -y, 0.0]
    };
    let mesh = mesh_of(part.iter().map(|corners| corners.map(place)));
    let view = looking(DVec3::Z, DVec3::ZERO, [SIDE as u32; 2], f64::from(SIDE));
    let picture = drawn(&mesh, &view, per_pixel, None);
    let samples = |&share: &f32| (share * per_pixel as f32).round() as u32;
    picture.coverage.iter().map(samples).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Tiles have the samples of their rectangle, which includes its left and upper side: all drawn together, and added
    /// up over each drawn alone.
    #[test]
    fn tiles_of_a_rectangle_cover_each_sample_once(
        low in prop::array::uniform2(1..12 * STEPS),
        high in prop::array::uniform2(24 * STEPS..SIDE * STEPS),
        points in prop::collection::vec((prop::array::uniform2(0..SIDE * STEPS), any::<bool>(), 0..64usize), 0..12),
    ) {
        let triangles = tiling(low, high, &points);
        for (across, per_pixel) in [(1, 1), (2, 4), (4, 16)] {
            let along = |pixel: i32, k: usize| {
                // Samples are the middles of squares.
                let at = |sample: i32| pixel * STEPS + (2 * sample + 1) * STEPS / (2 * across);
                let own = (0..across).filter(|&s| (low[k]..high[k]).contains(&at(s)));
                own.count() as u32
            };
            let expected = (0..SIDE * SIDE).map(|pixel| along(pixel % SIDE, 0) * along(pixel / SIDE, 1));
            let expected: Vec<u32> = expected.collect();
            prop_assert!(covered(&triangles, per_pixel) == expected, "{}: {:?}", per_pixel, triangles);
            let mut sum = vec![0; expected.len()];
            for alone in triangles.chunks(1) {
                let alone = covered(alone, per_pixel);
                sum.iter_mut().zip(alone).for_each(|(sum, n)| *sum += n);
            }
            prop_assert!(sum == expected, "{}, one by one: {:?}", per_pixel, triangles);
        }
    }
}
