//! Menger's sponge, the benchmark's small scene.

use super::settings::Settings;
use crate::graph::{Progress, Voxel};

/// The sponge of `3^depth` voxels a side. At each scale a cell is taken out
/// whose ternary digit is 1 on two axes or three.
pub(super) fn voxels(settings: &Settings, sink: &mut dyn FnMut(Voxel), progress: &dyn Progress) {
    let iterations = settings.depth;
    let side = 3i32.pow(iterations);
    // By coordinate: bit s is set where the digit of scale s is 1.
    let ones: Vec<u32> = (0..side)
        .map(|c| (0..iterations).fold(0, |ones, s| ones | u32::from(c / 3i32.pow(s) % 3 == 1) << s))
        .collect();
    progress.begin("generating menger", side as u64);
    // The reference's y is up, which is our z: its green.
    let shade = |c: i32| (c * 255 / side) as u8;
    for z in 0..side {
        for y in 0..side {
            let (in_z, in_y) = (ones[z as usize], ones[y as usize]);
            if in_z & in_y != 0 {
                continue;
            }
            for x in 0..side {
                if ones[x as usize] & (in_y | in_z) == 0 {
                    sink(Voxel {
                        index: [x, y, z],
                        color: [shade(x), shade(z), shade(y)],
                        normal: None,
                    });
                }
            }
        }
        progress.advance(1);
    }
    progress.end();
}
