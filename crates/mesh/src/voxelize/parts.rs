//! Triangles that belong to large objects.
//!
//! Triangles that share corners are one object. An object is large at a level of the tree if it is closed and longer
//! than two nodes, or open and longer than sixteen. Such a surface crosses several nodes. (Wagner et al. 2007, Fig. 3b:
//! parts of large objects stay opaque.)

use rayon::prelude::*;

use super::Grid;
use crate::Surface;
use crate::geometry::Sets;
use shiftvox::split_mix::mix;

/// Least length of a large object, sides of nodes: of a closed one, and of one with an edge where it ends.
const LEAST_CLOSED: i64 = 2;
const LEAST_OPEN: i64 = 16;

/// By number of a triangle, the coarsest level at which it is part of a large object; more than there are levels where
/// it never is. `sides`: of a node, by level, on the lattice.
pub(super) fn coarsest_levels<S: Surface + ?Sized>(
    surface: &S,
    grid: &Grid,
    numbers: &[u32],
    sides: &[i64],
) -> Vec<u8> {
    let triangles = joined_corners(surface, grid, numbers);
    let count = triangles.iter().flatten().max().map_or(0, |&most| most + 1);
    let mut objects = Sets::new(count);
    for &[a, b, c] in &triangles {
        objects.join(a, b);
        objects.join(b, c);
    }
    let mut spans = vec![Span::default(); count as usize];
    for (&number, &[corner, ..]) in numbers.iter().zip(&triangles) {
        let root = objects.root(corner);
        for point in grid.corners(surface, number) {
            spans[root as usize].add(point);
        }
    }
    for corner in open_edges(&triangles) {
        let root = objects.root(corner);
        spans[root as usize].is_open = true;
    }
    // No more than 20 levels.
    let mut levels = vec![sides.len() as u8; surface.len()];
    for (&number, &[corner, ..]) in numbers.iter().zip(&triangles) {
        let root = objects.root(corner);
        levels[number as usize] = spans[root as usize].coarsest(sides);
    }
    levels
}

/// The corners of triangles as numbers that are equal where the corners are.
fn joined_corners<S: Surface + ?Sized>(surface: &S, grid: &Grid, numbers: &[u32]) -> Vec<[u32; 3]> {
    let mut corners: Vec<(u64, u64)> = numbers
        .par_iter()
        .enumerate()
        .flat_map_iter(|(place, &number)| {
            let hash = |point: [i64; 3]| point.iter().fold(0, |hash, &c| mix(hash ^ c as u64));
            let points = grid.corners(surface, number);
            (0..3).map(move |k| (hash(points[k]), 3 * place as u64 + k as u64))
        })
        .collect();
    corners.par_sort_unstable();
    let mut triangles = vec![[0; 3]; numbers.len()];
    let (mut joined, mut last) = (0, None);
    for (hash, at) in corners {
        if last.is_some_and(|last| last != hash) {
            joined += 1;
        }
        last = Some(hash);
        triangles[at as usize / 3][at as usize % 3] = joined;
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

/// How far an object reaches on the lattice, and whether it ends anywhere.
#[derive(Debug, Clone)]
struct Span {
    low: [i64; 3],
    high: [i64; 3],
    is_open: bool,
}

impl Default for Span {
    fn default() -> Self {
        Self {
            low: [i64::MAX; 3],
            high: [i64::MIN; 3],
            is_open: false,
        }
    }
}

impl Span {
    fn add(&mut self, point: [i64; 3]) {
        for k in 0..3 {
            self.low[k] = self.low[k].min(point[k]);
            self.high[k] = self.high[k].max(point[k]);
        }
    }

    fn coarsest(&self, sides: &[i64]) -> u8 {
        let length = (0..3)
            .map(|k| self.high[k] - self.low[k])
            .max()
            .unwrap_or(0);
        let least = if self.is_open {
            LEAST_OPEN
        } else {
            LEAST_CLOSED
        };
        let is_short = |side: &&i64| least * **side > length;
        sides.iter().take_while(is_short).count() as u8
    }
}
