//! A fan of thin wires.

use std::collections::BTreeMap;

use super::color::palette;
use super::settings::Settings;
use crate::graph::{Progress, Voxel};

/// Wires along each side of the far face, less one.
const SPACES: i32 = 8;

/// Straight wires from the middle of the face `x = 0` to 9 x 9 points of the
/// far face. A wire has one voxel at each x, the nearest to its line (halves
/// upwards), and never leaves it by more than a step over a corner. Where
/// wires meet, the first one's colour stays.
pub(super) fn voxels(settings: &Settings, sink: &mut dyn FnMut(Voxel), progress: &dyn Progress) {
    let last = (1i32 << settings.depth) - 1;
    let middle = last / 2;
    progress.begin("generating wires", last as u64 + 1);
    let ends: Vec<i32> = (0..=SPACES).map(|i| last * i / SPACES).collect();
    // At most 2^12 x 2^12 * 2.
    let at = |end: i32, x: i32| middle + (2 * (end - middle) * x + last).div_euclid(2 * last);
    for x in 0..=last {
        let mut here = BTreeMap::new();
        for (row, &end_z) in ends.iter().enumerate() {
            for (column, &end_y) in ends.iter().enumerate() {
                here.entry((at(end_z, x), at(end_y, x)))
                    .or_insert_with(|| palette((3 * row + column) as u32));
            }
        }
        for ((z, y), color) in here {
            sink(Voxel {
                index: [x, y, z],
                color,
                normal: None,
            });
        }
        progress.advance(1);
    }
    progress.end();
}
