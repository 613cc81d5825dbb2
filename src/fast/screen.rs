//! Records in screen space: places in the lattice of a subtree.

use super::brick;
use super::canvas::{Extent, TILE_LOG2, Window, Windows, tiles_of};
use super::clip::ClipRecord;
use super::lanes::Isa;
use super::parts::{self, Parts, corner as corner_of};
use super::subtree::{LANES, STRIPS, Subtree};
use super::tall;
use super::walk::{Walk, voxel_at};
use crate::project::OCCLUSION_ORDER;

/// A node in screen space whose turn has come.
#[derive(Debug, Clone, Copy)]
pub(super) struct ScreenRecord {
    pub(super) node: u32,
    /// Levels from here to the finest voxels of the subtree.
    pub(super) left: u32,
    /// Lowest corner, finest voxels of the object.
    pub(super) min: [i32; 3],
    /// The functions' values at its centre, relative to the subtree's origin.
    pub(super) place: [i32; LANES],
    /// The samples that its box holds.
    pub(super) window: Window,
    /// Where the window is no larger than a tile: its open samples, eight
    /// bits a row. Else 0.
    pub(super) open: u64,
}

/// What there is to draw in a window: its open samples where it is no larger
/// than a tile, else 0; `None` if nothing is.
#[inline(always)]
fn open_in<I: Isa>(walk: &mut Walk<'_, I>, window: &Window, extent: Extent) -> Option<u64> {
    if extent == Extent::Square {
        let open = walk.fill.open_in_square(walk.isa, window);
        if open == 0 && walk.switches.hidden {
            walk.counters.skipped_hidden += 1;
            return None;
        }
        return Some(open);
    }
    // Empty ones come here only where off-screen nodes are looked into.
    if extent != Extent::Empty && walk.switches.hidden && !walk.fill.has_open_tile(window) {
        walk.counters.skipped_hidden += 1;
        return None;
    }
    Some(0)
}

/// [`open_in`] of one of the windows of a record's children.
#[inline(always)]
fn open_in_child<I: Isa>(walk: &mut Walk<'_, I>, windows: &Windows, child: u8) -> Option<u64> {
    let octant = usize::from(child & 7);
    if windows.square >> octant & 1 == 0 {
        let window = windows.at(octant);
        return open_in(walk, &window, window.extent());
    }
    let (x, y) = (
        windows.left[octant] as u32 & 7,
        windows.top[octant] as u32 & 7,
    );
    let (tile, shape) = (windows.tile[octant] as usize, windows.shape[octant] as u32);
    let open = walk.fill.open_in_shape(walk.isa, tile, x, y, shape);
    if open == 0 && walk.switches.hidden {
        walk.counters.skipped_hidden += 1;
        return None;
    }
    Some(open)
}

/// Goes on with a record that just changed to screen space.
#[inline(always)]
pub(super) fn start<I: Isa>(
    walk: &mut Walk<'_, I>,
    subtree: &Subtree,
    record: &ClipRecord,
    place: I::Eight,
) {
    let isa = walk.isa;
    let left = subtree.finest - record.level;
    let bias = subtree.window_bias(left);
    let (window, extent) = isa.window(place, &bias, subtree, &walk.bounds);
    if extent == Extent::Empty && walk.switches.off_screen {
        walk.counters.skipped_off_screen += 1;
        return;
    }
    let Some(open) = open_in(walk, &window, extent) else {
        return;
    };
    let record = ScreenRecord {
        node: record.node,
        left,
        min: record.min,
        place: isa.store(place),
        window,
        open,
    };
    step(walk, subtree, &record);
}

/// A record with something to draw: a solid, or a brick, or its turn.
#[inline(always)]
fn step<I: Isa>(walk: &mut Walk<'_, I>, subtree: &Subtree, record: &ScreenRecord) {
    if record.left == 0 {
        draw_solid(walk, subtree, record);
        return;
    }
    if record.left <= 2 && !subtree.is_coarse && brick::draw(walk, subtree, record) {
        return;
    }
    if record.left == 3
        && record.open != 0
        && !subtree.is_coarse
        && tall::draw(walk, subtree, record)
    {
        return;
    }
    if !walk.switches.absent_children {
        walk.isa.absent(walk, subtree, record);
    }
    walk.isa.screen(walk, subtree, record);
}

/// By octant and axis: all ones where a child lies in the upper half.
static BEYOND: [[i32; 3]; 8] = [
    [0, 0, 0],
    [0, 0, -1],
    [0, -1, 0],
    [0, -1, -1],
    [-1, 0, 0],
    [-1, 0, -1],
    [-1, -1, 0],
    [-1, -1, -1],
];

/// A record's turn: it is drawn, or its children have their turns, nearest first.
#[inline(always)]
pub(super) fn turn<I: Isa>(walk: &mut Walk<'_, I>, subtree: &Subtree, record: &ScreenRecord) {
    walk.counters.screen_records += 1;
    let mask = walk.graph.mask(record.node);
    let first = walk.graph.first.get(record.node as usize).copied();
    let (Some(first), true) = (first, mask != 0) else {
        draw_solid(walk, subtree, record);
        return;
    };
    let isa = walk.isa;
    let half = (subtree.finest_side << record.left) / 2;
    let octant = match subtree.octant {
        Some(octant) => octant,
        None => walk.view.octant(record.min, half),
    };
    let left = record.left - 1;
    walk.counters.skipped_absent += u64::from(mask.count_zeros());
    let bias = subtree.window_bias(left);
    let windows = isa.windows(&record.place, left, &bias, subtree, &walk.bounds);
    let mut wanted = mask;
    if walk.switches.off_screen {
        wanted &= windows.held;
        walk.counters.skipped_off_screen += u64::from((mask ^ wanted).count_ones());
    }
    let mut order = parts::in_order(octant, wanted);
    if left == 0 && record.open != 0 && has_square(walk, subtree) {
        order &= parts::in_order(octant, windows.held);
        draw_family(walk, subtree, record, &windows, (octant, order));
        return;
    }
    let parent = isa.load(&record.place);
    while order != 0 {
        let child = octant ^ OCCLUSION_ORDER[order.trailing_zeros() as usize & 7];
        order &= order - 1;
        let Some(open) = open_in_child(walk, &windows, child & 7) else {
            continue;
        };
        let offset = isa.load(&subtree.child[usize::from(child & 7)]);
        let at = isa.plus_shifted(parent, offset, left);
        let before = mask & ((1u8 << (child & 7)) - 1);
        let slot = first.wrapping_add(before.count_ones());
        let mut min = record.min;
        let beyond = &BEYOND[usize::from(child & 7)];
        min[0] += beyond[0] & half;
        min[1] += beyond[1] & half;
        min[2] += beyond[2] & half;
        let record = ScreenRecord {
            node: parts::linked(walk.graph.links, slot),
            left,
            min,
            place: isa.store(at),
            window: windows.at(usize::from(child & 7)),
            open,
        };
        step(walk, subtree, &record);
    }
}

/// Whether solids of the finest level can be drawn with sixteen bits a
/// sample. Makes the table for that, unless it is made.
#[inline(always)]
fn has_square<I: Isa>(walk: &mut Walk<'_, I>, subtree: &Subtree) -> bool {
    if walk.view.search.is_some() {
        return false;
    }
    walk.tables.make_square(walk.isa, subtree);
    walk.tables.fits_square
}

/// Draws a record's children of the finest level, nearest first, in their
/// parent's window, which is no larger than a tile: its open samples are
/// looked up and marked once for all of them. `order`: the octant of the
/// nearest child, and the children in occlusion order.
#[inline(always)]
fn draw_family<I: Isa>(
    walk: &mut Walk<'_, I>,
    subtree: &Subtree,
    record: &ScreenRecord,
    windows: &Windows,
    (octant, mut order): (u8, u8),
) {
    let isa = walk.isa;
    let parts = Parts::of(isa, walk.graph, record.node, 1, octant);
    let corner = [record.window.left, record.window.top];
    let first = isa.sub(isa.load(&subtree.bound), isa.load(&record.place));
    let first = isa.plus_times(
        first,
        isa.load(&subtree.step[0]),
        corner[0] - subtree.origin[0],
    );
    let first = isa.plus_times(
        first,
        isa.load(&subtree.step[1]),
        corner[1] - subtree.origin[1],
    );
    let mut open = record.open;
    while order != 0 {
        let lane = order.trailing_zeros();
        let child = usize::from((octant ^ OCCLUSION_ORDER[lane as usize & 7]) & 7);
        order &= order - 1;
        let inside = open & windows.in_square(child, corner);
        if inside == 0 && walk.switches.hidden {
            walk.counters.skipped_hidden += 1;
            continue;
        }
        walk.counters.solids += 1;
        let start = isa.sub(first, isa.load(&subtree.child[child]));
        let samples = inside & isa.square_within(&walk.tables.square, start, &subtree.bound);
        if samples != 0 {
            let node = parts.node(walk.graph, 1, octant, lane);
            let min = corner_of(record.min, 1, subtree.finest_side, octant, lane);
            let voxel = voxel_at(min, subtree.finest);
            open ^= walk.show(corner, samples, node, voxel);
        }
    }
    let drawn = open ^ record.open;
    walk.counters.samples_drawn += u64::from(drawn.count_ones());
    walk.fill.mark_square(&record.window, drawn);
}

/// Does for a record's children that do not exist what is done for others
/// before their turn, for who wants to know what leaving them saves.
#[inline(always)]
pub(super) fn look_at_absent<I: Isa>(
    walk: &mut Walk<'_, I>,
    subtree: &Subtree,
    record: &ScreenRecord,
) {
    let isa = walk.isa;
    let mask = walk.graph.mask(record.node);
    if mask == 0 {
        return;
    }
    let left = record.left - 1;
    let bias = subtree.window_bias(left);
    let parent = isa.load(&record.place);
    for child in (0..8).filter(|child| mask >> child & 1 == 0) {
        let at = isa.plus_shifted(parent, isa.load(&subtree.child[child]), left);
        let (window, extent) = isa.window(at, &bias, subtree, &walk.bounds);
        if extent == Extent::Empty && walk.switches.off_screen {
            walk.counters.skipped_off_screen += 1;
            continue;
        }
        std::hint::black_box(open_in(walk, &window, extent));
    }
}

/// Draws a solid: the samples of its window that lie in its three strips.
#[inline(always)]
fn draw_solid<I: Isa>(walk: &mut Walk<'_, I>, subtree: &Subtree, record: &ScreenRecord) {
    if walk.view.search.is_some() {
        draw_outline(walk, subtree, record);
    } else if record.open == 0 || !draw_square(walk, subtree, record) {
        walk.isa.tiles(walk, subtree, record);
    }
}

/// Draws a solid by its exact silhouette.
#[inline(never)]
fn draw_outline<I: Isa>(walk: &mut Walk<'_, I>, subtree: &Subtree, record: &ScreenRecord) {
    let side = subtree.finest_side << record.left;
    let outline = walk.exact.outline(record.min, side, true);
    let voxel = voxel_at(record.min, subtree.finest - record.left);
    outline.draw(walk, &record.window, record.node, voxel);
}

/// Draws a solid whose window is no larger than a tile, with sixteen bits a
/// sample; `false` if those are too few, or their table is not made.
#[inline(always)]
fn draw_square<I: Isa>(walk: &mut Walk<'_, I>, subtree: &Subtree, record: &ScreenRecord) -> bool {
    if !walk.tables.fits_square || record.left > 0 {
        return false;
    }
    walk.counters.solids += 1;
    let isa = walk.isa;
    let window = &record.window;
    let start = isa.sub(isa.load(&subtree.bound), isa.load(&record.place));
    let start = isa.plus_times(
        start,
        isa.load(&subtree.step[0]),
        window.left - subtree.origin[0],
    );
    let start = isa.plus_times(
        start,
        isa.load(&subtree.step[1]),
        window.top - subtree.origin[1],
    );
    let samples = record.open & isa.square_within(&walk.tables.square, start, &subtree.bound);
    if samples != 0 {
        let voxel = voxel_at(record.min, subtree.finest);
        let corner = [window.left, window.top];
        let drawn = walk.show(corner, samples, record.node, voxel);
        walk.counters.samples_drawn += u64::from(drawn.count_ones());
        walk.fill.mark_square(window, drawn);
    }
    true
}

/// Draws a solid of any size, tile by tile.
#[inline(always)]
pub(super) fn draw_tiles<I: Isa>(walk: &mut Walk<'_, I>, subtree: &Subtree, record: &ScreenRecord) {
    walk.counters.solids += 1;
    walk.tables.make_square(walk.isa, subtree);
    walk.tables.make_tile(subtree);
    let window = &record.window;
    let voxel = voxel_at(record.min, subtree.finest - record.left);
    let tiles = tiles_of(window);
    for y in tiles.top..=tiles.bottom {
        for x in tiles.left..=tiles.right {
            let mut samples = walk.fill.open_in_tile(x, y, window);
            if samples == 0 {
                continue;
            }
            let (left, top) = (x << TILE_LOG2, y << TILE_LOG2);
            for f in 0..STRIPS {
                let half = (subtree.half_width[f] << record.left) + subtree.reach[f];
                let first = subtree.step[0][f] * (left - subtree.origin[0])
                    + subtree.step[1][f] * (top - subtree.origin[1])
                    - record.place[f];
                samples &=
                    walk.isa
                        .within_wide(&walk.tables.tile[f], first + half, 2 * half as u32);
            }
            if samples != 0 {
                walk.counters.tiles_filled += u64::from(samples == u64::MAX);
                let drawn = walk.show([left, top], samples, record.node, voxel);
                walk.counters.samples_drawn += u64::from(drawn.count_ones());
                walk.fill.mark_tile(x, y, drawn);
            }
        }
    }
}
