//! Records in clip space: exact whole numbers, as the machine has them.

use super::canvas::Window;
use super::lanes::{Isa, Reals};
use super::screen;
use super::subtree::{Lattice, Subtree};
use super::view::{Level, Vertices, View};
use super::walk::{Walk, voxel_at};
use crate::project::OCCLUSION_ORDER;
use crate::project::setup::SCREEN_GUARD_SHIFT;

/// A node in clip space whose turn has come.
#[derive(Debug, Clone, Copy)]
pub(super) struct ClipRecord {
    pub(super) node: u32,
    pub(super) level: u32,
    /// Lowest corner, finest voxels.
    pub(super) min: [i32; 3],
    /// Clip vector (X, Y, W) of the lowest corner.
    pub(super) corner: [f64; 3],
    /// Samples that it may draw.
    pub(super) window: Window,
}

/// Looks at the whole object.
pub(super) fn start<I: Isa>(walk: &mut Walk<'_, I>) {
    let corner = walk.view.origin;
    let level = &walk.view.levels[0];
    let Some(window) = window_of(walk, level, corner) else {
        return;
    };
    let record = ClipRecord {
        node: walk.graph.root,
        level: 0,
        min: [0; 3],
        corner,
        window,
    };
    walk.isa.clip(walk, &record);
}

/// A record's turn: it changes to screen space, or is drawn, or its children
/// have their turns, nearest first.
#[inline(always)]
pub(super) fn turn<I: Isa>(walk: &mut Walk<'_, I>, record: &ClipRecord) {
    if walk.is_lost {
        return;
    }
    walk.counters.clip_records += 1;
    let view = walk.view;
    let level = &view.levels[record.level as usize];
    let w_min = record.corner[2] + level.w_span[0];
    if w_min >= level.screen_depth && walk.isa.change(walk, record) {
        return;
    }
    let mask = if record.level == view.depth {
        0
    } else {
        walk.graph.mask(record.node)
    };
    if mask == 0 || w_min >= level.lod_depth {
        walk.counters.skipped_detail += u64::from(mask != 0);
        draw_solid(walk, record, w_min > 0.0);
        return;
    }
    let half = level.side / 2;
    let octant = view.octant(record.min, half);
    let child_level = &view.levels[record.level as usize + 1];
    walk.counters.skipped_absent += u64::from(mask.count_zeros());
    for nearest in OCCLUSION_ORDER {
        let child = octant ^ nearest;
        if mask >> child & 1 == 0 && walk.switches.absent_children {
            continue;
        }
        if walk.fill.open == 0 && walk.switches.full {
            walk.counters.skipped_full += 1;
            return;
        }
        let offset = level.child[usize::from(child)];
        let corner = [0, 1, 2].map(|c| record.corner[c] + offset[c]);
        let Some(window) = window_of(walk, child_level, corner) else {
            continue;
        };
        let Some(node) = walk.graph.child(record.node, child) else {
            continue;
        };
        let bit = |k: u8| i32::from(child >> (2 - k) & 1) * half;
        let child = ClipRecord {
            node,
            level: record.level + 1,
            min: [0, 1, 2].map(|k| record.min[k as usize] + bit(k)),
            corner,
            window,
        };
        walk.isa.clip(walk, &child);
    }
}

/// Changes a record to screen space and goes on there, if it may change.
#[inline(always)]
pub(super) fn change<I: Isa>(walk: &mut Walk<'_, I>, record: &ClipRecord) -> bool {
    let (isa, view) = (walk.isa, walk.view);
    let level = &view.levels[record.level as usize];
    let vertices = vertices(isa, level, record.corner);
    if !is_within_guard(isa, &vertices) {
        return false;
    }
    let w_max = record.corner[2] + level.w_span[1];
    let w_min = record.corner[2] + level.w_span[0];
    let Some(finest) = finest_level(view, record.level, [w_min, w_max]) else {
        return false;
    };
    let Some(lattice) = Lattice::new(isa, view, &vertices, record, finest, w_min) else {
        walk.is_lost = true;
        return true;
    };
    let subtree = Subtree::new(isa, view, record, &lattice);
    walk.counters.changes += 1;
    walk.counters.skipped_detail += u64::from(subtree.finest < view.depth);
    walk.tables.forget();
    walk.aim_at(record.min, record.level);
    if subtree.is_coarse && view.search.is_none() {
        walk.tables.make_square(isa, &subtree);
    }
    screen::start(walk, &subtree, record, lattice.place);
    true
}

/// Clip vectors of the vertices of a voxel whose lowest corner is here: by
/// coordinate, then in Morton order.
#[inline(always)]
fn vertices<I: Isa>(isa: I, level: &Level, corner: [f64; 3]) -> [I::Reals; 3] {
    [
        isa.reals(&level.vertices[0]) + isa.real(corner[0]),
        isa.reals(&level.vertices[1]) + isa.real(corner[1]),
        isa.reals(&level.vertices[2]) + isa.real(corner[2]),
    ]
}

/// In a frame without tolerance, the level whose nodes are solids by level of
/// detail, in all of a subtree and not before; `None`: not the same in all.
/// Else as the lattice has it: the depth.
#[inline(always)]
fn finest_level(view: &View, level: u32, [w_min, w_max]: [f64; 2]) -> Option<u32> {
    if view.search.is_none() {
        return Some(view.depth);
    }
    let mut finest = level;
    while finest < view.depth {
        let depth = view.levels[finest as usize].lod_depth;
        if w_min >= depth {
            return Some(finest);
        }
        if w_max >= depth {
            return None;
        }
        finest += 1;
    }
    Some(finest)
}

/// Whether a box leaves the picture by no more than an eighth of it.
#[inline(always)]
fn is_within_guard<I: Isa>(isa: I, [x, y, w]: &[I::Reals; 3]) -> bool {
    let scale = isa.real(f64::from(1u32 << SCREEN_GUARD_SHIFT));
    let least = scale.fused(x.least(*y), *w);
    let most = scale.fused(*w - x.greatest(*y), *w);
    !least.least(most).any_negative()
}

/// The samples that a box may draw, or `None` if it can be left: behind the
/// eye, beside the picture, without sample, or all drawn.
#[inline(always)]
fn window_of<I: Isa>(walk: &mut Walk<'_, I>, level: &Level, corner: [f64; 3]) -> Option<Window> {
    let view = walk.view;
    if corner[2] + level.w_span[1] <= 0.0 {
        walk.counters.skipped_behind += 1;
        return None;
    }
    let mut window = walk.fill.bounds;
    if corner[2] + level.w_span[0] > 0.0 {
        let vertices = vertices(walk.isa, level, corner);
        let seen = samples_of(walk.isa, view, &vertices).and(&window);
        if seen.is_empty() && walk.switches.off_screen {
            walk.counters.skipped_off_screen += 1;
            return None;
        }
        window = seen;
    } else if walk.switches.off_screen && is_beside(view, &level.vertices_at(corner)) {
        walk.counters.skipped_off_screen += 1;
        return None;
    }
    if walk.switches.hidden && !window.is_empty() && !walk.fill.is_open(walk.isa, &window) {
        walk.counters.skipped_hidden += 1;
        return None;
    }
    Some(window)
}

/// The samples in a box's window. All vertices are before the eye.
#[inline(always)]
fn samples_of<I: Isa>(isa: I, view: &View, [x, y, w]: &[I::Reals; 3]) -> Window {
    // Rounded, which the margin has room for.
    let unit = isa.real(view.root_samples).over(*w);
    isa.samples_between(*x * unit, *y * unit, view.margin)
}

/// Whether a box that is partly behind the eye lies beside the picture: all
/// its vertices are beyond one of the picture's edges, with the margin.
#[inline(always)]
fn is_beside(view: &View, vertices: &Vertices) -> bool {
    let margin = view.margin / view.root_samples;
    // Linear in the vertices: what holds for all eight holds for every point.
    (0..2).any(|axis| {
        let mut left = true;
        let mut right = true;
        for i in 0..8 {
            let (x, w) = (vertices[axis][i], vertices[2][i]);
            left &= x + margin * w < 0.0;
            right &= w - x + margin * w < 0.0;
        }
        left || right
    })
}

/// Draws a solid by its exact silhouette.
fn draw_solid<I: Isa>(walk: &mut Walk<'_, I>, record: &ClipRecord, is_before_eye: bool) {
    let side = walk.view.levels[record.level as usize].side;
    let outline = walk.exact.outline(record.min, side, is_before_eye);
    let voxel = voxel_at(record.min, record.level);
    outline.draw(walk, &record.window, record.node, voxel);
}
