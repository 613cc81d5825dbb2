//! The data of a node in memory: unpacked and found sound.

use std::sync::{Arc, Mutex, PoisonError};

use crate::far::record::{LISTS, LeafTriangle, Node, RECORD_BYTES};

/// Voxels of an inner node, or triangles of a leaf.
#[derive(Debug)]
pub struct NodeData {
    counts: [u32; 6],
    records: Vec<u8>,
    triangles: Vec<LeafTriangle>,
}

impl NodeData {
    /// Of an inner node's records; `None` if one is not within its grid.
    pub(super) fn of_voxels(node: &Node, records: Vec<u8>) -> Option<Self> {
        let data = Self {
            counts: node.counts,
            records,
            triangles: Vec::new(),
        };
        let is_within = |record: &[u8]| (0..3).all(|k| record[k] < node.cells[k]);
        let is_sound = {
            let mut lists = data.lists().into_iter().zip(RECORD_BYTES);
            lists.all(|(list, bytes)| list.chunks_exact(bytes).all(is_within))
        };
        is_sound.then_some(data)
    }

    /// Of a leaf's triangles; `None` if one is not within its box.
    pub(super) fn of_triangles(node: &Node, triangles: Vec<LeafTriangle>) -> Option<Self> {
        let is_within = |p: &[f32; 3]| (0..3).all(|k| node.low[k] <= p[k] && p[k] <= node.high[k]);
        let is_sound = |t: &LeafTriangle| t.spare == 0 && t.corners.iter().all(is_within);
        triangles.iter().all(is_sound).then_some(Self {
            counts: [0; 6],
            records: Vec::new(),
            triangles,
        })
    }

    /// Records of the voxels, one slice for each list; empty ones of a leaf.
    #[must_use]
    pub fn lists(&self) -> [&[u8]; LISTS.len()] {
        let mut rest = &self.records[..];
        std::array::from_fn(|list| {
            let (mine, more) = rest.split_at(self.counts[list] as usize * RECORD_BYTES[list]);
            rest = more;
            mine
        })
    }

    /// Triangles; none of an inner node.
    #[must_use]
    pub fn triangles(&self) -> &[LeafTriangle] {
        &self.triangles
    }

    /// Bytes that it takes in memory.
    pub(super) fn bytes(&self) -> u64 {
        (self.records.len() + size_of_val(&self.triangles[..])) as u64
    }
}

/// Where the data of a node is kept once it was unpacked.
#[derive(Debug, Default)]
pub(super) struct Slot(Mutex<Option<Arc<NodeData>>>);

impl Slot {
    pub(super) fn get(&self) -> Option<Arc<NodeData>> {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    pub(super) fn set(&self, data: Option<Arc<NodeData>>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = data;
    }
}
