//! A lattice of thin bars.

use super::color::palette;
use super::settings::Settings;
use crate::graph::{Progress, Voxel};

/// Cells of the lattice along a side.
const CELLS: i32 = 8;

/// Bars one voxel thin along the edges of a cubic lattice, both outer sides
/// included; a colour for each direction and one for the joints.
pub(super) fn voxels(settings: &Settings, sink: &mut dyn FnMut(Voxel), progress: &dyn Progress) {
    let side = 1i32 << settings.depth;
    let mut on_lattice = vec![false; side as usize];
    for i in 0..=CELLS {
        on_lattice[((side - 1) * i / CELLS) as usize] = true;
    }
    progress.begin("generating truss", side as u64);
    for z in 0..side {
        for y in 0..side {
            let (at_z, at_y) = (on_lattice[z as usize], on_lattice[y as usize]);
            if !(at_z || at_y) {
                continue;
            }
            for x in 0..side {
                let at_x = on_lattice[x as usize];
                let color = match (at_x, at_y, at_z) {
                    (true, true, true) => palette(2),
                    (false, true, true) => palette(0),
                    (true, false, true) => palette(3),
                    (true, true, false) => palette(5),
                    _ => continue,
                };
                sink(Voxel {
                    index: [x, y, z],
                    color,
                    normal: None,
                });
            }
        }
        progress.advance(1);
    }
    progress.end();
}
