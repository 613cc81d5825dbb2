//! The last three levels of a subtree in one step, where all of a node's
//! samples fit a tile.
//!
//! For each open sample: the lanes of 64 parts, two finest voxels wide, whose
//! strips hold it, found in bytes as in a brick (`brick.rs`); then, part by
//! part, the first of its eight children that holds the sample with all bits
//! and the box. A part's strips hold those of its children, whose halves add up
//! to it, so the first child found is the one that the machine comes to first.

use super::brick;
use super::lanes::Isa;
use super::parts::{Parts, corner, in_order, linked};
use super::screen::ScreenRecord;
use super::subtree::Subtree;
use super::walk::{Walk, voxel_at};
use crate::project::OCCLUSION_ORDER;

/// The lane of a part that is a solid itself, behind those of its children.
const WHOLE: u32 = 8;

/// Draws a node three levels above the finest, whose window is no larger than
/// a tile and has something open; `false` if it is none for this: a solid, or
/// parts of different sizes or in different orders.
#[inline(always)]
pub(super) fn draw<I: Isa>(
    walk: &mut Walk<'_, I>,
    subtree: &Subtree,
    record: &ScreenRecord,
) -> bool {
    if !walk.switches.bricks || walk.view.search.is_some() {
        return false;
    }
    let Some((octant, parts)) = brick::prepare(walk, subtree, record) else {
        return false;
    };
    walk.isa.tall(walk, subtree, record, octant, &parts);
    true
}

/// Draws a node with even parts by samples.
#[inline(always)]
pub(super) fn draw_node<I: Isa>(
    walk: &mut Walk<'_, I>,
    subtree: &Subtree,
    record: &ScreenRecord,
    octant: u8,
    parts: &Parts,
) {
    walk.counters.bricks += 1;
    walk.counters.brick_samples += u64::from(record.open.count_ones());
    let isa = walk.isa;
    let [left, top] = [record.window.left, record.window.top];
    let half = isa.load(&subtree.half_width);
    // The functions at the square's first sample, relative to the lower bound
    // of a finest voxel in the node's centre; then to that of a part there.
    let first = isa.sub(isa.load(&subtree.bound), isa.load(&record.place));
    let first = isa.plus_times(first, isa.load(&subtree.step[0]), left - subtree.origin[0]);
    let first = isa.plus_times(first, isa.load(&subtree.step[1]), top - subtree.origin[1]);
    let first_of_part = isa.add(first, half);
    let mut count = 0;
    let mut open = record.open;
    while open != 0 {
        let bit = open.trailing_zeros();
        open &= open - 1;
        let value = walk.tables.value_at(isa, first_of_part, bit);
        let lanes = parts.lanes & isa.strips_within(&walk.tables.parts, value, false);
        walk.found[count & 63] = (bit, lanes);
        count += usize::from(lanes != 0);
    }
    let place = walk.pixels.at(left, top);
    let mut drawn = 0u64;
    for i in 0..count {
        let (bit, lanes) = walk.found[i & 63];
        let value = walk.tables.value_at(isa, first, bit);
        let Some(hit) = first_hit(walk, value, half, octant, parts, lanes) else {
            continue;
        };
        drawn |= 1 << bit;
        let at = place + (bit >> 3) as usize * walk.pixels.width + (bit & 7) as usize;
        let word = walk.pixels.word(hit.node);
        if let Some(shown) = walk.pixels.shown.get_mut(at) {
            *shown = word;
        }
        if walk.pixels.wants_voxels() {
            walk.pixels.voxel[at] = hit.voxel(subtree, record, octant);
        }
    }
    walk.counters.samples_drawn += u64::from(drawn.count_ones());
    walk.fill.mark_square(&record.window, drawn);
}

/// What a sample shows of a node three levels above the finest.
struct Hit {
    node: u32,
    /// The part, two finest voxels wide.
    part: u32,
    /// Its child in occlusion order, or [`WHOLE`].
    child: u32,
}

impl Hit {
    /// The voxel's lowest corner and level.
    #[inline(never)]
    fn voxel(&self, subtree: &Subtree, record: &ScreenRecord, octant: u8) -> [i32; 4] {
        let side = subtree.finest_side;
        let part = corner(record.min, 2, 2 * side, octant, self.part);
        if self.child == WHOLE {
            return voxel_at(part, subtree.finest - 1);
        }
        voxel_at(corner(part, 1, side, octant, self.child), subtree.finest)
    }
}

/// The first of the lanes' voxels that holds a sample. `value`: the functions
/// there, relative to the lower bound of a finest voxel in the node's centre;
/// `half`: half the width of such a voxel, without slack.
#[inline(always)]
fn first_hit<I: Isa>(
    walk: &Walk<'_, I>,
    value: I::Eight,
    half: I::Eight,
    octant: u8,
    parts: &Parts,
    lanes: u64,
) -> Option<Hit> {
    let (isa, graph, tables) = (walk.isa, walk.graph, &walk.tables);
    let mut lanes = lanes;
    while lanes != 0 {
        let part = lanes.trailing_zeros();
        lanes &= lanes - 1;
        let node = parts.node(graph, 2, octant, part);
        let mask = graph.mask(node);
        let in_part = tables.in_large_part(isa, value, part);
        let inside = isa.children_within(&tables.by_function, in_part, &tables.width);
        let inside = inside & in_order(octant, mask);
        if inside != 0 {
            let child = inside.trailing_zeros();
            let first = graph.first.get(node as usize).copied().unwrap_or(0);
            let octant = (octant ^ OCCLUSION_ORDER[child as usize & 7]) & 7;
            let before = mask & ((1u8 << octant) - 1);
            let node = linked(graph.links, first.wrapping_add(before.count_ones()));
            return Some(Hit { node, part, child });
        }
        if mask == 0 {
            let width = isa.load(&tables.width);
            let width = isa.add(width, isa.add(half, half));
            if isa.all_within(isa.add(in_part, half), width) {
                let child = WHOLE;
                return Some(Hit { node, part, child });
            }
        }
    }
    None
}
