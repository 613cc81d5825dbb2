//! The tree's levels, each written as its nodes are closed.
//!
//! Clusters come in Morton order, so one node per level above them is open. Nodes of a level are opened and written in
//! one order, so their numbers within the level are known when they are opened.

use std::io;
use std::sync::Arc;

use super::scratch::{Scratch, Spool};
use crate::graph::PackedNormal;
use crate::graph::average::Sum;
use crate::graph::build::first_new_level;

#[derive(Debug, Clone, Copy)]
pub(super) struct FinishedNode {
    pub(super) mask: u8,
    pub(super) color: [u8; 3],
    pub(super) normal: PackedNormal,
}

impl FinishedNode {
    pub(super) fn new(mask: u8, sum: &Sum) -> Self {
        Self {
            mask,
            color: sum.color(),
            normal: sum.normal(),
        }
    }
}

#[derive(Debug, Clone)]
pub(super) struct ClusterNodes {
    pub(super) mask: u8,
    pub(super) octants: Vec<FinishedNode>,
    pub(super) sum: Sum,
}

/// Masks, first children (`u32`, numbers within their level), colours and normals of a level, in the order of bytes of
/// the processor.
pub(super) type LevelArrays = [Spool; 4];

#[derive(Debug, Clone, Copy, Default)]
struct Open {
    mask: u8,
    first: u64,
    sum: Sum,
}

#[derive(Debug)]
pub(super) struct TreeWriter {
    depth: u32,
    levels: Vec<LevelArrays>,
    begun: Vec<u64>,
    open: Vec<Open>,
    before: Option<u64>,
}

impl TreeWriter {
    pub(super) fn new(depth: u32, scratch: &Arc<Scratch>, spool_bytes: usize) -> Self {
        let spool = || Spool::new(scratch, spool_bytes);
        Self {
            depth,
            levels: (0..depth).map(|_| [(); 4].map(|()| spool())).collect(),
            begun: vec![0; depth as usize + 1],
            open: vec![Open::default(); depth.saturating_sub(2) as usize],
            before: None,
        }
    }

    /// Adds the next cluster with its number of voxels and its nodes. An object of less than two levels is one octant
    /// of one cluster, or a voxel.
    pub(super) fn push(
        &mut self,
        cluster_key: u64,
        voxels: u32,
        nodes: &ClusterNodes,
    ) -> io::Result<()> {
        let finest = self.depth as usize;
        let mut first = self.begun[finest];
        self.begun[finest] += u64::from(voxels);
        if finest == 0 {
            return Ok(());
        }
        let octants = finest - 1;
        let first_octant = self.begun[octants];
        self.begun[octants] += nodes.octants.len() as u64;
        for node in &nodes.octants {
            self.write(octants, *node, first)?;
            first += u64::from(node.mask.count_ones());
        }
        let Some(cluster_level) = octants.checked_sub(1) else {
            return Ok(());
        };
        self.open_above(cluster_key, cluster_level)?;
        self.begun[cluster_level] += 1;
        self.write(
            cluster_level,
            FinishedNode::new(nodes.mask, &nodes.sum),
            first_octant,
        )?;
        if let Some(parent) = self.open.last_mut() {
            parent.mask |= 1 << (cluster_key & 7);
            parent.sum.add(&nodes.sum);
        }
        Ok(())
    }

    fn open_above(&mut self, cluster_key: u64, cluster_level: usize) -> io::Result<()> {
        let new_level = first_new_level(self.before, cluster_key, cluster_level as u32) as usize;
        if self.before.is_some() {
            self.close(new_level)?;
        }
        self.before = Some(cluster_key);
        for level in new_level..cluster_level {
            self.open[level] = Open {
                first: self.begun[level + 1],
                ..Open::default()
            };
            self.begun[level] += 1;
            if let Some(above) = level.checked_sub(1) {
                let octant = cluster_key >> (3 * (cluster_level - level)) & 7;
                self.open[above].mask |= 1 << octant;
            }
        }
        Ok(())
    }

    fn close(&mut self, from: usize) -> io::Result<()> {
        for level in (from..self.open.len()).rev() {
            let Open { mask, first, sum } = self.open[level];
            self.write(level, FinishedNode::new(mask, &sum), first)?;
            if let Some(above) = level.checked_sub(1) {
                self.open[above].sum.add(&sum);
            }
        }
        Ok(())
    }

    fn write(&mut self, level: usize, node: FinishedNode, first: u64) -> io::Result<()> {
        let [masks, firsts, colors, normals] = &mut self.levels[level];
        masks.push(&[node.mask])?;
        firsts.push(&(first as u32).to_ne_bytes())?;
        colors.push(&node.color)?;
        normals.push(&node.normal.0.to_ne_bytes())
    }

    pub(super) fn finish(mut self) -> io::Result<(Vec<LevelArrays>, Vec<u64>)> {
        if self.before.is_some() {
            self.close(0)?;
        }
        Ok((self.levels, self.begun))
    }
}
