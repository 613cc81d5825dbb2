//! The traversal of the graph, from the whole object down to solids and bricks, front to back.
//!
//! ```text
//! visit(node):
//!     a solid, or a brick (a node whose parts are solids):   draw it (voxels, bricks, planes)
//!     else: for each child that exists, nearest to the eye first:
//!         skip it if its window holds no open sample
//!         visit(child)
//! ```
//!
//! Clip vectors of nodes are exact; windows are too wide by at most their rounding, never too
//! narrow.

use super::band::{Band, Brick, Compiled, Record, voxel_at};
use super::constants::{Constants, Level};
use super::lanes::Windows;
use super::orders::turned;
use super::parts::Parts;
use super::planes;
use super::window::Window;

/// Draws what a band shows of the whole object.
pub(super) fn draw_object<I: Compiled>(band: &mut Band<'_, I>) {
    let record = Record {
        node: band.graph.root,
        level: 0,
        min: [0; 3],
        centre: band.constants.centre,
    };
    let window = band.fill.bounds;
    if record.centre[2] + band.constants.levels[0].half_depth <= 0.0 {
        band.counters.skipped_behind += 1;
        return;
    }
    visit(band, &record, &window);
}

/// Draws a node, or visits its children. Something of it may be seen in the window.
#[inline(always)]
fn visit<I: Compiled>(band: &mut Band<'_, I>, record: &Record, window: &Window) {
    let (constants, isa) = (band.constants, band.isa);
    let level = &constants.levels[record.level as usize];
    let least_depth = record.centre[2] - level.half_depth;
    let mask = if record.level == constants.depth {
        0
    } else {
        band.graph.mask(record.node)
    };
    let is_near = least_depth <= 0.0;
    if mask == 0 || least_depth >= level.lod_depth {
        band.counters.skipped_detail += u64::from(mask != 0);
        if is_near || record.centre[2] < level.large_depth || !band.switches.bricks {
            draw_planes(band, record, window, !is_near);
        } else {
            let parts = &Parts::of_solid(record.node);
            isa.voxels(band, Brick { record, parts }, window);
        }
        return;
    }
    if is_near || !band.switches.bricks {
        isa.visit_children(band, record);
        return;
    }
    if record.centre[2] > level.fine_depth && is_deep(constants, record, least_depth) {
        let parts = Parts::of(isa, band.graph, record.node, false, 0);
        if parts.are_even() {
            let parts = &parts;
            isa.deep_brick(band, Brick { record, parts }, window);
            return;
        }
    }
    // Parts that are all solids, and not too large.
    let parts_level = record.level + 2;
    let are_solid = parts_level >= constants.depth
        || least_depth >= constants.levels[parts_level as usize].lod_depth;
    if are_solid && record.centre[2] >= 0.25 * level.large_depth {
        let is_last = record.level + 1 == constants.depth;
        let parts = Parts::of(
            isa,
            band.graph,
            record.node,
            is_last,
            detail(constants, record),
        );
        // What is blended is taken once, so no voxel may be of several parts.
        if parts.are_even() || constants.opacity_eye.is_none() {
            let parts = &parts;
            let brick = Brick { record, parts };
            if record.centre[2] < level.coarse_depth {
                isa.voxels(band, brick, window);
            } else {
                isa.brick(band, brick, window);
            }
            return;
        }
    }
    isa.visit_children(band, record);
}

/// Whether all solids below a node, by the graph's depth or by level of detail, are four levels
/// below it.
#[inline(always)]
fn is_deep(constants: &Constants, record: &Record, least_depth: f64) -> bool {
    let ends = record.level as usize + 4;
    if ends > constants.depth as usize {
        return false;
    }
    let greatest_depth = record.centre[2] + constants.levels[record.level as usize].half_depth;
    // The depths fall from level to level.
    greatest_depth < constants.levels[ends - 1].lod_depth
        && (ends == constants.depth as usize || least_depth >= constants.levels[ends].lod_depth)
}

/// The children of a node that level of detail draws as solids although they may have children: one
/// bit each.
#[inline(always)]
fn detail(constants: &Constants, record: &Record) -> u8 {
    let (own, below) = (
        &constants.levels[record.level as usize],
        &constants.levels[record.level as usize + 1],
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

/// Visits the children of a record, nearest first.
#[inline(always)]
pub(super) fn visit_children<I: Compiled>(band: &mut Band<'_, I>, record: &Record) {
    band.counters.nodes += 1;
    let constants = band.constants;
    let index = record.level as usize;
    let level = &constants.levels[index];
    let mask = band.graph.mask(record.node);
    let half = level.side / 2;
    let nearest = constants.nearest_octant(record.min, half);
    let windows = band
        .isa
        .windows(constants, index, &record.centre, &band.fill.bounds);
    band.counters.skipped_absent += u64::from(mask.count_zeros());
    if !band.switches.absent_children {
        count_absent(band, &windows, !mask);
        band.counters.skipped_absent = 0;
    }
    let mut wanted = mask;
    if band.switches.off_screen {
        wanted &= windows.held | windows.near;
        band.counters.skipped_off_screen += u64::from((mask ^ wanted).count_ones());
    }
    let mut order = turned(wanted, nearest);
    while order != 0 {
        let child = order.trailing_zeros() as u8 ^ nearest;
        order &= order - 1;
        if band.fill.open == 0 && band.switches.full {
            band.counters.skipped_full += 1;
            return;
        }
        let mut window = windows.at(child);
        let octant = usize::from(child & 7);
        let centre = [0, 1, 2].map(|c| record.centre[c] + level.child[c][octant]);
        if windows.near >> child & 1 != 0 {
            let below = &constants.levels[index + 1];
            if centre[2] + below.half_depth <= 0.0 {
                band.counters.skipped_behind += 1;
                continue;
            }
            if band.switches.off_screen && is_off_screen(below, &centre) {
                band.counters.skipped_off_screen += 1;
                continue;
            }
            window = band.fill.bounds;
        } else if windows.held >> child & 1 == 0 {
            // Only where `off_screen` is switched off, for measurements.
            window = band.fill.bounds;
        }
        if band.switches.hidden && !band.fill.is_open(&window) {
            band.counters.skipped_hidden += 1;
            continue;
        }
        let Some(node) = band.graph.child(record.node, child) else {
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
        visit(band, &child, &window);
    }
}

/// Tests the windows of children that do not exist, as for those that do: measures what skipping
/// them saves.
#[inline(never)]
fn count_absent<I: Compiled>(band: &mut Band<'_, I>, windows: &Windows, absent: u8) {
    let held = absent & windows.held & !windows.near;
    band.counters.skipped_off_screen += u64::from((absent & !held).count_ones());
    for child in (0..8).filter(|child| held >> child & 1 != 0) {
        let is_open = band.fill.is_open(&windows.at(child));
        band.counters.skipped_hidden += u64::from(!is_open);
    }
}

/// Whether a box that is partly behind the eye lies beside the picture: all eight vertices are
/// beyond one edge of the image root. The numbers are exact, and the test is linear: what holds for
/// the vertices holds for every point.
#[inline(never)]
fn is_off_screen(level: &Level, centre: &[f64; 3]) -> bool {
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
    band: &mut Band<'_, I>,
    record: &Record,
    window: &Window,
    is_before_eye: bool,
) {
    let side = band.constants.levels[record.level as usize].side;
    let outline = band.exact.outline(record.min, side, is_before_eye);
    let voxel = voxel_at(record.min, record.level);
    planes::draw(band, &outline, window, record.node, voxel);
}
