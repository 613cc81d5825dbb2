//! A voxel as 128 bits that sort as they are.
//!
//! | bits | while pushed | once placed |
//! |---|---|---|
//! | 127..64 | index modulo 2^21 along each axis | Morton key from the lowest corner |
//! | 63..40 | all ones less the number within the run | the same |
//! | 39..16 | colour | colour |
//! | 15..0 | normal | normal |

use crate::graph::{PackedNormal, Voxel, morton};

pub(super) const MAX_RUN: usize = 1 << 24;

pub(super) fn pushed(voxel: &Voxel, number: usize) -> u128 {
    let latest_first = (MAX_RUN - 1 - number) as u64;
    let [r, g, b] = voxel.color.map(u64::from);
    let normal = u64::from(voxel.normal.unwrap_or(PackedNormal::NONE).0);
    let rest = latest_first << 40 | r << 32 | g << 24 | b << 16 | normal;
    u128::from(morton::pack(voxel.index)) << 64 | u128::from(rest)
}

pub(super) fn placed(record: u128, corner: [i32; 3]) -> u128 {
    with_key(record, morton::key_from(key(record), corner))
}

/// Placed from another corner, which must not be above the first along any axis.
pub(super) fn moved(record: u128, from: [i32; 3], to: [i32; 3]) -> u128 {
    let old = morton::at(key(record));
    let at = [0, 1, 2].map(|axis| {
        let further = (from[axis] as u32).wrapping_sub(to[axis] as u32);
        old[axis].wrapping_add(further) & (morton::MAX_SIDE as u32 - 1)
    });
    with_key(record, morton::key(at))
}

fn with_key(record: u128, key: u64) -> u128 {
    u128::from(key) << 64 | u128::from(record as u64)
}

pub(super) fn key(record: u128) -> u64 {
    (record >> 64) as u64
}

pub(super) fn color(record: u128) -> [u8; 3] {
    [
        (record >> 32) as u8,
        (record >> 24) as u8,
        (record >> 16) as u8,
    ]
}

pub(super) fn normal(record: u128) -> PackedNormal {
    PackedNormal(record as u16)
}
