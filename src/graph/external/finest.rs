//! The finest level: voxels from the merge, then normals and averages.

use std::io;
use std::sync::Arc;

use rayon::prelude::*;

use super::buffer_sizes::BufferSizes;
use super::halo::{Grid, hand_on};
use super::record;
use super::runs::{Merge, Sorter};
use super::scratch::{Scratch, Spool};
use super::tree::{ClusterNodes, FinishedNode, TreeWriter};
use crate::graph::average::Sum;
use crate::graph::normals::fill_cluster;
use crate::graph::{PackedNormal, Progress, morton};

const PART: usize = 64;
const STEP: u64 = 1 << 16;

#[derive(Debug)]
pub(super) struct Finest {
    pub(super) color: Spool,
    own_normal: Spool,
    clusters: Spool,
    halo: Sorter,
    pub(super) voxels: u64,
    lacking: bool,
}

impl Finest {
    pub(super) fn take(
        mut sorted: Merge,
        depth: u32,
        sizes: &BufferSizes,
        scratch: &Arc<Scratch>,
        progress: &dyn Progress,
    ) -> io::Result<Self> {
        let spool = || Spool::new(scratch, sizes.spool_bytes);
        let mut finest = Self {
            color: spool(),
            own_normal: spool(),
            clusters: spool(),
            halo: Sorter::new(scratch, sizes.halo_records)?,
            voxels: 0,
            lacking: false,
        };
        let blocks_bits = depth.saturating_sub(2).saturating_sub(sizes.block_shift);
        let mut cluster = None;
        while let Some(voxel) = sorted.next()? {
            let key = record::key(voxel);
            let normal = record::normal(voxel);
            finest.color.push(&record::color(voxel))?;
            finest.own_normal.push(&normal.0.to_ne_bytes())?;
            finest.lacking |= normal.is_none();
            finest.voxels += 1;
            if finest.voxels.is_multiple_of(STEP) {
                progress.advance(STEP);
            }
            let bit = 1u64 << (key & 63);
            cluster = match cluster {
                Some((same, word)) if same == key >> 6 => Some((same, word | bit)),
                other => {
                    finest.push(other, sizes, blocks_bits)?;
                    Some((key >> 6, bit))
                }
            };
        }
        finest.push(cluster, sizes, blocks_bits)?;
        Ok(finest)
    }

    fn push(
        &mut self,
        cluster: Option<(u64, u64)>,
        sizes: &BufferSizes,
        blocks_bits: u32,
    ) -> io::Result<()> {
        let Some((key, word)) = cluster else {
            return Ok(());
        };
        self.clusters.push(bytemuck::bytes_of(&[key, word]))?;
        hand_on(key, word, sizes.block_shift, blocks_bits, &mut self.halo)
    }

    /// Estimates normals, averages, and writes the tree. Returns colours and normals of the finest level.
    pub(super) fn finish(
        self,
        tree: &mut TreeWriter,
        centre: [f64; 3],
        sizes: &BufferSizes,
        scratch: &Arc<Scratch>,
        progress: &dyn Progress,
    ) -> io::Result<[Spool; 2]> {
        let shift = sizes.block_shift;
        let mut grid = if self.lacking {
            Some(Grid::new(shift, self.halo.merged(sizes, scratch)?))
        } else {
            None
        };
        let mut worked = FinestInProgress {
            color: self.color,
            own_normal: self.own_normal,
            normal: Spool::new(scratch, sizes.spool_bytes),
            voxels: 0,
            centre,
        };
        let mut blocks = BlockReader {
            clusters: self.clusters,
            shift,
            piece: Vec::new(),
            next: 0,
            offset: 0,
            piece_clusters: sizes.spool_bytes / 16,
        };
        let mut block = Vec::new();
        while let Some(block_key) = blocks.next(&mut block)? {
            if let Some(grid) = &mut grid {
                grid.fill(block_key, &block)?;
            }
            for chunk in block.chunks(sizes.chunk_clusters) {
                progress.advance(worked.work(chunk, grid.as_ref(), tree)?);
            }
        }
        Ok([worked.color, worked.normal])
    }
}

struct BlockReader {
    clusters: Spool,
    shift: u32,
    piece: Vec<[u64; 2]>,
    next: usize,
    offset: u64,
    piece_clusters: usize,
}

impl BlockReader {
    fn peek(&mut self) -> io::Result<Option<[u64; 2]>> {
        if self.next == self.piece.len() {
            let left = (self.clusters.len() - self.offset) / 16;
            let count = left.min(self.piece_clusters as u64) as usize;
            self.piece.resize(count, [0; 2]);
            self.next = 0;
            let bytes = bytemuck::cast_slice_mut(&mut self.piece);
            self.clusters.read(self.offset, bytes)?;
            self.offset += 16 * count as u64;
        }
        Ok(self.piece.get(self.next).copied())
    }

    fn next(&mut self, block: &mut Vec<[u64; 2]>) -> io::Result<Option<u64>> {
        block.clear();
        let Some([first, _]) = self.peek()? else {
            return Ok(None);
        };
        let block_key = first >> (3 * self.shift);
        while let Some(cluster) = self.peek()? {
            if cluster[0] >> (3 * self.shift) != block_key {
                break;
            }
            block.push(cluster);
            self.next += 1;
        }
        Ok(Some(block_key))
    }
}

struct FinestInProgress {
    color: Spool,
    own_normal: Spool,
    normal: Spool,
    voxels: u64,
    centre: [f64; 3],
}

impl FinestInProgress {
    fn work(
        &mut self,
        clusters: &[[u64; 2]],
        grid: Option<&Grid>,
        tree: &mut TreeWriter,
    ) -> io::Result<u64> {
        let voxels_of = |clusters: &[[u64; 2]]| -> usize {
            clusters
                .iter()
                .map(|cluster| cluster[1].count_ones() as usize)
                .sum()
        };
        let voxels = voxels_of(clusters);
        let mut color = vec![[0u8; 3]; voxels];
        let mut normal = vec![PackedNormal::NONE; voxels];
        self.color.read(3 * self.voxels, color.as_flattened_mut())?;
        self.own_normal
            .read(2 * self.voxels, bytemuck::cast_slice_mut(&mut normal))?;

        let (mut color_rest, mut normal_rest) = (&color[..], &mut normal[..]);
        let mut parts = Vec::with_capacity(clusters.len().div_ceil(PART));
        for clusters in clusters.chunks(PART) {
            let count = voxels_of(clusters);
            let color = color_rest.split_off(..count).unwrap_or_default();
            let normal = normal_rest.split_off_mut(..count).unwrap_or_default();
            parts.push((clusters, color, normal));
        }
        let nodes: Vec<Vec<ClusterNodes>> = parts
            .into_par_iter()
            .map(|(clusters, color, normal)| nodes_of(clusters, color, normal, grid, self.centre))
            .collect();
        for (cluster, nodes) in clusters.iter().zip(nodes.iter().flatten()) {
            tree.push(cluster[0], cluster[1].count_ones(), nodes)?;
        }
        self.normal.push(bytemuck::cast_slice(&normal))?;
        self.voxels += voxels as u64;
        Ok(voxels as u64)
    }
}

fn nodes_of(
    clusters: &[[u64; 2]],
    mut color: &[[u8; 3]],
    mut normal: &mut [PackedNormal],
    grid: Option<&Grid>,
    centre: [f64; 3],
) -> Vec<ClusterNodes> {
    let nodes = clusters.iter().map(|&[key, word]| {
        let count = word.count_ones() as usize;
        let own_color = color.split_off(..count).unwrap_or_default();
        let own_normal = normal.split_off_mut(..count).unwrap_or_default();
        if let Some(grid) = grid {
            let corner = morton::at(key).map(|c| (c << 2) as i32);
            fill_cluster(centre, &grid.surroundings(key), word, corner, own_normal);
        }
        averages(word, own_color, own_normal)
    });
    nodes.collect()
}

fn averages(word: u64, color: &[[u8; 3]], normal: &[PackedNormal]) -> ClusterNodes {
    let mut nodes = ClusterNodes {
        mask: 0,
        octants: Vec::with_capacity(8),
        sum: Sum::default(),
    };
    let mut voxels = color.iter().zip(normal);
    for octant in 0..8 {
        let mask = (word >> (8 * octant)) as u8;
        if mask == 0 {
            continue;
        }
        let mut sum = Sum::default();
        for (&color, &normal) in voxels.by_ref().take(mask.count_ones() as usize) {
            sum.add_voxel(color, normal);
        }
        nodes.mask |= 1 << octant;
        nodes.octants.push(FinishedNode::new(mask, &sum));
        nodes.sum.add(&sum);
    }
    nodes
}
