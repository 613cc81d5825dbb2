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
use super::screen::ScreenRecord;
use super::subtree::{LANES, STRIPS, Subtree};
use super::walk::{Walk, voxel_at};
use crate::graph::GraphView;
use crate::project::OCCLUSION_ORDER;

/// What bytes hold of the strips.
#[derive(Debug, Clone)]
pub(super) struct Coarse {
    /// By strip, each part's centre relative to the node's, by lane.
    pub(super) parts: [[u8; 64]; STRIPS],
    /// By strip, a part's width, with what cutting may add: in all bytes of a vector.
    pub(super) width: [[u8; 32]; STRIPS],
    /// By strip, how many lower bits are cut off.
    pub(super) shift: [i32; 4],
}

impl Coarse {
    const EMPTY: Self = Self {
        parts: [[0; 64]; STRIPS],
        width: [[0; 32]; STRIPS],
        shift: [0; 4],
    };

    /// Cuts the strips of 64 parts to bytes (8, if `few`): of the children of
    /// a node's children, or of its children.
    ///
    /// Sums of cut numbers are at most one below the cut sum, differences at
    /// most one above the cut difference: so a value that is within its width
    /// is, in bytes, at most two above it.
    #[inline(always)]
    fn make<I: Isa>(&mut self, isa: I, subtree: &Subtree, octant: u8, few: bool) {
        for f in 0..STRIPS {
            // Values differ by less than this; a little more for what cutting adds.
            let range = subtree.brick_range(f) as u32;
            let bits = 32 - (range + range / 32).leading_zeros();
            let shift = bits.saturating_sub(8);
            self.shift[f] = shift as i32;
            let half = subtree.half_width[f] + subtree.reach[f];
            self.width[f] = [((2 * half) >> shift) as u8 + 2; 32];
            // The exclusive or with the octant turns axes around.
            let mut children = [0i32; 8];
            let [x, y, z] = [
                turned(subtree.half_edge[0][f], octant >> 2),
                turned(subtree.half_edge[1][f], octant >> 1),
                turned(subtree.half_edge[2][f], octant),
            ];
            for i in 0..8 {
                children[i] = NEAREST[0][i] * x + NEAREST[1][i] * y + NEAREST[2][i] * z;
            }
            isa.byte_table(&mut self.parts[f], &children, shift, few);
        }
    }
}

/// By axis, which way the children of octant 0 lie in occlusion order.
const NEAREST: [[i32; 8]; 3] = {
    let mut signs = [[0; 8]; 3];
    let mut i = 0;
    while i < 8 {
        let mut k = 0;
        while k < 3 {
            signs[k][i] = 2 * (OCCLUSION_ORDER[i] >> (2 - k) & 1) as i32 - 1;
            k += 1;
        }
        i += 1;
    }
    signs
};

/// Tables of one subtree, kept from brick to brick.
#[derive(Debug)]
pub(super) struct Tables {
    /// Levels left and octant that the tables of parts are for.
    made_for: Option<(u32, u8)>,
    /// The parts of a node, in bytes.
    parts: Coarse,
    /// By levels above the finest, less one, in occlusion order: the centre of
    /// a child relative to its parent's.
    children: [[[i32; LANES]; 8]; 2],
    /// What so many columns, and so many rows, add.
    steps: [[[i32; LANES]; 8]; 2],
    /// Half the width of a finest voxel.
    half: [i32; LANES],
    /// The width of a finest voxel.
    width: [i32; LANES],
    /// In a frame without tolerance, what a value is less from the lower bound
    /// that is certain to be inside, and the width of what is.
    sure: [[i32; LANES]; 2],
    /// Whether anything is certain: no such width is below zero.
    has_sure: bool,
    /// Whether `tile` is made.
    has_tile: bool,
    /// By strip, what the samples of a tile add to its first.
    pub(super) tile: [[i32; 64]; STRIPS],
    /// Whether `square` and `fits_square` are made.
    has_square: bool,
    /// `tile` modulo 2^16.
    pub(super) square: [[i16; 64]; STRIPS],
    /// Whether a voxel of the finest level is so narrow that this modulus does
    /// not confuse its samples.
    pub(super) fits_square: bool,
}

impl Default for Tables {
    fn default() -> Self {
        Self {
            made_for: None,
            parts: Coarse::EMPTY,
            children: [[[0; LANES]; 8]; 2],
            steps: [[[0; LANES]; 8]; 2],
            half: [0; LANES],
            width: [0; LANES],
            sure: [[0; LANES]; 2],
            has_sure: false,
            has_tile: false,
            tile: [[0; 64]; STRIPS],
            has_square: false,
            square: [[0; 64]; STRIPS],
            fits_square: false,
        }
    }
}

/// By octant: the bits of a child mask in occlusion order.
const IN_ORDER: [[u8; 256]; 8] = all_in_order();
static IN_ORDER_TABLE: [[u8; 256]; 8] = IN_ORDER;

/// The children of a mask in occlusion order, nearest in bit 0.
#[inline(always)]
pub(super) fn in_order(octant: u8, mask: u8) -> u8 {
    IN_ORDER_TABLE[usize::from(octant & 7)][usize::from(mask)]
}

const fn all_in_order() -> [[u8; 256]; 8] {
    let mut table = [[0u8; 256]; 8];
    let mut octant = 0;
    while octant < 8 {
        let mut mask = 0;
        while mask < 256 {
            let mut i = 0;
            while i < 8 {
                let child = octant as u8 ^ OCCLUSION_ORDER[i];
                table[octant][mask] |= ((mask >> child) as u8 & 1) << i;
                i += 1;
            }
            mask += 1;
        }
        octant += 1;
    }
    table
}

impl Tables {
    /// Forgets the last subtree's.
    #[inline(always)]
    pub(super) fn forget(&mut self) {
        self.made_for = None;
        self.has_tile = false;
        self.has_square = false;
        self.fits_square = false;
    }

    /// Makes the table of a tile's samples, unless it is made.
    pub(super) fn make_tile(&mut self, subtree: &Subtree) {
        if self.has_tile {
            return;
        }
        self.has_tile = true;
        for f in 0..STRIPS {
            let (across, down) = (subtree.step[0][f], subtree.step[1][f]);
            for (i, entry) in self.tile[f].iter_mut().enumerate() {
                let (x, y) = (i as i32 & 7, i as i32 >> 3);
                *entry = across.wrapping_mul(x).wrapping_add(down.wrapping_mul(y));
            }
        }
    }

    /// Makes the table of a tile's samples in sixteen bits, unless it is made.
    #[inline(always)]
    pub(super) fn make_square<I: Isa>(&mut self, isa: I, subtree: &Subtree) {
        if self.has_square {
            return;
        }
        self.has_square = true;
        let mut most = 0;
        for f in 0..STRIPS {
            isa.square_table(
                &mut self.square[f],
                subtree.step[0][f],
                subtree.step[1][f],
            );
            most = most.max(subtree.voxel_range(f));
        }
        self.fits_square = most < 1 << 16;
    }

    /// Makes the tables of parts.
    #[inline(always)]
    pub(super) fn make_parts<I: Isa>(&mut self, isa: I, subtree: &Subtree, left: u32, octant: u8) {
        self.made_for = Some((left, octant));
        let mut lower = [0; LANES];
        for lane in 0..LANES {
            let (half, reach) = (subtree.half_width[lane], subtree.reach[lane]);
            lower[lane] = half + reach;
            self.width[lane] = 2 * (half + reach);
            self.sure[0][lane] = reach + subtree.doubt[lane];
            self.sure[1][lane] = 2 * (half - subtree.doubt[lane]);
        }
        self.has_sure = self.sure[1].iter().all(|&width| width >= 0);
        self.half = lower;
        for (steps, step) in self.steps.iter_mut().zip(&subtree.step) {
            let step = isa.load(step);
            let mut value = isa.load(&[0; LANES]);
            for to in steps.iter_mut() {
                *to = isa.store(value);
                value = isa.add(value, step);
            }
        }
        for (i, nearest) in OCCLUSION_ORDER.into_iter().enumerate() {
            let child = isa.load(&subtree.child[usize::from(octant ^ nearest) & 7]);
            self.children[0][i] = isa.store(child);
            self.children[1][i] = isa.store(isa.add(child, child));
        }
        self.parts.make(isa, subtree, octant, left == 1);
    }

    /// The functions at a sample of a square, from those at its first.
    #[inline(always)]
    fn value_at<I: Isa>(&self, isa: I, first: I::Eight, bit: u32) -> I::Eight {
        let value = isa.add(first, isa.load(&self.steps[0][bit as usize & 7]));
        isa.add(value, isa.load(&self.steps[1][bit as usize >> 3 & 7]))
    }

    /// A value relative to the centre of a lane's finest voxel, from one
    /// relative to the centre of a node `levels` levels above.
    #[inline(always)]
    fn from_part<I: Isa>(&self, isa: I, value: I::Eight, levels: u32, lane: u32) -> I::Eight {
        let [inner, outer] = &self.children;
        let value = isa.sub(value, isa.load(&inner[lane as usize & 7]));
        if levels == 1 {
            return value;
        }
        isa.sub(value, isa.load(&outer[lane as usize >> 3 & 7]))
    }
}

/// An edge, or its opposite where the bit is set.
#[inline(always)]
fn turned(edge: i32, bit: u8) -> i32 {
    let sign = -i32::from(bit & 1);
    (edge ^ sign) - sign
}

/// [`Isa::byte_table`], eight bytes at a time.
#[inline(always)]
pub(super) fn byte_table(table: &mut [u8; 64], children: &[i32; 8], shift: u32, few: bool) {
    let mut inner = 0u64;
    for child in children.iter().rev() {
        inner = inner << 8 | u64::from((child >> shift) as u8);
    }
    if few {
        table[..8].copy_from_slice(&inner.to_le_bytes());
        return;
    }
    for (child, eight) in children.iter().zip(table.chunks_exact_mut(8)) {
        let outer = ((2 * child) >> shift) as u8;
        eight.copy_from_slice(&add_to_bytes(inner, outer).to_le_bytes());
    }
}

/// A byte added to each of eight bytes.
#[inline(always)]
fn add_to_bytes(bytes: u64, byte: u8) -> u64 {
    const TOP: u64 = 0x8080_8080_8080_8080;
    let all = u64::from(byte) * 0x0101_0101_0101_0101;
    ((bytes & !TOP) + (all & !TOP)) ^ ((bytes ^ all) & TOP)
}

/// The parts of a node that exist.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parts {
    /// By lane.
    lanes: u64,
    /// The masks of the node's children, a byte each, by octant. Of a node one
    /// level above its parts: nothing.
    masks: u64,
    /// Where the node's children begin.
    first: u32,
    /// Which children the node has.
    mask: u8,
    /// Whether a child has no children, so that a part is larger than the others.
    is_uneven: bool,
}

/// By mask: a byte of ones for each bit.
static BYTES: [u64; 256] = {
    let mut table = [0u64; 256];
    let mut mask = 0;
    while mask < 256 {
        let mut bit = 0;
        while bit < 8 {
            if mask >> bit & 1 != 0 {
                table[mask] |= 0xff << (8 * bit);
            }
            bit += 1;
        }
        mask += 1;
    }
    table
};

impl Parts {
    /// The parts of a node one or two levels above them.
    #[inline(always)]
    fn of<I: Isa>(isa: I, graph: &GraphView<'_>, node: u32, levels: u32, octant: u8) -> Self {
        let mask = graph.mask(node);
        let first = graph.first.get(node as usize).copied().unwrap_or(0);
        if levels == 1 {
            return Self {
                lanes: u64::from(in_order(octant, mask)),
                masks: 0,
                first,
                mask,
                is_uneven: mask == 0,
            };
        }
        let exist = BYTES[usize::from(mask)];
        let eight = graph
            .mask
            .get(first as usize..)
            .and_then(|m| m.first_chunk());
        let masks = match eight {
            Some(&eight) if graph.links.is_empty() => {
                isa.spread(u64::from_le_bytes(eight), mask, exist)
            }
            _ => Self::masks_one_by_one(graph, first, mask),
        };
        const ONES: u64 = 0x0101_0101_0101_0101;
        let filled = masks | !exist;
        let has_zero = filled.wrapping_sub(ONES) & !filled & (ONES << 7) != 0;
        Self {
            lanes: isa.masks_in_order(masks, octant),
            masks,
            first,
            mask,
            is_uneven: has_zero || mask == 0,
        }
    }

    /// The masks of a node's children, wherever they are.
    fn masks_one_by_one(graph: &GraphView<'_>, first: u32, mask: u8) -> u64 {
        let mut masks = 0;
        let mut slot = first;
        for octant in 0..8 {
            if mask >> octant & 1 != 0 {
                let child = linked(graph.links, slot);
                masks |= u64::from(graph.mask(child)) << (8 * octant);
                slot = slot.wrapping_add(1);
            }
        }
        masks
    }

    /// The node of a lane, `levels` levels below.
    #[inline(always)]
    fn node(&self, graph: &GraphView<'_>, levels: u32, octant: u8, lane: u32) -> u32 {
        let octants = u32::from(octant & 7) * 9 ^ u32::from(BY_LANE[lane as usize & 63]);
        let (outer, inner) = (octants >> 3 & 7, octants & 7);
        let before = |mask: u64, child: u32| (mask & ((1u64 << child) - 1)).count_ones();
        let mask = u64::from(self.mask);
        if levels == 1 {
            return linked(graph.links, self.first.wrapping_add(before(mask, inner)));
        }
        let child = linked(graph.links, self.first.wrapping_add(before(mask, outer)));
        let first = graph.first.get(child as usize).copied().unwrap_or(0);
        let before = before(self.masks >> (8 * outer) & 0xff, inner);
        linked(graph.links, first.wrapping_add(before))
    }
}

/// By lane, for octant 0: a child, and in the upper bits the child that it is in.
static BY_LANE: [u8; 64] = {
    let mut octants = [0; 64];
    let mut lane = 0;
    while lane < 64 {
        octants[lane] = OCCLUSION_ORDER[lane >> 3] << 3 | OCCLUSION_ORDER[lane & 7];
        lane += 1;
    }
    octants
};

/// By octant, for lanes of sixteen bytes: the children of a mask's lower and
/// upper half in occlusion order, and the order itself.
pub(super) static ORDER_BYTES: [[[u8; 16]; 3]; 8] = {
    let mut table = [[[0u8; 16]; 3]; 8];
    let mut octant = 0;
    while octant < 8 {
        let mut i = 0;
        while i < 16 {
            table[octant][0][i] = IN_ORDER[octant][i];
            table[octant][1][i] = IN_ORDER[octant][i << 4];
            table[octant][2][i] = octant as u8 ^ OCCLUSION_ORDER[i & 7];
            i += 1;
        }
        octant += 1;
    }
    table
};

/// [`Isa::masks_in_order`], byte by byte.
#[inline(always)]
pub(super) fn masks_in_order(masks: u64, octant: u8) -> u64 {
    let mut lanes = 0;
    for (i, nearest) in OCCLUSION_ORDER.into_iter().enumerate() {
        let mask = (masks >> (8 * ((octant ^ nearest) & 7))) as u8;
        lanes |= u64::from(in_order(octant, mask)) << (8 * i);
    }
    lanes
}

/// The node at a place of a child list.
#[inline(always)]
pub(super) fn linked(links: &[u32], slot: u32) -> u32 {
    if links.is_empty() {
        slot
    } else {
        links.get(slot as usize).copied().unwrap_or(slot)
    }
}

/// The lowest corner of a lane's part with this side, of a node `levels` above.
#[inline(always)]
fn corner(min: [i32; 3], levels: u32, side: i32, octant: u8, lane: u32) -> [i32; 3] {
    let inner = octant ^ OCCLUSION_ORDER[lane as usize & 7];
    let outer = octant ^ OCCLUSION_ORDER[(lane >> 3) as usize & 7];
    let mut corner = min;
    for k in 0..3 {
        corner[k] += i32::from(inner >> (2 - k) & 1) * side;
        if levels == 2 {
            corner[k] += 2 * i32::from(outer >> (2 - k) & 1) * side;
        }
    }
    corner
}

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
    let side = subtree.finest_side << record.left;
    let octant = match subtree.octant {
        Some(octant) => octant,
        None => match walk
            .view
            .common_octant(record.min, side, subtree.finest_side)
        {
            Some(octant) => octant,
            None => return false,
        },
    };
    let parts = Parts::of(walk.isa, walk.graph, record.node, record.left, octant);
    if parts.is_uneven {
        return false;
    }
    if walk.tables.made_for != Some((record.left, octant)) {
        let isa = walk.isa;
        isa.tables(&mut walk.tables, subtree, record.left, octant);
    }
    walk.isa.brick(walk, subtree, record, octant, &parts);
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
                if let Some(shown) = walk.pixels.node.get_mut(at) {
                    *shown = node;
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
            let from_part = walk.tables.from_part(isa, value, levels, lane);
            if !isa.all_within(from_part, isa.load(&walk.tables.width)) {
                continue;
            }
            if !SEARCH {
                return Some(lane);
            }
            let [less, width] = &walk.tables.sure;
            if walk.tables.has_sure
                && isa.all_within(isa.sub(from_part, isa.load(less)), isa.load(width))
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
