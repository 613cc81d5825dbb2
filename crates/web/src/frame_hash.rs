//! The hash of a golden picture, also for the random frames of `tests/machine`.

use shiftvox::frame::Frame;
use xxhash_rust::xxh3::Xxh3;

/// XXH3-128 of all voxels, then all nodes, then what is blended, little-endian.
pub(crate) fn hash(frame: &Frame) -> u128 {
    let mut hash = Xxh3::new();
    for number in frame.voxel.iter().flatten() {
        hash.update(&number.to_le_bytes());
    }
    for node in &frame.node {
        hash.update(&node.to_le_bytes());
    }
    for blend in frame.blend.iter().flatten() {
        hash.update(format!("{blend:?}").as_bytes());
    }
    hash.digest128()
}
