//! One voxel of a file, before it becomes part of a graph.

use super::PackedNormal;

/// A voxel at a file index: it fills `[i, i+1) x [j, j+1) x [k, k+1)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Voxel {
    /// File index, finest voxels; may be negative.
    pub index: [i32; 3],
    /// sRGB colour.
    pub color: [u8; 3],
    /// Normal, where the file has one.
    pub normal: Option<PackedNormal>,
}
