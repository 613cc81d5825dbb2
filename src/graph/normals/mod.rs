//! Normals of voxels that have none, from the surface around them.
//!
//! Each voxel's 5 x 5 x 5 neighbourhood is a heap of mass (weights 1 2 2 2 1 along each axis). Where the heap lies to
//! one side of the voxel or fills most of the neighbourhood, the normal points away from its centre of mass. In a thin
//! wall it is the least axis of the heap's covariance, turned away from the middle of the object. Lone and covered
//! voxels have none.
//!
//! The unit of work is a cluster of 4^3 voxels, 64 bits: the node two levels above the finest.

pub(super) mod cluster;
mod moments;

use glam::DVec3;
use rayon::prelude::*;

use super::{PackedNormal, Progress};
use cluster::{Cluster, MORTON_TO_XYZ, Surroundings, enclosed, put};
use moments::Moments;

const ABSENT: u32 = u32::MAX;
/// Nodes of one level in and around a node: `(x * 3 + y) * 3 + z`.
type Neighbours = [u32; 27];
const SELF: usize = 13;
const MAX_PIECES: usize = 4096;

pub(super) struct Estimate<'t> {
    pub(super) mask: &'t [u8],
    pub(super) first: &'t [u32],
    pub(super) level_start: &'t [u32],
    pub(super) depth: u32,
    pub(super) centre: [f64; 3],
}

/// A subtree and the part of the finest level that it owns.
struct Piece {
    corner: [i32; 3],
    neighbours: Neighbours,
}

impl Estimate<'_> {
    pub(super) fn fill(&self, normals: &mut [PackedNormal], progress: &dyn Progress) {
        if normals.iter().all(|normal| !normal.is_none()) {
            return;
        }
        progress.begin("estimate normals", normals.len() as u64);
        if let Some(cluster_level) = self.depth.checked_sub(2) {
            self.fill_clusters(cluster_level, normals, progress);
        } else {
            // One cluster; a smaller object lies in its low corner.
            let cluster = Cluster::from(self.mask.first().map_or(1, |&mask| u64::from(mask)));
            let mut rows = Surroundings::default();
            put(&mut rows, SELF, cluster.by_rows);
            fill_cluster(self.centre, &rows, cluster.morton, [0; 3], normals);
        }
        progress.end();
    }

    fn fill_clusters(&self, level: u32, normals: &mut [PackedNormal], progress: &dyn Progress) {
        let first_cluster = self.level_start[level as usize];
        let clusters: Vec<Cluster> = (first_cluster..self.level_start[level as usize + 1])
            .into_par_iter()
            .map(|node| self.cluster(node))
            .collect();
        let (split_level, pieces) = self.pieces(level);

        let mut rest = normals;
        let mut work = Vec::with_capacity(pieces.len());
        for piece in pieces {
            let own = self.voxels_below(piece.neighbours[SELF], split_level);
            let (mine, others) = std::mem::take(&mut rest).split_at_mut(own);
            rest = others;
            work.push((piece, mine));
        }
        work.into_par_iter().for_each(|(piece, own)| {
            let mut walk = PieceNormals {
                estimate: self,
                cluster_level: level,
                first_cluster,
                clusters: &clusters,
                next: 0,
                normals: own,
            };
            walk.descend(split_level, piece.corner, &piece.neighbours);
            progress.advance(walk.normals.len() as u64);
        });
    }

    fn cluster(&self, node: u32) -> Cluster {
        let (first, mask) = (self.first[node as usize], self.mask[node as usize]);
        let octants = (0..8).filter(|octant| mask >> octant & 1 == 1);
        let morton = octants.zip(first..).fold(0u64, |word, (octant, child)| {
            word | u64::from(self.mask[child as usize]) << (8 * octant)
        });
        Cluster::from(morton)
    }

    /// Nodes of the deepest level, at most that of the clusters, with at most [`MAX_PIECES`]; in Morton order.
    fn pieces(&self, cluster_level: u32) -> (u32, Vec<Piece>) {
        let mut neighbours = [ABSENT; 27];
        neighbours[SELF] = 0;
        let mut pieces = vec![Piece {
            corner: [0; 3],
            neighbours,
        }];
        let mut level = 0;
        while level < cluster_level {
            let below = level as usize + 1;
            if self.level_start[below + 1] - self.level_start[below] > MAX_PIECES as u32 {
                break;
            }
            let mut finer = Vec::new();
            for piece in &pieces {
                self.for_children(level, piece.corner, &piece.neighbours, |corner, n| {
                    finer.push(Piece {
                        corner,
                        neighbours: *n,
                    });
                });
            }
            pieces = finer;
            level += 1;
        }
        (level, pieces)
    }

    fn voxels_below(&self, node: u32, level: u32) -> usize {
        let first_voxel = |mut node: u32| {
            for below in level..self.depth {
                // Past the last node of a level comes the end of the next.
                node = if node == self.level_start[below as usize + 1] {
                    self.level_start[below as usize + 2]
                } else {
                    self.first[node as usize]
                };
            }
            node
        };
        (first_voxel(node + 1) - first_voxel(node)) as usize
    }

    #[inline]
    fn for_children(
        &self,
        level: u32,
        corner: [i32; 3],
        neighbours: &Neighbours,
        mut call: impl FnMut([i32; 3], &Neighbours),
    ) {
        let around = neighbours.map(|node| {
            if node == ABSENT {
                (0, 0)
            } else {
                (self.first[node as usize], self.mask[node as usize])
            }
        });
        let (_, mask) = around[SELF];
        let side = 1i32 << (self.depth - level - 1);
        for octant in (0..8usize).filter(|octant| mask >> octant & 1 == 1) {
            let mut of_child = [ABSENT; 27];
            for (slot, (parent, child)) in of_child.iter_mut().zip(CHILD_NEIGHBOURS[octant]) {
                let (first, mask) = around[usize::from(parent)];
                if mask >> child & 1 == 1 {
                    *slot = first + (mask & ((1u8 << child) - 1)).count_ones();
                }
            }
            let along = |k: usize| corner[k] + side * (octant >> (2 - k) & 1) as i32;
            call([along(0), along(1), along(2)], &of_child);
        }
    }
}

/// Writes the normals of a cluster's voxels that have none. `normals` are in Morton order; `corner` is the cluster's
/// and `centre` the object's middle, both in finest voxels.
pub(super) fn fill_cluster(
    centre: [f64; 3],
    rows: &Surroundings,
    word: u64,
    corner: [i32; 3],
    normals: &mut [PackedNormal],
) {
    let set_bits = (0..64usize).filter(|bit| word >> bit & 1 == 1);
    for (bit, normal) in set_bits.zip(normals) {
        if !normal.is_none() {
            continue;
        }
        let at = MORTON_TO_XYZ[bit];
        if enclosed(rows, at) {
            continue;
        }
        let moments = Moments::around(rows, at);
        let outward = [0, 1, 2].map(|k| f64::from(corner[k]) + at[k] as f64 + 0.5 - centre[k]);
        *normal = moments.normal(DVec3::from_array(outward));
    }
}

/// By octant and neighbour: the neighbour of the parent that contains it, and its octant there.
const CHILD_NEIGHBOURS: [[(u8, u8); 27]; 8] = {
    let mut table = [[(0, 0); 27]; 8];
    let mut octant = 0;
    while octant < 8 {
        let mut neighbour = 0;
        while neighbour < 27 {
            // Positions in the parent's 6^3 grid of octants, 0 to 5.
            let x = 2 + (octant >> 2 & 1) + neighbour / 9 - 1;
            let y = 2 + (octant >> 1 & 1) + neighbour / 3 % 3 - 1;
            let z = 2 + (octant & 1) + neighbour % 3 - 1;
            let parent = (x / 2 * 3 + y / 2) * 3 + z / 2;
            let child = (x % 2) << 2 | (y % 2) << 1 | (z % 2);
            table[octant][neighbour] = (parent as u8, child as u8);
            neighbour += 1;
        }
        octant += 1;
    }
    table
};

struct PieceNormals<'w> {
    estimate: &'w Estimate<'w>,
    cluster_level: u32,
    first_cluster: u32,
    clusters: &'w [Cluster],
    next: usize,
    normals: &'w mut [PackedNormal],
}

impl PieceNormals<'_> {
    fn descend(&mut self, level: u32, corner: [i32; 3], neighbours: &Neighbours) {
        if level < self.cluster_level {
            let estimate = self.estimate;
            estimate.for_children(level, corner, neighbours, |corner, of_child| {
                self.descend(level + 1, corner, of_child);
            });
            return;
        }
        let word_of = |node: u32| self.clusters[(node - self.first_cluster) as usize];
        let mut rows = Surroundings::default();
        for (slot, &node) in neighbours.iter().enumerate() {
            if node != ABSENT {
                put(&mut rows, slot, word_of(node).by_rows);
            }
        }
        let word = word_of(neighbours[SELF]).morton;
        let end = self.next + word.count_ones() as usize;
        let own = &mut self.normals[self.next..end];
        fill_cluster(self.estimate.centre, &rows, word, corner, own);
        self.next = end;
    }
}
