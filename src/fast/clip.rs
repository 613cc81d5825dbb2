//! Records in clip space: exact whole numbers, as the machine has them.

use super::canvas::Window;
use super::lanes::Isa;
use super::screen;
use super::subtree::Subtree;
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
    walk.counters.clip_records += 1;
    let view = walk.view;
    let level = &view.levels[record.level as usize];
    let w_min = record.corner[2] + level.w_span[0];
    if w_min >= level.screen_depth && change(walk, record, level) {
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
        if mask >> child & 1 == 0 {
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
fn change<I: Isa>(walk: &mut Walk<'_, I>, record: &ClipRecord, level: &Level) -> bool {
    let vertices = level.vertices_at(record.corner);
    if !is_within_guard(&vertices) {
        return false;
    }
    let w_max = record.corner[2] + level.w_span[1];
    let w_min = record.corner[2] + level.w_span[0];
    let Some(finest) = finest_level(walk.view, record.level, [w_min, w_max]) else {
        return false;
    };
    let Some((subtree, place)) = Subtree::new(walk.view, &vertices, record, finest, w_min) else {
        walk.is_lost = true;
        return true;
    };
    walk.counters.changes += 1;
    walk.tables.forget();
    let left = subtree.finest - record.level;
    screen::start(walk, &subtree, record.node, left, record.min, place);
    true
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
fn is_within_guard(vertices: &Vertices) -> bool {
    let scale = f64::from(1u32 << SCREEN_GUARD_SHIFT);
    let mut within = true;
    for axis in 0..2 {
        for i in 0..8 {
            let (x, w) = (vertices[axis][i], vertices[2][i]);
            within &= scale * x + w >= 0.0 && scale * (w - x) + w >= 0.0;
        }
    }
    within
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
        let vertices = level.vertices_at(corner);
        let seen = samples_of(view, &vertices).and(&window);
        if seen.is_empty() && walk.switches.off_screen {
            walk.counters.skipped_off_screen += 1;
            return None;
        }
        window = seen;
    } else if walk.switches.off_screen && is_beside(view, &level.vertices_at(corner)) {
        walk.counters.skipped_off_screen += 1;
        return None;
    }
    if walk.switches.hidden && !window.is_empty() && !walk.fill.is_open(&window) {
        walk.counters.skipped_hidden += 1;
        return None;
    }
    Some(window)
}

/// The samples in a box's window. All vertices are before the eye.
#[inline(always)]
fn samples_of(view: &View, vertices: &Vertices) -> Window {
    let mut low = [0i32; 2];
    let mut high = [0i32; 2];
    for axis in 0..2 {
        let mut position = [0.0; 8];
        for i in 0..8 {
            position[i] = vertices[axis][i] / vertices[2][i];
        }
        let least = reduce(position, |a, b| if a < b { a } else { b });
        let greatest = reduce(position, |a, b| if a > b { a } else { b });
        // Sample i is at i + 1/2. Conversions saturate.
        let first = least * view.root_samples - view.margin - 0.5;
        let last = greatest * view.root_samples + view.margin - 0.5;
        low[axis] = first.ceil() as i32;
        high[axis] = last.floor() as i32;
    }
    Window {
        left: low[0],
        top: low[1],
        right: high[0],
        bottom: high[1],
    }
}

#[inline(always)]
fn reduce(v: [f64; 8], f: impl Fn(f64, f64) -> f64) -> f64 {
    let half: [f64; 4] = std::array::from_fn(|i| f(v[i], v[i + 4]));
    f(f(half[0], half[2]), f(half[1], half[3]))
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
