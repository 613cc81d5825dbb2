//! One ray through the octree.

use super::{LEAST_SLOPE, MANTISSA_BITS};
use shiftvox::graph::GraphView;

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
}

impl Caster<'_> {
    #[inline]
    pub(super) fn cast(
        &self,
        origin: [f32; 3],
        direction: [f32; 3],
        steps: &mut u64,
    ) -> Option<(u32, [i32; 4])> {
        // Octant bit 4 >> k belongs to axis k. Mirrored axes: direction above 0.
        let mut mirror = 0u8;
        // The plane at `p` of axis k is crossed at t = p * slope[k] - bias[k]; slope is negative.
        let mut slope = [0f32; 3];
        let mut bias = [0f32; 3];
        for k in 0..3 {
            let steep = direction[k].abs().max(LEAST_SLOPE);
            slope[k] = -1.0 / steep;
            bias[k] = slope[k] * origin[k];
            if direction[k] > 0.0 {
                mirror |= 4 >> k;
                bias[k] = 3.0 * slope[k] - bias[k];
            }
        }
        let at = |p: f32, k: usize| p * slope[k] - bias[k];
        let enters = [0, 1, 2].map(|k| at(2.0, k));
        let leaves = [0, 1, 2].map(|k| at(1.0, k));
        let mut near = greatest(enters);
        near = near.max(0.0);
        let mut exit = least(leaves);
        // The slopes, the planes, the latest entry and whether it is before the first exit.
        if exit < near {
            return None;
        }
        let mut node = self.graph.root;
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
            let middle = at(1.5, k);
            if near < middle {
                octant |= 4 >> k;
                low[k] = 1.5;
            }
        }
        // Where the parent ends, as put aside last.
        let mut aside = exit;
        loop {
            *steps += 1;
            let leaves = [0, 1, 2].map(|k| at(low[k], k));
            let cell_exit = least(leaves);
            let child_octant = octant ^ mirror;
            if mask >> child_octant & 1 != 0 && exit >= near {
                let child_end = exit.min(cell_exit);
                if child_end >= near
                    && let Some(child) = self.graph.child(node, child_octant)
                {
                    let level = MANTISSA_BITS - bit;
                    let child_mask = self.graph.mask(child);
                    let is_solid = child_mask == 0 || level == self.last_level;
                    if is_solid {
                        return Some((child, self.cell(low, bit, mirror)));
                    }
                    // Descend.
                    if cell_exit < aside {
                        stack[bit as usize] = StackEntry { node, exit };
                    }
                    aside = cell_exit;
                    node = child;
                    mask = child_mask;
                    octant = 0;
                    bit -= 1;
                    side *= 0.5;
                    for k in 0..3 {
                        let step = side * slope[k];
                        let middle = step + leaves[k];
                        if near < middle {
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
                if cell_exit >= leaves[k] {
                    turned |= 4 >> k;
                    low[k] -= side;
                }
            }
            near = cell_exit;
            octant ^= turned;
            if octant & turned == 0 {
                continue;
            }
            // It is not in the same parent: ascend to the lowest that holds both.
            let mut differing = 0u32;
            for k in 0..3 {
                if turned & (4 >> k) != 0 {
                    let before = low[k] + side;
                    differing |= low[k].to_bits() ^ before.to_bits();
                }
            }
            bit = 31 - differing.leading_zeros();
            if bit >= MANTISSA_BITS {
                return None;
            }
            side = f32::from_bits((bit + 127 - MANTISSA_BITS) << MANTISSA_BITS);
            let above = stack[bit as usize];
            node = above.node;
            mask = self.graph.mask(node);
            exit = above.exit;
            octant = 0;
            for k in 0..3 {
                let place = low[k].to_bits() >> bit;
                low[k] = f32::from_bits(place << bit);
                if place & 1 != 0 {
                    octant |= 4 >> k;
                }
            }
            aside = 0.0;
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

fn least([x, y, z]: [f32; 3]) -> f32 {
    x.min(y).min(z)
}

fn greatest([x, y, z]: [f32; 3]) -> f32 {
    x.max(y).max(z)
}
