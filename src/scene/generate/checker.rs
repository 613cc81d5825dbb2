//! A three-dimensional checkerboard.

use super::color::palette;
use super::settings::Settings;
use crate::graph::{Progress, Voxel};

/// Every voxel whose coordinates have an even sum, in two colours by blocks
/// of an eighth of the side.
pub(super) fn voxels(settings: &Settings, sink: &mut dyn FnMut(Voxel), progress: &dyn Progress) {
    let side = 1i32 << settings.depth;
    let block_log2 = settings.depth.saturating_sub(3);
    progress.begin("generating checker", side as u64);
    for z in 0..side {
        for y in 0..side {
            for x in ((y + z) & 1..side).step_by(2) {
                let block = (x >> block_log2) + (y >> block_log2) + (z >> block_log2);
                sink(Voxel {
                    index: [x, y, z],
                    color: palette(if block & 1 == 0 { 2 } else { 5 }),
                    normal: None,
                });
            }
        }
        progress.advance(1);
    }
    progress.end();
}
