//! Triangles that share edges share no sample and leave none between them, also where edges run through samples.

use glam::DVec3;
use proptest::prelude::*;
use shiftvox_mesh::raster::RasterCamera;
use shiftvox_mesh::{Mesh, Surface};

use super::shared::{looking, shape, triangle, triangles};

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

/// Triangles in the square from -0.5 to 0.5, each point at some height.
fn mesh(triangles: &[[Point; 3]], height: impl Fn(Point) -> f32) -> Mesh {
    let place = |point: Point| {
        let [x, y] = point.map(|c| (c - SIDE * STEPS / 2) as f32 / (SIDE * STEPS) as f32);
        [x, -y, height(point)]
    };
    shape(|builder| {
        for corners in triangles {
            triangle(builder, corners.map(place), 0);
        }
    })
}

/// The number of each pixel's samples that see a triangle.
fn covered(mesh: &Mesh, view: &RasterCamera, per_pixel: u32) -> Vec<u32> {
    let picture = triangles(mesh, view, per_pixel, None, None);
    let samples = |&share: &f32| (share * per_pixel as f32).round() as u32;
    picture.coverage.iter().map(samples).collect()
}

/// The samples of all triangles, drawn one by one.
fn one_by_one(
    triangles: &[[Point; 3]],
    height: impl Fn(Point) -> f32,
    view: &RasterCamera,
    per_pixel: u32,
) -> Vec<u32> {
    let mut sum = vec![0; (SIDE * SIDE) as usize];
    for &triangle in triangles {
        let alone = covered(&mesh(&[triangle], &height), view, per_pixel);
        sum.iter_mut().zip(alone).for_each(|(sum, n)| *sum += n);
    }
    sum
}

/// Compares tiles in the plane with the samples of their rectangle, which includes its left and upper side. A unit is
/// a picture's side, so that vertices are exactly on the lattice.
fn check(low: Point, high: Point, points: &[(Point, bool, usize)]) {
    let triangles = tiling(low, high, points);
    let view = looking(DVec3::Z, DVec3::ZERO, [SIDE as u32; 2], f64::from(SIDE));
    for (across, per_pixel) in [(1, 1), (2, 4), (4, 16)] {
        let along = |pixel: i32, k: usize| {
            // Samples are the middles of squares.
            let at = |sample: i32| pixel * STEPS + (2 * sample + 1) * STEPS / (2 * across);
            let own = (0..across).filter(|&s| (low[k]..high[k]).contains(&at(s)));
            own.count() as u32
        };
        let pixels = 0..SIDE * SIDE;
        let expected: Vec<u32> = pixels
            .map(|pixel| along(pixel % SIDE, 0) * along(pixel / SIDE, 1))
            .collect();
        let whole = covered(&mesh(&triangles, |_| 0.0), &view, per_pixel);
        assert_eq!(whole, expected, "{per_pixel}: {triangles:?}");
        let sum = one_by_one(&triangles, |_| 0.0, &view, per_pixel);
        assert_eq!(sum, expected, "{per_pixel}, one by one: {triangles:?}");
    }
}

#[test]
fn a_level_edge_through_samples_belongs_to_one_triangle() {
    // Through the middles of pixels, of their halves and of their quarters.
    for part in [2, 4, 8] {
        let y = 20 * STEPS + STEPS / part;
        let low = [4 * STEPS, 3 * STEPS];
        check(low, [35 * STEPS, y], &[]);
        let points = [9, 30].map(|x| ([x * STEPS, y], false, 0));
        check(low, [35 * STEPS, 38 * STEPS], &points);
    }
}

fn random_points() -> impl Strategy<Value = Vec<(Point, bool, usize)>> {
    let point = prop::array::uniform2(0..SIDE * STEPS);
    prop::collection::vec((point, any::<bool>(), 0..64usize), 0..12)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn tiles_of_a_rectangle_cover_each_sample_once(
        low in prop::array::uniform2(1..12 * STEPS),
        high in prop::array::uniform2(24 * STEPS..SIDE * STEPS),
        points in random_points(),
    ) {
        check(low, high, &points);
    }

    /// Each sample of a bent surface belongs to one triangle, unless the surface folds in the picture.
    #[test]
    fn neighbours_leave_no_crack_and_share_no_sample(
        points in random_points(),
        heights in prop::collection::vec(-0.06f32..0.06, 17),
        [x, y, z] in [-0.3f64..0.3, -0.3f64..0.3, 0.12f64..1.8],
    ) {
        let mut triangles = tiling([0; 2], [SIDE * STEPS; 2], &points);
        for corners in &mut triangles {
            // All the same way around.
            if area(*corners) > 0 {
                corners.swap(1, 2);
            }
        }
        let height = |[x, y]: Point| heights[(3 * x + y) as usize % heights.len()];
        let view = looking(DVec3::new(x, y, z), DVec3::new(0.0, 0.02, 0.0), [SIDE as u32; 2], f64::from(SIDE));
        let all = mesh(&triangles, height);
        let folds = (0..triangles.len()).any(|number| {
            let [a, b, c] = Surface::corners(&all, number);
            (b - a).cross(c - a).dot(view.eye - a) <= 0.0
        });
        let whole = covered(&all, &view, 16);
        let sum = one_by_one(&triangles, height, &view, 16);
        if folds {
            prop_assert!(whole.iter().zip(&sum).all(|(whole, sum)| whole <= sum));
        } else {
            prop_assert_eq!(whole, sum);
        }
    }
}
