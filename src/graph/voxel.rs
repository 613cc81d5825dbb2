//! One voxel of a file.

use super::PackedNormal;

/// A voxel at a file index: it fills `[i, i+1) x [j, j+1) x [k, k+1)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Voxel {
    /// File index, finest voxels; may be negative.
    pub index: [i32; 3],
    /// sRGB colour.
    pub color: [u8; 3],
    /// None: the file has none.
    pub normal: Option<PackedNormal>,
}
