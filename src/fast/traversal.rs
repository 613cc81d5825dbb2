//! The traversal of the graph, front to back: rules R7.1 (level of detail), R8.2 (plane of the eye), R9 (nearest octant)
//! and R10 (termination). Clip vectors of nodes are exact.

use super::band::{Band, Brick, Record, voxel_at};
use super::child_windows::ChildWindows;
use super::constants::{Constants, Level};
use super::lanes::Isa;
use super::parts::Parts;
use super::window::Window;
use super::{bricks, planes, voxels};
use crate::graph::{GraphView, MAX_DEPTH, prefetch};

#[inline(always)]
pub(super) fn draw_object<I: Isa>(band: &mut Band<'_, I>) {
    let root = Record {
        node: band.graph.root,
        level: 0,
        min: [0; 3],
        centre: band.constants.centre,
    };
    if root.centre[2] + band.constants.levels[0].half_depth <= 0.0 {
        band.counters.skipped_behind += 1;
        return;
    }
    let mut stack = [Children::none(&band.constants.levels[0]); MAX_DEPTH as usize];
    let window = band.fill.bounds;
    if draw(band, &root, &window) {
        return;
    }
    stack[0].begin(band, &root);
    let mut height = usize::from(stack[0].left != 0);
    while height > 0 {
        if band.fill.open == 0 {
            band.counters.skipped_full += height as u64;
            return;
        }
        let last = &mut stack[height - 1];
        let next = last.next(band);
        height -= usize::from(last.left == 0);
        if let Some((child, window)) = next
            && !draw(band, &child, &window)
        {
            stack[height].begin(band, &child);
            height += usize::from(stack[height].left != 0);
        }
    }
}

#[inline(always)]
fn draw<I: Isa>(band: &mut Band<'_, I>, record: &Record, window: &Window) -> bool {
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
            draw_voxels(band, record, &Parts::of_solid(record.node), window);
        }
        return true;
    }
    if is_near || !band.switches.bricks {
        return false;
    }
    if record.centre[2] > level.fine_depth && is_deep(constants, record, least_depth) {
        let parts = &Parts::of(isa, band.graph, record.node, false, 0);
        if parts.are_even() {
            draw_brick::<I, true>(band, Brick { record, parts }, window);
            return true;
        }
    }
    // Parts that are all solids, and not too large.
    let parts_level = record.level + 2;
    let are_solid = parts_level >= constants.depth
        || least_depth >= constants.levels[parts_level as usize].lod_depth;
    if !are_solid || record.centre[2] < 0.25 * level.large_depth {
        return false;
    }
    let is_last = record.level + 1 == constants.depth;
    let detail = detail(constants, record);
    let parts = &Parts::of(isa, band.graph, record.node, is_last, detail);
    // Voxels are blended once: none may consist of several parts.
    if constants.opacity_eye.is_some() && !parts.are_even() {
        return false;
    }
    if record.centre[2] < level.coarse_depth {
        draw_voxels(band, record, parts, window);
    } else {
        draw_brick::<I, false>(band, Brick { record, parts }, window);
    }
    true
}

#[inline(always)]
fn draw_brick<I: Isa, const DEEP: bool>(band: &mut Band<'_, I>, brick: Brick<'_>, window: &Window) {
    band.isa.vectorize(
        band,
        brick,
        #[inline(always)]
        |band, brick| bricks::draw::<I, DEEP>(band, brick, window),
    );
}

#[inline(always)]
fn is_deep(constants: &Constants, record: &Record, least_depth: f64) -> bool {
    let ends = record.level as usize + 4;
    if ends > constants.depth as usize {
        return false;
    }
    let greatest_depth = record.centre[2] + constants.levels[record.level as usize].half_depth;
    greatest_depth < constants.levels[ends - 1].lod_depth
        && (ends == constants.depth as usize || least_depth >= constants.levels[ends].lod_depth)
}

#[inline(always)]
fn detail(constants: &Constants, record: &Record) -> u8 {
    let own = &constants.levels[record.level as usize];
    let below = &constants.levels[record.level as usize + 1];
    if record.centre[2] + own.half_depth < below.lod_depth {
        return 0;
    }
    let is_solid = |octant: usize| {
        let least = record.centre[2] + own.child[2][octant] - below.half_depth;
        u8::from(least >= below.lod_depth) << octant
    };
    (0..8).map(is_solid).sum()
}

#[derive(Debug, Clone, Copy)]
struct Children<'b> {
    record: Record,
    level: &'b Level,
    windows: ChildWindows,
    nearest: u32,
    left: u32,
}

impl<'b> Children<'b> {
    fn none(level: &'b Level) -> Self {
        Self {
            record: Record::default(),
            level,
            windows: ChildWindows::default(),
            nearest: 0,
            left: 0,
        }
    }

    #[inline(always)]
    fn begin<I: Isa>(&mut self, band: &mut Band<'b, I>, record: &Record) {
        band.counters.nodes += 1;
        let constants = band.constants;
        let index = record.level as usize;
        let level = &constants.levels[index];
        let mask = band.graph.mask(record.node);
        let nearest = constants.nearest_octant(record.min, level.side >> 1);
        let bounds = &band.fill.bounds;
        let windows = &mut self.windows;
        windows.compute(band.isa, constants, index, &record.centre, bounds);
        band.counters.skipped_absent += u64::from(mask.count_zeros());
        let wanted = mask & (windows.held | windows.near);
        band.counters.skipped_off_screen += u64::from((mask ^ wanted).count_ones());
        self.record = *record;
        self.level = level;
        self.nearest = u32::from(nearest);
        self.left = band.isa.turned(u64::from(wanted) << (8 * nearest), nearest) as u32;
        self.prefetch(band.graph);
    }

    #[inline(always)]
    fn octant(&self) -> u8 {
        (self.left.trailing_zeros() ^ self.nearest) as u8 & 7
    }

    /// Begins to read what the next child will need while another is drawn: its children, and the first one's.
    #[inline(always)]
    fn prefetch(&self, graph: &GraphView<'_>) {
        if self.left != 0
            && let Some(child) = graph.child(self.record.node, self.octant())
        {
            let children = graph.first(child);
            prefetch(graph.mask, children as usize);
            prefetch(graph.first, children as usize);
            let below = graph.first(children) as usize;
            prefetch(graph.mask, below);
            for line in 0..3 {
                prefetch(graph.first, below.wrapping_add(16 * line));
            }
        }
    }

    #[inline(always)]
    fn next<I: Isa>(&mut self, band: &mut Band<'_, I>) -> Option<(Record, Window)> {
        let (record, level) = (&self.record, self.level);
        let octant = usize::from(self.octant());
        self.left &= self.left - 1;
        self.prefetch(band.graph);
        let mut window = self.windows.at(octant);
        let centre = [0, 1, 2].map(|c| record.centre[c] + level.child[c][octant]);
        if self.windows.near >> octant & 1 != 0 {
            let below = &band.constants.levels[record.level as usize + 1];
            if centre[2] + below.half_depth <= 0.0 {
                band.counters.skipped_behind += 1;
                return None;
            }
            if is_off_screen(below, &centre) {
                band.counters.skipped_off_screen += 1;
                return None;
            }
            window = band.fill.bounds;
        }
        if band.switches.hidden && !band.fill.is_open(&window) {
            band.counters.skipped_hidden += 1;
            return None;
        }
        let node = band.graph.child(record.node, octant as u8)?;
        let half = level.side >> 1;
        let bit = |k: usize| (octant as i32 >> (2 - k) & 1) * half;
        let [x, y, z] = record.min;
        let child = Record {
            node,
            level: record.level + 1,
            min: [x + bit(0), y + bit(1), z + bit(2)],
            centre,
        };
        Some((child, window))
    }
}

/// Whether all vertices of a box partly behind the eye are beyond one edge of the image root.
#[inline(never)]
fn is_off_screen(level: &Level, centre: &[f64; 3]) -> bool {
    (0..2).any(|axis| {
        let at = |c: usize, vertex: usize| centre[c] + level.vertices[c][vertex];
        (0..8).all(|i| at(axis, i) < 0.0) || (0..8).all(|i| at(2, i) < at(axis, i))
    })
}

#[inline(always)]
fn draw_voxels<I: Isa>(band: &mut Band<'_, I>, record: &Record, parts: &Parts, window: &Window) {
    let brick = Brick { record, parts };
    band.isa.vectorize(
        band,
        brick,
        #[inline(always)]
        |band, brick| voxels::draw(band, brick, window),
    );
}

#[inline(always)]
fn draw_planes<I: Isa>(
    band: &mut Band<'_, I>,
    record: &Record,
    window: &Window,
    is_before_eye: bool,
) {
    band.isa.vectorize(
        band,
        record,
        #[inline(always)]
        |band, record| {
            let side = band.constants.levels[record.level as usize].side;
            let outline = band.exact.outline(record.min, side, is_before_eye);
            let voxel = voxel_at(record.min, record.level);
            planes::draw(band, &outline, window, record.node, voxel);
        },
    );
}
