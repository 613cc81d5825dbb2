//! A solid ball.

use super::color::gradient;
use super::settings::Settings;
use crate::graph::{Progress, Voxel};

/// Half the number of voxels, along x, of the column `(y, z)` of the ball
/// that touches the cube of `side` voxels; 0 also outside of the cube. A voxel
/// belongs to the ball when its centre does.
pub(super) fn half_chord(side: i32, y: i32, z: i32) -> i32 {
    if !(0..side).contains(&y) || !(0..side).contains(&z) {
        return 0;
    }
    // In half voxels from the middle, where centres are odd numbers.
    let from_middle = |c: i32| i64::from(2 * c + 1 - side);
    let square = |c: i64| c * c;
    let rest = square(side.into()) - square(from_middle(y)) - square(from_middle(z));
    if rest < 1 {
        return 0;
    }
    // Odd numbers from 1 to the root; at most 2^11.
    ((rest.isqrt() + 1) / 2) as i32
}

/// All voxels whose centre is in the ball.
pub(super) fn voxels(settings: &Settings, sink: &mut dyn FnMut(Voxel), progress: &dyn Progress) {
    let side = 1i32 << settings.depth;
    progress.begin("generating sphere", side as u64);
    for z in 0..side {
        for y in 0..side {
            let half = half_chord(side, y, z);
            for x in side / 2 - half..side / 2 + half {
                let index = [x, y, z];
                sink(Voxel {
                    index,
                    color: gradient(index, side),
                    normal: None,
                });
            }
        }
        progress.advance(1);
    }
    progress.end();
}
