//! Failures of building a graph from voxels.

use crate::budget::Shortage;

/// Longest side of the bounding box of a set of voxels.
pub(in crate::graph) const MAX_SIDE: u64 = 1 << super::morton::MAX_BITS;

/// Why no graph was built.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// No voxel was pushed.
    #[error("there are no voxels, so there is nothing to build")]
    Empty,
    #[error(
        "the voxels span {extent} along axis {axis}, more than {MAX_SIDE}; \
         are there stray voxels far from the object?"
    )]
    TooLarge { axis: char, extent: u64 },
    /// More voxels or nodes than 32 bits number.
    #[error("{0} voxels or nodes are more than 32 bits can number; split the object")]
    TooMany(u64),
    /// The system refuses the memory.
    #[error(transparent)]
    Memory(#[from] Shortage),
    #[error(
        "the world origin and the voxel size must be finite, the size above 0, and voxels there far enough apart to be told apart"
    )]
    Placement,
}
