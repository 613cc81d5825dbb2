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

use super::bricks::{Brick, Hit};
use super::canvas::{Fill, Pixels, Window};
use super::counters::Counters;
use super::exact::Exact;
use super::lanes::{Found, Isa, Windows};
use super::parts::{self, Parts};
use super::switches::Switches;
use super::view::{Level, View};
use crate::graph::GraphView;

/// The walk over one band of the picture.
#[derive(Debug)]
pub(super) struct Walk<'w, I> {
    pub(super) isa: I,
    pub(super) view: &'w View,
    pub(super) exact: &'w Exact,
    pub(super) graph: &'w GraphView<'w>,
    pub(super) switches: &'w Switches,
    pub(super) fill: Fill<'w>,
    pub(super) pixels: Pixels<'w>,
    pub(super) counters: Counters,
    /// Whether voxels are blended.
    pub(super) blends: bool,
    /// How far a square's samples are from its first one in the picture.
    pub(super) places: [u32; 64],
    /// Parts by sample of the square that is worked on.
    pub(super) found: Found,
    /// What its samples show.
    pub(super) hits: [Hit; 64],
    /// Their nodes, of bricks of four levels where nothing is blended.
    pub(super) nodes: [u32; 64],
    /// The blocks of the brick of four levels that is worked on.
    pub(super) blocks: &'w mut Blocks,
}

/// The blocks of a brick of four levels: its parts, with theirs.
#[derive(Debug)]
pub(super) struct Blocks {
    /// By number in order of occlusion: parts, in that order too.
    pub(super) exist: [u64; 64],
    pub(super) parts: [Parts; 64],
}

impl Default for Blocks {
    fn default() -> Self {
        Self {
            exist: [0; 64],
            parts: [Parts::default(); 64],
        }
    }
}

/// A node whose turn has come.
#[derive(Debug, Clone, Copy)]
pub(super) struct Record {
    pub(super) node: u32,
    pub(super) level: u32,
    /// Lowest corner, finest voxels.
    pub(super) min: [i32; 3],
    /// Clip vector (X, Y, W) of the centre.
    pub(super) centre: [f64; 3],
}

/// What a picture shows of a voxel: its lowest corner, and its level.
#[inline(always)]
pub(super) fn voxel_at(min: [i32; 3], level: u32) -> [i32; 4] {
    [min[0], min[1], min[2], level as i32]
}

/// Looks at the whole object.
pub(super) fn start<I: Isa>(walk: &mut Walk<'_, I>) {
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
fn go_on<I: Isa>(walk: &mut Walk<'_, I>, record: &Record, window: &Window) {
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
        isa.walk(walk, record);
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
    isa.walk(walk, record);
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
pub(super) fn turn<I: Isa>(walk: &mut Walk<'_, I>, record: &Record) {
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
    let mut order = parts::turned(wanted, nearest);
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
/// turn, for who wants to know what leaving them saves.
#[inline(never)]
fn look_at_absent<I: Isa>(walk: &mut Walk<'_, I>, windows: &Windows, absent: u8) {
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
fn draw_planes<I: Isa>(
    walk: &mut Walk<'_, I>,
    record: &Record,
    window: &Window,
    is_before_eye: bool,
) {
    let side = walk.view.levels[record.level as usize].side;
    let outline = walk.exact.outline(record.min, side, is_before_eye);
    let voxel = voxel_at(record.min, record.level);
    outline.draw(walk, window, record.node, voxel);
}
