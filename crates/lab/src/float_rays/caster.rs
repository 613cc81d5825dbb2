//! One ray through the octree.

use super::arithmetic::{Arithmetic, FloatStep};
use super::{LEAST_SLOPE, MANTISSA_BITS};
use shiftvox::graph::{GraphView, NodeLayout};

/// An entry of a ray's stack: the parent node, and the exit from it.
#[derive(Debug, Clone, Copy, Default)]
struct StackEntry {
    node: u32,
    exit: f32,
}

pub(super) struct Caster<'g> {
    pub(super) graph: &'g GraphView<'g>,
    pub(super) last_level: u32,
    pub(super) depth: u32,
    pub(super) layout: NodeLayout,
}

impl Caster<'_> {
    #[inline]
    pub(super) fn cast<A: Arithmetic>(
        &self,
        origin: [f32; 3],
        direction: [f32; 3],
        steps: &mut u64,
        by: &mut A,
    ) -> Option<(u32, [i32; 4])> {
        // Octant bit 4 >> k belongs to axis k. Mirrored axes: direction above 0.
        let mut mirror = 0u8;
        // The plane at `p` of axis k is crossed at t = p * slope[k] - bias[k]; slope is negative.
        let mut slope = [0f32; 3];
        let mut bias = [0f32; 3];
        for k in 0..3 {
            by.count(FloatStep::Logic, 1);
            let steep = by.max(direction[k].abs(), LEAST_SLOPE);
            slope[k] = by.divide(-1.0, steep);
            bias[k] = by.multiply(slope[k], origin[k]);
            if by.less(0.0, direction[k]) {
                mirror |= 4 >> k;
                by.count(FloatStep::Logic, 1);
                bias[k] = by.times_less(3.0, slope[k], bias[k]);
            }
        }
        let at = |by: &mut A, p: f32, k: usize| by.times_less(p, slope[k], bias[k]);
        let enters = [0, 1, 2].map(|k| at(by, 2.0, k));
        let leaves = [0, 1, 2].map(|k| at(by, 1.0, k));
        let mut near = greatest(by, enters);
        near = by.max(near, 0.0);
        let mut exit = least(by, leaves);
        // The slopes, the planes, the latest entry and whether it is before the first exit.
        by.wait(FloatStep::FloatDivide, 1);
        by.wait(FloatStep::FloatMultiply, 2);
        by.wait(FloatStep::FloatAdd, 1);
        by.wait(FloatStep::FloatMinMax, 4);
        by.wait(FloatStep::FloatCompare, 1);
        if by.less(exit, near) {
            return None;
        }
        let mut node = self.graph.root;
        self.read(node, 0, by);
        let mut mask = self.graph.mask(node);
        if mask == 0 || self.last_level == 0 {
            return Some((node, [0; 4]));
        }

        let mut stack = [StackEntry::default(); MANTISSA_BITS as usize + 1];
        // Of the cell examined: lowest corner in mirrored space, octant in its parent
        // (mirrored), side, and the bit of the mantissa that the side is.
        let mut low = [1f32; 3];
        let mut octant = 0u8;
        let mut side = 0.5f32;
        let mut bit = MANTISSA_BITS - 1;
        for k in 0..3 {
            let middle = at(by, 1.5, k);
            if by.less(near, middle) {
                by.count(FloatStep::Logic, 2);
                octant |= 4 >> k;
                low[k] = 1.5;
            }
        }
        // Where the parent ends, as put aside last.
        let mut aside = exit;
        loop {
            *steps += 1;
            let leaves = [0, 1, 2].map(|k| at(by, low[k], k));
            let cell_exit = least(by, leaves);
            // Where the ray leaves the cell; whether there is a child shows meanwhile.
            by.wait(FloatStep::FloatMultiply, 1);
            by.wait(FloatStep::FloatAdd, 1);
            by.wait(FloatStep::FloatMinMax, 2);
            // The octant, and its bit of the mask.
            by.count(FloatStep::Logic, 2);
            let child_octant = octant ^ mirror;
            if mask >> child_octant & 1 != 0 && !by.less(exit, near) {
                let child_end = by.min(exit, cell_exit);
                if !by.less(child_end, near)
                    && let Some(child) = self.graph.child(node, child_octant)
                {
                    let level = MANTISSA_BITS - bit;
                    let child_mask = self.graph.mask(child);
                    let is_solid = child_mask == 0 || level == self.last_level;
                    // Is there anything of the ray in it, and where is it?
                    by.wait(FloatStep::FloatMinMax, 1);
                    by.wait(FloatStep::FloatCompare, 1);
                    if !(is_solid && self.layout.leaf_masks) {
                        self.read(child, level, by);
                    }
                    // Its place: the bits of the mask before it, counted and added.
                    by.count(FloatStep::Logic, 1);
                    by.count(FloatStep::IntegerAdd, 2);
                    if is_solid {
                        return Some((child, self.cell(low, bit, mirror)));
                    }
                    // Descend.
                    if by.less(cell_exit, aside) {
                        by.count(FloatStep::StackWrite, 1);
                        stack[bit as usize] = StackEntry { node, exit };
                    }
                    aside = cell_exit;
                    node = child;
                    mask = child_mask;
                    octant = 0;
                    bit -= 1;
                    // Bit and exponent less one.
                    by.count(FloatStep::IntegerAdd, 2);
                    side *= 0.5;
                    for k in 0..3 {
                        let step = by.multiply(side, slope[k]);
                        let middle = by.add(step, leaves[k]);
                        if by.less(near, middle) {
                            by.count(FloatStep::Logic, 2);
                            octant |= 4 >> k;
                            // One bit of the mantissa.
                            low[k] += side;
                        }
                    }
                    exit = child_end;
                    continue;
                }
            }
            // Advance to the neighbour that the ray enters.
            let mut turned = 0u8;
            for k in 0..3 {
                if !by.less(cell_exit, leaves[k]) {
                    by.count(FloatStep::Logic, 1);
                    turned |= 4 >> k;
                    low[k] = by.sub(low[k], side);
                }
            }
            near = cell_exit;
            // The next cell's place needs which planes end this one, and a step.
            by.wait(FloatStep::FloatCompare, 1);
            by.wait(FloatStep::FloatAdd, 1);
            by.count(FloatStep::Logic, 2);
            octant ^= turned;
            if octant & turned == 0 {
                continue;
            }
            // It is not in the same parent: ascend to the lowest that holds both.
            let mut differing = 0u32;
            for k in 0..3 {
                if turned & (4 >> k) != 0 {
                    by.count(FloatStep::Logic, 2);
                    let before = by.add(low[k], side);
                    differing |= low[k].to_bits() ^ before.to_bits();
                }
            }
            by.count(FloatStep::Shift, 1);
            bit = 31 - differing.leading_zeros();
            if bit >= MANTISSA_BITS {
                return None;
            }
            by.count(FloatStep::IntegerAdd, 1);
            side = f32::from_bits((bit + 127 - MANTISSA_BITS) << MANTISSA_BITS);
            by.count(FloatStep::StackRead, 1);
            // The level, what was put aside there, and that node.
            by.wait(FloatStep::Shift, 1);
            by.wait(FloatStep::StackRead, 1);
            let above = stack[bit as usize];
            node = above.node;
            // The node's children are a level below it.
            self.read(node, MANTISSA_BITS - 1 - bit, by);
            mask = self.graph.mask(node);
            exit = above.exit;
            octant = 0;
            for k in 0..3 {
                by.count(FloatStep::Shift, 1);
                by.count(FloatStep::Logic, 2);
                let place = low[k].to_bits() >> bit;
                low[k] = f32::from_bits(place << bit);
                if place & 1 != 0 {
                    octant |= 4 >> k;
                }
            }
            aside = 0.0;
        }
    }

    #[inline]
    fn read<A: Arithmetic>(&self, node: u32, level: u32, by: &mut A) {
        let words = self.layout.words(node, level);
        by.wait(FloatStep::NodeRead, u32::from(!words.is_empty()));
        for word in words {
            by.node(word);
        }
    }

    /// The cell whose lowest corner in mirrored space is `low`.
    fn cell(&self, low: [f32; 3], bit: u32, mirror: u8) -> [i32; 4] {
        let level = MANTISSA_BITS - bit;
        let last = (1u32 << level) - 1;
        let mut cell = [0, 0, 0, level as i32];
        for k in 0..3 {
            let place = low[k].to_bits() >> bit & last;
            let is_mirrored = mirror & (4 >> k) != 0;
            let place = if is_mirrored { last - place } else { place };
            // Places are below 2^level and depth at most 30.
            cell[k] = (place << (self.depth - level)) as i32;
        }
        cell
    }
}

#[inline(always)]
fn least<A: Arithmetic>(by: &mut A, [x, y, z]: [f32; 3]) -> f32 {
    let least = by.min(x, y);
    by.min(least, z)
}

#[inline(always)]
fn greatest<A: Arithmetic>(by: &mut A, [x, y, z]: [f32; 3]) -> f32 {
    let greatest = by.max(x, y);
    by.max(greatest, z)
}
