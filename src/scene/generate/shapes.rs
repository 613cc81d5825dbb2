//! Scenes that follow cell by cell from the coordinates.

use std::collections::BTreeMap;

use super::list::Settings;
use super::{gradient, hash, palette};
use crate::graph::{Graph, PackedNormal, Progress, Voxel};

const CELLS: i32 = 8;
const SPACES: i32 = 8;

type Sink<'s> = &'s mut dyn FnMut(Voxel);

/// Passes on the voxels of each row `(y, z)`, which `row` finds: x and colour of each.
pub(super) fn rows(
    name: &str,
    [side, height]: [i32; 2],
    sink: Sink<'_>,
    progress: &dyn Progress,
    mut row: impl FnMut(i32, i32, &mut dyn FnMut(i32, [u8; 3])),
) {
    progress.begin(&format!("generating {name}"), height as u64);
    for z in 0..height {
        for y in 0..side {
            row(y, z, &mut |x, color| {
                sink(Voxel {
                    index: [x, y, z],
                    color,
                    normal: None,
                });
            });
        }
        progress.advance(1);
    }
    progress.end();
}

pub(super) fn checker(settings: &Settings, sink: Sink<'_>, progress: &dyn Progress) {
    let side = 1i32 << settings.depth;
    let block_log2 = settings.depth.saturating_sub(3);
    rows("checker", [side; 2], sink, progress, |y, z, put| {
        for x in ((y + z) & 1..side).step_by(2) {
            let block = (x >> block_log2) + (y >> block_log2) + (z >> block_log2);
            put(x, palette(if block & 1 == 0 { 2 } else { 5 }));
        }
    });
}

/// Menger's sponge of `3^depth` voxels per side. At each scale a cell is taken out whose ternary digit is 1 on two axes
/// or three.
pub(super) fn menger(settings: &Settings, sink: Sink<'_>, progress: &dyn Progress) {
    let iterations = settings.depth;
    let side = 3i32.pow(iterations);
    // By coordinate: bit s is set where the digit of scale s is 1.
    let ones: Vec<u32> = (0..side)
        .map(|c| (0..iterations).fold(0, |ones, s| ones | u32::from(c / 3i32.pow(s) % 3 == 1) << s))
        .collect();
    // The reference's y is up, which is our z: its green.
    let shade = |c: i32| (c * 255 / side) as u8;
    rows("menger", [side; 2], sink, progress, |y, z, put| {
        let (in_z, in_y) = (ones[z as usize], ones[y as usize]);
        for x in 0..if in_z & in_y == 0 { side } else { 0 } {
            if ones[x as usize] & (in_y | in_z) == 0 {
                put(x, [shade(x), shade(z), shade(y)]);
            }
        }
    });
}

pub(super) fn random(settings: &Settings, sink: Sink<'_>, progress: &dyn Progress) {
    let side = 1i32 << settings.depth;
    // Of 2^32 hash values, those below are filled; all at 100 percent.
    let filled_below = (u64::from(settings.density) << 32) / 100;
    rows("random", [side; 2], sink, progress, |y, z, put| {
        for x in 0..side {
            let h = hash((x | y << 10) as u32, z as u32, settings.seed);
            if u64::from(h) < filled_below {
                put(x, palette(hash(h, x as u32, !settings.seed)));
            }
        }
    });
}

/// Half the number of voxels, along x, of the column `(y, z)` of the ball that touches the cube of `side` voxels. A voxel
/// belongs to the ball if its centre does.
fn half_chord(side: i32, y: i32, z: i32) -> i32 {
    if !(0..side).contains(&y) || !(0..side).contains(&z) {
        return 0;
    }
    // In half voxels from the middle, where centres are odd numbers.
    let from_middle = |c: i32| i64::from(2 * c + 1 - side).pow(2);
    let rest = i64::from(side).pow(2) - from_middle(y) - from_middle(z);
    ((rest.max(0).isqrt() + 1) / 2) as i32
}

pub(super) fn sphere(settings: &Settings, sink: Sink<'_>, progress: &dyn Progress) {
    let side = 1i32 << settings.depth;
    rows("sphere", [side; 2], sink, progress, |y, z, put| {
        let half = half_chord(side, y, z);
        for x in side / 2 - half..side / 2 + half {
            put(x, gradient([x, y, z], side));
        }
    });
}

/// The ball's voxels that have one of their 26 neighbours outside of it.
pub(super) fn shell(settings: &Settings, sink: Sink<'_>, progress: &dyn Progress) {
    let side = 1i32 << settings.depth;
    let middle = side / 2;
    rows("shell", [side; 2], sink, progress, |y, z, put| {
        let outer = half_chord(side, y, z);
        let inner = (-1..=1)
            .flat_map(|dz| (-1..=1).map(move |dy| half_chord(side, y + dy, z + dz)))
            .min()
            .map_or(0, |shortest| (shortest - 1).max(0));
        for x in (middle - outer..middle - inner).chain(middle + inner..middle + outer) {
            put(x, gradient([x, y, z], side));
        }
    });
}

/// Bars one voxel thin along the edges of a cubic lattice, both outer sides included; a colour for each direction and
/// one for the joints.
pub(super) fn truss(settings: &Settings, sink: Sink<'_>, progress: &dyn Progress) {
    let side = 1i32 << settings.depth;
    let mut on_lattice = vec![false; side as usize];
    for i in 0..=CELLS {
        on_lattice[((side - 1) * i / CELLS) as usize] = true;
    }
    rows("truss", [side; 2], sink, progress, |y, z, put| {
        let (at_z, at_y) = (on_lattice[z as usize], on_lattice[y as usize]);
        for x in 0..if at_z || at_y { side } else { 0 } {
            let color = match (on_lattice[x as usize], at_y, at_z) {
                (true, true, true) => 2,
                (false, true, true) => 0,
                (true, false, true) => 3,
                (true, true, false) => 5,
                _ => continue,
            };
            put(x, palette(color));
        }
    });
}

/// Straight wires from the middle of the face `x = 0` to 9 x 9 points of the far face. A wire has one voxel at each x,
/// the nearest to its line (halves upwards). Where wires meet, the first one's colour stays.
pub(super) fn wires(settings: &Settings, sink: Sink<'_>, progress: &dyn Progress) {
    let last = (1i32 << settings.depth) - 1;
    let middle = last / 2;
    progress.begin("generating wires", last as u64 + 1);
    let ends: Vec<i32> = (0..=SPACES).map(|i| last * i / SPACES).collect();
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

/// Sierpinski's tetrahedron: one node whose children 0, 3, 5 and 6, of which no two share a face, are itself.
pub(super) fn sierpinski(settings: &Settings) -> Graph {
    Graph {
        depth: settings.depth,
        mask: vec![0b0110_1001].into(),
        first: vec![0].into(),
        links: vec![0; 4].into(),
        color: vec![[226, 174, 88]].into(),
        normal: vec![PackedNormal::NONE].into(),
        voxels: 4u64.saturating_pow(settings.depth),
        ..Graph::default()
    }
}
