//! A hollow ball.

use super::color::gradient;
use super::settings::Settings;
use super::sphere::half_chord;
use crate::graph::{Progress, Voxel};

/// The ball's voxels that have one of their 26 neighbours outside of it. Each voxel inside then has all its 26
/// neighbours in the ball, so that no step over a face, an edge or a corner leads from the inside out.
pub(super) fn voxels(settings: &Settings, sink: &mut dyn FnMut(Voxel), progress: &dyn Progress) {
    let side = 1i32 << settings.depth;
    let middle = side / 2;
    progress.begin("generating shell", side as u64);
    for z in 0..side {
        for y in 0..side {
            let outer = half_chord(side, y, z);
            // Inside: one voxel less than the shortest of the nine columns around.
            let inner = (-1..=1)
                .flat_map(|dz| (-1..=1).map(move |dy| half_chord(side, y + dy, z + dz)))
                .min()
                .map_or(0, |shortest| (shortest - 1).max(0));
            for x in (middle - outer..middle - inner).chain(middle + inner..middle + outer) {
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
