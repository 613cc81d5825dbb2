//! The data of a node in memory: unpacked and found sound.

use crate::far::record::{LeafTriangle, Node, RECORD_BYTES};

/// Triangles, and of an inner node voxels.
#[derive(Debug)]
pub struct NodeData {
    counts: [u32; 6],
    records: Vec<u8>,
    triangles: Vec<LeafTriangle>,
}

impl NodeData {
    /// `None` if a voxel is not within the grid or a triangle not within the box.
    pub(super) fn of(node: &Node, records: Vec<u8>, triangles: Vec<LeafTriangle>) -> Option<Self> {
        let data = Self {
            counts: node.counts,
            records,
            triangles,
        };
        let is_in_grid = |record: &[u8]| (0..3).all(|k| record[k] < node.cells[k]);
        let is_in_box = |p: &[f32; 3]| (0..3).all(|k| node.low[k] <= p[k] && p[k] <= node.high[k]);
        let is_list = |(list, bytes): (&[u8], usize)| list.chunks_exact(bytes).all(is_in_grid);
        let mut corners = data.triangles.iter().flat_map(|t| &t.corners);
        let is_sound =
            data.lists().into_iter().zip(RECORD_BYTES).all(is_list) && corners.all(is_in_box);
        is_sound.then_some(data)
    }

    /// Records of the voxels by list.
    pub fn lists(&self) -> [&[u8]; RECORD_BYTES.len()] {
        let mut rest = &self.records[..];
        std::array::from_fn(|list| {
            let (mine, more) = rest.split_at(self.counts[list] as usize * RECORD_BYTES[list]);
            rest = more;
            mine
        })
    }

    pub fn triangles(&self) -> &[LeafTriangle] {
        &self.triangles
    }

    pub(super) fn bytes(&self) -> u64 {
        (self.records.len() + size_of_val(&self.triangles[..])) as u64
    }
}
