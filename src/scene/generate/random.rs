//! Voxels strewn at random.

use super::color::palette;
use super::hash::hash;
use super::settings::Settings;
use crate::graph::{Progress, Voxel};

/// Each voxel of the cube by itself with a chance of `density` percent.
pub(super) fn voxels(settings: &Settings, sink: &mut dyn FnMut(Voxel), progress: &dyn Progress) {
    let side = 1u32 << settings.depth;
    // Of 2^32 hash values, those below are filled; all at 100 percent.
    let filled_below = (u64::from(settings.density) << 32) / 100;
    progress.begin("generating random", u64::from(side));
    for z in 0..side {
        for y in 0..side {
            for x in 0..side {
                // At most 10 bits each.
                let h = hash(x | y << 10, z, settings.seed);
                if u64::from(h) < filled_below {
                    sink(Voxel {
                        index: [x as i32, y as i32, z as i32],
                        color: palette(hash(h, x, !settings.seed)),
                        normal: None,
                    });
                }
            }
        }
        progress.advance(1);
    }
    progress.end();
}
