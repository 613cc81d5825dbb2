//! Triangles that belong to large objects (Wagner et al. 2007, Fig. 3b: parts of large objects stay opaque).
//!
//! Triangles that share corners are one object. It is large at a level if it is closed and longer than two nodes, or
//! open and longer than sixteen.

use rayon::prelude::*;

use super::Grid;
use super::distinct::hash_of;
use super::walk::Cube;
use crate::Surface;
use crate::geometry::Sets;

const LEAST_CLOSED: i64 = 2;
const LEAST_OPEN: i64 = 16;

/// By triangle, the coarsest level at which it is part of a large object; one more than there are where it never is.
pub(super) fn coarsest_levels(
    surface: &dyn Surface,
    grid: &Grid,
    numbers: &[u32],
    cube: Cube,
) -> Vec<u8> {
    let triangles = joined_corners(surface, grid, numbers);
    let count = triangles.iter().flatten().max().map_or(0, |&most| most + 1);
    let mut objects = Sets::new(count);
    for &[a, b, c] in &triangles {
        objects.join(a, b);
        objects.join(b, c);
    }
    let mut spans = vec![[[i64::MAX; 3], [i64::MIN; 3]]; count as usize];
    for (&number, &[corner, ..]) in numbers.iter().zip(&triangles) {
        let [low, high] = &mut spans[objects.root(corner) as usize];
        for point in grid.corners(surface, number) {
            for k in 0..3 {
                low[k] = low[k].min(point[k]);
                high[k] = high[k].max(point[k]);
            }
        }
    }
    let mut is_open = vec![false; count as usize];
    for corner in open_edges(&triangles) {
        is_open[objects.root(corner) as usize] = true;
    }
    let mut levels = vec![cube.depth as u8 + 1; surface.len()];
    for (&number, &[corner, ..]) in numbers.iter().zip(&triangles) {
        let root = objects.root(corner) as usize;
        let [low, high] = spans[root];
        let length = (0..3).map(|k| high[k] - low[k]).fold(0, i64::max);
        let least = if is_open[root] {
            LEAST_OPEN
        } else {
            LEAST_CLOSED
        };
        let is_short = |&level: &u32| least * cube.side(level) > length;
        levels[number as usize] = (0..=cube.depth).take_while(is_short).count() as u8;
    }
    levels
}

fn joined_corners(surface: &dyn Surface, grid: &Grid, numbers: &[u32]) -> Vec<[u32; 3]> {
    let mut corners: Vec<(u64, u64)> = numbers
        .par_iter()
        .enumerate()
        .flat_map_iter(|(place, &number)| {
            let points = grid.corners(surface, number);
            (0..3).map(move |k| (hash_of(&points[k]), 3 * place as u64 + k as u64))
        })
        .collect();
    corners.par_sort_unstable();
    let mut triangles = vec![[0; 3]; numbers.len()];
    for (joined, equal) in corners.chunk_by(|a, b| a.0 == b.0).enumerate() {
        for &(_, at) in equal {
            triangles[at as usize / 3][at as usize % 3] = joined as u32;
        }
    }
    triangles
}

/// One corner of each edge that an odd number of different triangles have.
fn open_edges(triangles: &[[u32; 3]]) -> Vec<u32> {
    // A leaf that is there twice, once for each side, is no closed body.
    let mut distinct = triangles.to_vec();
    distinct
        .par_iter_mut()
        .for_each(|corners| corners.sort_unstable());
    distinct.par_sort_unstable();
    distinct.dedup();
    let mut edges: Vec<[u32; 2]> = distinct
        .par_iter()
        .flat_map_iter(|&[a, b, c]| [[a, b], [b, c], [a, c]])
        .collect();
    edges.par_sort_unstable();
    let of_one_side = edges
        .chunk_by(|a, b| a == b)
        .filter(|alike| alike.len() % 2 == 1);
    of_one_side.map(|alike| alike[0][0]).collect()
}
