//! Memory of a graph while it is built.

/// Least bytes per voxel: 20 while voxels are collected and sorted, 5 in the graph. Surfaces take 29
/// (`spec/graph.md`).
const LEAST_BYTES: u64 = 25;

pub(super) fn most_voxels(bytes: u64) -> u64 {
    bytes / LEAST_BYTES
}

pub(super) fn least_bytes(voxels: u64) -> u64 {
    voxels.saturating_mul(LEAST_BYTES)
}
