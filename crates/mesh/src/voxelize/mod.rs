//! Triangles to voxels: every voxel whose closed cube a triangle touches.
//!
//! Corners are rounded to a lattice of 2^30 points a side, the same for all
//! triangles, so that neighbours stay joined. On the lattice a triangle and a
//! cube are distinguished exactly, in integers: there is no tolerance, a thin
//! triangle loses no voxel and a closed mesh has no hole. The cubes of the
//! octree are descended with the triangles that touch them. Work is cut into
//! subtrees of 32 voxels a side, some at a time; memory grows with the
//! triangles and not with the voxels. Rules: `spec/mesh.md`.

mod columns;
mod coverage;
mod distinct;
mod grid;
mod mix;
mod opacity;
mod parts;
mod subtree;
mod touch;

use rayon::prelude::*;

pub use grid::{DEFAULT_DEPTH, Grid, GridError, MAX_DEPTH, MOST_LOOKED_AT};
pub use opacity::opacities;

use super::Surface;
use distinct::Distinct;
use shiftvox::graph::{Progress, Voxel};
use subtree::Subtree;
pub(crate) use touch::{Prepared, child};

/// Levels of a subtree that one thread does at a time.
const SUBTREE_LEVELS: u32 = 5;
/// Subtrees that are done between two calls of the sink, at the most.
const BATCH_SUBTREES: usize = 512;
/// Triangles of those subtrees together, after which no more are added.
const BATCH_TRIANGLES: usize = 1 << 18;
/// Level whose nodes the progress counts.
const PROGRESS_LEVEL: u32 = 4;

/// Counts of one voxelisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct VoxelizeReport {
    /// Voxels handed on, each once.
    pub voxels: u64,
    /// Pairs of a voxel and a triangle that touches it.
    pub touches: u64,
    /// Of these the pairs that were looked at: of equal triangles one.
    pub looked_at: u64,
}

/// Hands every voxel that a triangle touches to `sink`, once, in Morton order.
///
/// The same voxels in the same order on any number of threads. Indices run
/// from 0 to `2^depth - 1`.
pub fn voxelize<S: Surface + ?Sized>(
    surface: &S,
    grid: &Grid,
    sink: &mut dyn FnMut(Voxel),
    progress: &dyn Progress,
) -> VoxelizeReport {
    let mut distinct = Distinct::of(surface, grid);
    let all = std::mem::take(&mut distinct.numbers);
    let mut voxelizer = Voxelizer {
        surface,
        grid,
        distinct: &distinct,
        sink,
        progress,
        batch: Vec::new(),
        batch_triangles: 0,
        report: VoxelizeReport::default(),
    };
    progress.begin("voxelise", 1 << (3 * PROGRESS_LEVEL));
    voxelizer.node(all, [0; 3], 0);
    voxelizer.flush();
    progress.end();
    voxelizer.report
}

/// Pairs of a voxel and a triangle that touches it: as many as this or more.
///
/// Of each triangle as many as its area, or its longest side, is faces of voxels. Equal triangles count each, but as one
/// where there are more than [`MOST_LOOKED_AT`] pairs.
pub fn least_looked_at<S: Surface + ?Sized>(surface: &S, grid: &Grid) -> u64 {
    let side = grid.side(grid.depth()) as f64;
    let least = |number: u32| {
        let prepared = Prepared::new(grid.corners(surface, number));
        let largest = |of: [i64; 3]| of.iter().fold(0.0f64, |most, &c| most.max(c.abs() as f64));
        let area = largest(prepared.normal) / (2.0 * side * side);
        let length = largest(std::array::from_fn(|k| prepared.high[k] - prepared.low[k])) / side;
        area.max(length).max(1.0) as u64
    };
    let sum = |numbers: &[u32]| numbers.par_iter().map(|&number| least(number)).sum::<u64>();
    let all: Vec<u32> = (0..surface.len() as u32).collect();
    match sum(&all) {
        few if few <= MOST_LOOKED_AT => few,
        // Of equal ones one is looked at.
        _ => sum(&Distinct::of(surface, grid).numbers),
    }
}

/// Finds the subtrees, from the root down, and voxelises them in batches.
struct Voxelizer<'w, S: ?Sized> {
    surface: &'w S,
    grid: &'w Grid,
    distinct: &'w Distinct,
    sink: &'w mut dyn FnMut(Voxel),
    progress: &'w dyn Progress,
    batch: Vec<Subtree>,
    batch_triangles: usize,
    report: VoxelizeReport,
}

impl<S: Surface + ?Sized> Voxelizer<'_, S> {
    /// A node with the triangles that touch it; its corner on the lattice.
    fn node(&mut self, triangles: Vec<u32>, corner: [i64; 3], level: u32) {
        let is_leaf = self.grid.depth() - level <= SUBTREE_LEVELS || triangles.is_empty();
        if is_leaf && !triangles.is_empty() {
            self.batch_triangles += triangles.len();
            self.batch.push(Subtree {
                triangles,
                corner,
                level,
            });
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
        let half = self.grid.side(level + 1);
        let masks: Vec<u8> = triangles
            .par_iter()
            .map(|&number| {
                let prepared = Prepared::new(self.grid.corners(self.surface, number));
                prepared.children(corner, half)
            })
            .collect();
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

    /// Does the subtrees that were gathered and hands on their voxels.
    fn flush(&mut self) {
        let (surface, grid, distinct) = (self.surface, self.grid, self.distinct);
        let done: Vec<(Vec<Voxel>, VoxelizeReport)> = self
            .batch
            .par_iter()
            .map(|subtree| subtree.voxels(surface, grid, distinct))
            .collect();
        self.batch.clear();
        self.batch_triangles = 0;
        for (voxels, report) in done {
            self.report.voxels += report.voxels;
            self.report.touches += report.touches;
            self.report.looked_at += report.looked_at;
            for voxel in voxels {
                (self.sink)(voxel);
            }
        }
    }
}
