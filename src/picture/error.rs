//! Failures of making a picture.

use crate::budget::Shortage;

/// Why a frame and its set-up make no picture.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ResolveError {
    /// Frame and set-up differ in size.
    #[error("the frame has {0} x {1} samples, its set-up {2} x {3}")]
    Size(u32, u32, u32, u32),
    /// A voxel's index, counted from the file's origin, leaves the range of `i32`.
    #[error("the file index of a voxel is beyond 32 bits")]
    Index,
    /// Neither a frame of nodes nor the graph determines the visible voxel of a node.
    #[error("the frame does not tell which voxels are seen")]
    Voxel,
    /// The system refuses the memory of the pixels.
    #[error(transparent)]
    Memory(#[from] Shortage),
}
