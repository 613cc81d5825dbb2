//! The walk from the object down to bricks, and what its turns share.
//!
//! ```text
//! turn(node): for each child that exists, nearest first (by the side of the eye that it is on):
//!     leave it if its window holds no open sample
//!     a solid, or one whose parts are:           draw it (voxels, bricks)
//!     else, or if it reaches behind the eye:     turn(child)
//! ```
//!
//! Nodes' clip vectors are exact; windows are wider than the truth by their rounding.

use super::lanes::Windows;
use super::orders::turned;
use super::parts::Parts;
use super::planes;
use super::state::{Brick, Compiled, Record, Walk, voxel_at};
use super::view::{Level, View};
use super::window::Window;

/// Looks at the whole object.
pub(super) fn start<I: Compiled>(walk: &mut Walk<'_, I>) {
    let record = Record {
        node: walk.graph.root,
        level: 0,
        min: [0; 3],
        centre: walk.view.centre,
    };
    let window = walk.fill.bounds;
    if record.centre[2] + walk.view.levels[0].half_depth <= 0.0 {
        walk.counters.skipped_behind += 1;
        return;
    }
    go_on(walk, &record, &window);
}

/// Draws a node of which something may be seen in a window, or looks at its children.
#[inline(always)]
fn go_on<I: Compiled>(walk: &mut Walk<'_, I>, record: &Record, window: &Window) {
    let (view, isa) = (walk.view, walk.isa);
    let level = &view.levels[record.level as usize];
    let least_depth = record.centre[2] - level.half_depth;
    let mask = if record.level == view.depth {
        0
    } else {
        walk.graph.mask(record.node)
    };
    let is_near = least_depth <= 0.0;
    if mask == 0 || least_depth >= level.lod_depth {
        walk.counters.skipped_detail += u64::from(mask != 0);
        if is_near || record.centre[2] < level.large_depth || !walk.switches.bricks {
            draw_planes(walk, record, window, !is_near);
        } else {
            let parts = &Parts::of_solid(record.node);
            isa.voxels(walk, Brick { record, parts }, window);
        }
        return;
    }
    if is_near || !walk.switches.bricks {
        isa.turn(walk, record);
        return;
    }
    if record.centre[2] > level.fine_depth && is_deep(view, record, least_depth) {
        let parts = Parts::of(isa, walk.graph, record.node, false, 0);
        if parts.are_even() {
            let parts = &parts;
            isa.deep_brick(walk, Brick { record, parts }, window);
            return;
        }
    }
    // Parts that are all solids, and not too large.
    let parts_level = record.level + 2;
    let are_solid =
        parts_level >= view.depth || least_depth >= view.levels[parts_level as usize].lod_depth;
    if are_solid && record.centre[2] >= 0.25 * level.large_depth {
        let is_last = record.level + 1 == view.depth;
        let parts = Parts::of(isa, walk.graph, record.node, is_last, detail(view, record));
        // What is blended is taken once, so no voxel may be of several parts.
        if parts.are_even() || view.opacity_eye.is_none() {
            let parts = &parts;
            let brick = Brick { record, parts };
            if record.centre[2] < level.coarse_depth {
                isa.voxels(walk, brick, window);
            } else {
                isa.brick(walk, brick, window);
            }
            return;
        }
    }
    isa.turn(walk, record);
}

/// Whether level of detail, and the object, end a node's branches four levels below and not before.
#[inline(always)]
fn is_deep(view: &View, record: &Record, least_depth: f64) -> bool {
    let ends = record.level as usize + 4;
    if ends > view.depth as usize {
        return false;
    }
    let greatest_depth = record.centre[2] + view.levels[record.level as usize].half_depth;
    // The depths fall from level to level.
    greatest_depth < view.levels[ends - 1].lod_depth
        && (ends == view.depth as usize || least_depth >= view.levels[ends].lod_depth)
}

/// A node's children that level of detail takes for solids, if they have children.
#[inline(always)]
fn detail(view: &View, record: &Record) -> u8 {
    let (own, below) = (
        &view.levels[record.level as usize],
        &view.levels[record.level as usize + 1],
    );
    if record.centre[2] + own.half_depth < below.lod_depth {
        return 0;
    }
    let is_solid = |octant: usize| {
        let least = record.centre[2] + own.child[2][octant] - below.half_depth;
        u8::from(least >= below.lod_depth) << octant
    };
    (0..8).map(is_solid).sum()
}

/// A record's turn: its children have theirs, nearest first.
#[inline(always)]
pub(super) fn turn<I: Compiled>(walk: &mut Walk<'_, I>, record: &Record) {
    walk.counters.nodes += 1;
    let view = walk.view;
    let index = record.level as usize;
    let level = &view.levels[index];
    let mask = walk.graph.mask(record.node);
    let half = level.side / 2;
    let nearest = view.nearest_octant(record.min, half);
    let windows = walk
        .isa
        .windows(view, index, &record.centre, &walk.fill.bounds);
    walk.counters.skipped_absent += u64::from(mask.count_zeros());
    if !walk.switches.absent_children {
        look_at_absent(walk, &windows, !mask);
        walk.counters.skipped_absent = 0;
    }
    let mut wanted = mask;
    if walk.switches.off_screen {
        wanted &= windows.held | windows.near;
        walk.counters.skipped_off_screen += u64::from((mask ^ wanted).count_ones());
    }
    let mut order = turned(wanted, nearest);
    while order != 0 {
        let child = order.trailing_zeros() as u8 ^ nearest;
        order &= order - 1;
        if walk.fill.open == 0 && walk.switches.full {
            walk.counters.skipped_full += 1;
            return;
        }
        let mut window = windows.at(child);
        let octant = usize::from(child & 7);
        let centre = [0, 1, 2].map(|c| record.centre[c] + level.child[c][octant]);
        if windows.near >> child & 1 != 0 {
            let below = &view.levels[index + 1];
            if centre[2] + below.half_depth <= 0.0 {
                walk.counters.skipped_behind += 1;
                continue;
            }
            if walk.switches.off_screen && is_beside(below, &centre) {
                walk.counters.skipped_off_screen += 1;
                continue;
            }
            window = walk.fill.bounds;
        } else if windows.held >> child & 1 == 0 {
            // Looked into only for measurements.
            window = walk.fill.bounds;
        }
        if walk.switches.hidden && !walk.fill.is_open(&window) {
            walk.counters.skipped_hidden += 1;
            continue;
        }
        let Some(node) = walk.graph.child(record.node, child) else {
            continue;
        };
        let bit = |k: usize| (octant as i32 >> (2 - k) & 1) * half;
        let child = Record {
            node,
            level: record.level + 1,
            min: [
                record.min[0] + bit(0),
                record.min[1] + bit(1),
                record.min[2] + bit(2),
            ],
            centre,
        };
        go_on(walk, &child, &window);
    }
}

/// Does for children that do not exist what is done for others before their
/// turn: to measure what leaving them out saves.
#[inline(never)]
fn look_at_absent<I: Compiled>(walk: &mut Walk<'_, I>, windows: &Windows, absent: u8) {
    let held = absent & windows.held & !windows.near;
    walk.counters.skipped_off_screen += u64::from((absent & !held).count_ones());
    for child in (0..8).filter(|child| held >> child & 1 != 0) {
        let is_open = walk.fill.is_open(&windows.at(child));
        walk.counters.skipped_hidden += u64::from(!is_open);
    }
}

/// Whether a box that is partly behind the eye lies beside the picture: all
/// its vertices are beyond one of the picture root's edges. Exact numbers;
/// linear in the vertices, so what holds for all eight holds for every point.
#[inline(never)]
fn is_beside(level: &Level, centre: &[f64; 3]) -> bool {
    (0..2).any(|axis| {
        let mut left = true;
        let mut right = true;
        for i in 0..8 {
            let at = |c: usize| centre[c] + level.vertices[c][i];
            left &= at(axis) < 0.0;
            right &= at(2) < at(axis);
        }
        left || right
    })
}

/// Draws a solid by its planes.
#[inline(never)]
fn draw_planes<I: Compiled>(
    walk: &mut Walk<'_, I>,
    record: &Record,
    window: &Window,
    is_before_eye: bool,
) {
    let side = walk.view.levels[record.level as usize].side;
    let outline = walk.exact.outline(record.min, side, is_before_eye);
    let voxel = voxel_at(record.min, record.level);
    planes::draw(walk, &outline, window, record.node, voxel);
}
