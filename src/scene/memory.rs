//! How many voxels may be gathered in how much memory.

/// Bytes a voxel that building in memory takes at the least: 20 while it is
/// pushed and sorted, 5 in the graph. Surfaces take 29 (`spec/graph.md`).
const LEAST_BYTES: u64 = 25;

/// Most voxels that can be built in so many bytes.
pub(super) fn most_voxels(bytes: u64) -> u64 {
    bytes / LEAST_BYTES
}

/// Bytes that building so many voxels takes at the least.
pub(super) fn least_bytes(voxels: u64) -> u64 {
    voxels.saturating_mul(LEAST_BYTES)
}
