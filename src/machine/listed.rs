//! The voxels that an earlier frame showed, and all nodes above them: what a frame may draw first.
//!
//! A list is a guess. With any list, or none, the picture is the same.

use std::collections::HashSet;

use super::record::Cube;
use crate::frame::{Frame, NO_NODE};

/// A list of nodes.
#[derive(Debug, Clone, Default)]
pub struct Listed {
    /// Depth of the graph.
    depth: u32,
    /// Lowest corner in finest voxels, and level.
    nodes: HashSet<[i32; 4]>,
}

impl Listed {
    /// Voxels as [`Frame::voxel`] has them, of a graph of this depth.
    pub fn new(voxels: impl IntoIterator<Item = [i32; 4]>, depth: u32) -> Self {
        let mut nodes = HashSet::new();
        for [x, y, z, finest] in voxels {
            for level in (0..=finest).rev() {
                let below = depth as i32 - level;
                let [x, y, z] = [x, y, z].map(|c| c >> below << below);
                if !nodes.insert([x, y, z, level]) {
                    break;
                }
            }
        }
        Self { depth, nodes }
    }

    /// The voxels of a frame.
    pub fn of(frame: &Frame, depth: u32) -> Self {
        let samples = frame.node.iter().zip(&frame.voxel);
        let shown = samples.filter(|&(&node, _)| node != NO_NODE);
        Self::new(shown.map(|(_, &voxel)| voxel), depth)
    }

    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    pub(super) fn holds(&self, parent: &Cube, octant: u8) -> bool {
        let level = parent.level + 1;
        let below = self.depth - level;
        let [x, y, z] = std::array::from_fn(|k| {
            let low = parent.min[k].to_host() as i32; // host: a mask of the list, which is not counted
            low | i32::from(octant >> (2 - k) & 1) << below
        });
        self.nodes.contains(&[x, y, z, level as i32])
    }
}
