//! The way down from a cube to its voxels, with the triangles that touch each.

use rayon::prelude::*;

use super::Grid;
use super::touch::{Prepared, child};
use crate::Surface;
use shiftvox::graph::Progress;

const SUBTREE_LEVELS: u32 = 5;
const BATCH_SUBTREES: usize = 512;
const BATCH_TRIANGLES: usize = 1 << 18;
const PROGRESS_LEVEL: u32 = 4;

#[derive(Debug, Clone, Copy)]
pub(super) struct Cube {
    pub(super) corner: [i64; 3],
    pub(super) voxel: i64,
    pub(super) depth: u32,
}

impl Cube {
    pub(super) fn side(&self, level: u32) -> i64 {
        self.voxel << (self.depth - level)
    }
}

pub(super) struct Subtree<'w> {
    pub(super) numbers: &'w [u32],
    pub(super) prepared: Vec<Prepared>,
    corner: [i64; 3],
    level: u32,
}

impl Subtree<'_> {
    /// Visits each voxel, in Morton order: the places in [`Subtree::numbers`] of its triangles, and its corner.
    pub(super) fn leaves(&self, cube: Cube, mut visit: impl FnMut(&[u32], [i64; 3])) {
        let mut list = (0..self.numbers.len() as u32).collect();
        self.node(cube, &mut list, 0, self.corner, self.level, &mut visit);
    }

    /// A node whose triangles are those from `begin` to the list's end.
    fn node(
        &self,
        cube: Cube,
        list: &mut Vec<u32>,
        begin: usize,
        corner: [i64; 3],
        level: u32,
        visit: &mut impl FnMut(&[u32], [i64; 3]),
    ) {
        if level == cube.depth {
            visit(&list[begin..], corner);
            return;
        }
        let half = cube.side(level + 1);
        let end = list.len();
        for octant in 0..8u8 {
            let at = child(corner, half, octant);
            for i in begin..end {
                let triangle = list[i];
                if self.prepared[triangle as usize].touches(at, half) {
                    list.push(triangle);
                }
            }
            if list.len() > end {
                self.node(cube, list, end, at, level + 1, visit);
                list.truncate(end);
            }
        }
    }
}

/// Finds the subtrees of a cube from the root down, does them on all threads and hands on their results in Morton order.
pub(super) fn walk<T: Send>(
    surface: &dyn Surface,
    grid: &Grid,
    cube: Cube,
    numbers: Vec<u32>,
    of_subtree: &(dyn Fn(Subtree<'_>) -> T + Sync),
    sink: &mut dyn FnMut(T),
    (name, progress): (&str, &dyn Progress),
) {
    let mut walk = Walk {
        cube,
        prepare: &|number| Prepared::new(grid.corners(surface, number)),
        of_subtree,
        sink,
        progress,
        batch: Vec::new(),
        batch_triangles: 0,
    };
    progress.begin(name, 1 << (3 * PROGRESS_LEVEL));
    walk.node(numbers, cube.corner, 0);
    walk.flush();
    progress.end();
}

struct Walk<'w, T> {
    cube: Cube,
    prepare: &'w (dyn Fn(u32) -> Prepared + Sync),
    of_subtree: &'w (dyn Fn(Subtree<'_>) -> T + Sync),
    sink: &'w mut dyn FnMut(T),
    progress: &'w dyn Progress,
    batch: Vec<(Vec<u32>, [i64; 3], u32)>,
    batch_triangles: usize,
}

impl<T: Send> Walk<'_, T> {
    fn node(&mut self, triangles: Vec<u32>, corner: [i64; 3], level: u32) {
        let is_leaf = self.cube.depth - level <= SUBTREE_LEVELS || triangles.is_empty();
        if is_leaf && !triangles.is_empty() {
            self.batch_triangles += triangles.len();
            self.batch.push((triangles, corner, level));
            if self.batch.len() >= BATCH_SUBTREES || self.batch_triangles >= BATCH_TRIANGLES {
                self.flush();
            }
        } else if !is_leaf {
            self.children(&triangles, corner, level);
        }
        // Each node of the level is counted once, those below it not at all.
        if level == PROGRESS_LEVEL || is_leaf && level < PROGRESS_LEVEL {
            self.progress.advance(1 << (3 * (PROGRESS_LEVEL - level)));
        }
    }

    fn children(&mut self, triangles: &[u32], corner: [i64; 3], level: u32) {
        let half = self.cube.side(level + 1);
        let prepare = self.prepare;
        let mask = |&number: &u32| prepare(number).children(corner, half);
        let masks: Vec<u8> = triangles.par_iter().map(mask).collect();
        for octant in 0..8u8 {
            let touching = triangles
                .iter()
                .zip(&masks)
                .filter(|(_, mask)| **mask >> octant & 1 == 1)
                .map(|(number, _)| *number)
                .collect();
            self.node(touching, child(corner, half, octant), level + 1);
        }
    }

    fn flush(&mut self) {
        let (prepare, of_subtree) = (self.prepare, self.of_subtree);
        let subtree = |&(ref numbers, corner, level): &(Vec<u32>, [i64; 3], u32)| {
            of_subtree(Subtree {
                numbers,
                prepared: numbers.iter().map(|&number| prepare(number)).collect(),
                corner,
                level,
            })
        };
        let done: Vec<T> = self.batch.par_iter().map(subtree).collect();
        self.batch.clear();
        self.batch_triangles = 0;
        done.into_iter().for_each(&mut *self.sink);
    }
}
