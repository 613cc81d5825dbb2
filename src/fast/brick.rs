//! The last two levels of a subtree, or the last one, in one step.
//!
//! Two levels are 64 parts, one level 8: one lane each, in the order in which
//! the machine would come to them. For each open sample of a node's window:
//! the lanes that exist and whose strips hold the sample; the first of them is
//! what the sample shows. So the work is for samples, not for voxels, and
//! hidden parts cost nothing.
//!
//! The lanes are bytes: a function's value is cut to its upper bits, so that
//! 64 parts are one or two vectors. What the bytes find is a few parts too
//! many and never one too few; a voxel that they find is then looked at with
//! all bits and the box.

use super::canvas::Window;
use super::lanes::Isa;
use super::parts::{Parts, corner};
use super::screen::ScreenRecord;
use super::subtree::Subtree;
use super::walk::{Walk, voxel_at};

/// Draws a node one or two levels above the finest, in whose window
/// something is open; `false` if it is none for this: a solid, or parts of
/// different sizes or in different orders.
#[inline(always)]
pub(super) fn draw<I: Isa>(
    walk: &mut Walk<'_, I>,
    subtree: &Subtree,
    record: &ScreenRecord,
) -> bool {
    if !walk.switches.bricks {
        return false;
    }
    let Some((octant, parts)) = prepare(walk, subtree, record) else {
        return false;
    };
    walk.isa.brick(walk, subtree, record, octant, &parts);
    true
}

/// The octant in whose order the parts of a node lie, and the parts, with the
/// tables for them made; `None` if they are uneven.
#[inline(always)]
pub(super) fn prepare<I: Isa>(
    walk: &mut Walk<'_, I>,
    subtree: &Subtree,
    record: &ScreenRecord,
) -> Option<(u8, Parts)> {
    let side = subtree.finest_side << record.left;
    let octant = match subtree.octant {
        Some(octant) => octant,
        None => walk
            .view
            .common_octant(record.min, side, subtree.finest_side)?,
    };
    let parts = Parts::of(walk.isa, walk.graph, record.node, record.left, octant);
    if parts.is_uneven {
        return None;
    }
    if walk.tables.made_for != Some((record.left, octant)) {
        let isa = walk.isa;
        isa.tables(&mut walk.tables, subtree, record.left, octant);
    }
    Some((octant, parts))
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
    let brick = Brick {
        subtree,
        record,
        parts,
        octant,
    };
    if record.open != 0 {
        let corner = [record.window.left, record.window.top];
        let drawn = brick.draw_square(walk, corner, record.open);
        if drawn != 0 {
            walk.fill.mark_square(&record.window, drawn);
        }
    } else {
        brick.draw_squares(walk);
    }
}

/// A node that is drawn by samples.
struct Brick<'b> {
    subtree: &'b Subtree,
    record: &'b ScreenRecord,
    parts: &'b Parts,
    octant: u8,
}

impl Brick<'_> {
    /// Draws a node whose window is larger than a tile: by squares.
    #[inline(always)]
    fn draw_squares<I: Isa>(&self, walk: &mut Walk<'_, I>) {
        let window = self.record.window;
        let mut top = window.top;
        while top <= window.bottom {
            let mut left = window.left;
            while left <= window.right {
                let square = Window {
                    left,
                    top,
                    right: (left + 7).min(window.right),
                    bottom: (top + 7).min(window.bottom),
                };
                let open = walk.fill.open_in_square(walk.isa, &square);
                if open != 0 {
                    let drawn = self.draw_square(walk, [left, top], open);
                    walk.fill.mark_square(&square, drawn);
                }
                left += 8;
            }
            top += 8;
        }
    }

    /// Draws the open samples of a square; returns those drawn.
    #[inline(always)]
    fn draw_square<I: Isa>(&self, walk: &mut Walk<'_, I>, corner: [i32; 2], open: u64) -> u64 {
        walk.counters.brick_samples += u64::from(open.count_ones());
        // All that is the same for all samples is decided here.
        match (self.record.left == 1, walk.view.search.is_some()) {
            (false, false) => self.draw_samples::<I, false, false>(walk, corner, open),
            (true, false) => self.draw_samples::<I, true, false>(walk, corner, open),
            (false, true) => self.draw_samples::<I, false, true>(walk, corner, open),
            (true, true) => self.draw_samples::<I, true, true>(walk, corner, open),
        }
    }

    /// [`Brick::draw_square`] of a node one level above the finest (`FEW`) or
    /// two, in a frame without tolerance (`SEARCH`) or with one.
    ///
    /// Step by step for all samples, so that there are few branches: the lanes
    /// that bytes find; of those samples that have any, the first that is
    /// right; then the nodes.
    #[inline(always)]
    fn draw_samples<I: Isa, const FEW: bool, const SEARCH: bool>(
        &self,
        walk: &mut Walk<'_, I>,
        corner: [i32; 2],
        open: u64,
    ) -> u64 {
        let isa = walk.isa;
        let (step, origin) = (&self.subtree.step, &self.subtree.origin);
        // The functions at the square's first sample, relative to the lower
        // bound of a part in the node's centre.
        let first = isa.sub(isa.load(&walk.tables.half), isa.load(&self.record.place));
        let first = isa.plus_times(first, isa.load(&step[0]), corner[0] - origin[0]);
        let first = isa.plus_times(first, isa.load(&step[1]), corner[1] - origin[1]);
        let mut count = 0;
        let mut left = open;
        while left != 0 {
            let bit = left.trailing_zeros();
            left &= left - 1;
            let value = walk.tables.value_at(isa, first, bit);
            let lanes = self.parts.lanes & isa.strips_within(&walk.tables.parts, value, FEW);
            walk.found[count & 63] = (bit, lanes);
            count += usize::from(lanes != 0);
        }
        let place = walk.pixels.at(corner[0], corner[1]);
        let width = walk.pixels.width;
        let graph = walk.graph;
        let mut drawn = 0u64;
        let mut hits = 0;
        let mut i = 0;
        while i < count {
            let (bit, lanes) = walk.found[i & 63];
            i += 1;
            if let Some(lane) = self.first_inside::<I, FEW, SEARCH>(walk, first, bit, corner, lanes)
            {
                walk.found[hits & 63] = (bit, u64::from(lane));
                hits += 1;
                drawn |= 1 << bit;
                let at = place + (bit >> 3) as usize * width + (bit & 7) as usize;
                let levels = if FEW { 1 } else { 2 };
                let node = self.parts.node(graph, levels, self.octant, lane);
                let word = walk.pixels.word(node);
                if let Some(shown) = walk.pixels.shown.get_mut(at) {
                    *shown = word;
                }
            }
        }
        if walk.pixels.wants_voxels() {
            self.show_voxels(walk, place, hits);
        }
        walk.counters.samples_drawn += hits as u64;
        drawn
    }

    /// Shows the finest voxels that were found.
    #[inline(never)]
    fn show_voxels<I: Isa>(&self, walk: &mut Walk<'_, I>, place: usize, hits: usize) {
        for &(bit, lane) in &walk.found[..hits] {
            let at = place + (bit >> 3) as usize * walk.pixels.width + (bit & 7) as usize;
            let min = self.corner(lane as u32);
            walk.pixels.voxel[at] = voxel_at(min, self.subtree.finest);
        }
    }

    /// The lowest corner of a lane's finest voxel.
    fn corner(&self, lane: u32) -> [i32; 3] {
        let (record, side) = (self.record, self.subtree.finest_side);
        corner(record.min, record.left, side, self.octant, lane)
    }

    /// The first of the lanes that a sample is inside. `first`: the functions
    /// at the square's first sample, relative to the lower bound of a finest
    /// voxel in the node's centre.
    #[inline(always)]
    fn first_inside<I: Isa, const FEW: bool, const SEARCH: bool>(
        &self,
        walk: &mut Walk<'_, I>,
        first: I::Eight,
        bit: u32,
        square: [i32; 2],
        lanes: u64,
    ) -> Option<u32> {
        let isa = walk.isa;
        let value = walk.tables.value_at(isa, first, bit);
        let mut lanes = lanes;
        while lanes != 0 {
            let lane = lanes.trailing_zeros();
            lanes &= lanes - 1;
            let levels = if FEW { 1 } else { 2 };
            let in_part = walk.tables.in_part(isa, value, levels, lane);
            if !isa.all_within(in_part, isa.load(&walk.tables.width)) {
                continue;
            }
            if !SEARCH {
                return Some(lane);
            }
            let [less, width] = &walk.tables.sure;
            if walk.tables.has_sure
                && isa.all_within(isa.sub(in_part, isa.load(less)), isa.load(width))
            {
                return Some(lane);
            }
            walk.counters.exact_samples += 1;
            let at = [square[0] + (bit & 7) as i32, square[1] + (bit >> 3) as i32];
            let side = self.subtree.finest_side;
            if isa.covers(walk.exact, self.corner(lane), side, at) {
                return Some(lane);
            }
        }
        None
    }
}
