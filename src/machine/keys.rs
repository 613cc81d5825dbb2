//! Places in the order, for frames that are not drawn in order.
//!
//! A record's key has three bits per octree level: which child it is in the order of R9 (`SPEC.md`), the nearest 0. Bits
//! below its own level are 0, as in the key of its nearest part. Of two voxels that meet a ray, the one with the smaller
//! key is nearer. So a record hides nothing new at a sample whose voxel has the same key or a smaller one.
//!
//! A pyramid over the picture holds the largest key of each quadtree node. It takes the place of the fill vectors: for a
//! record, a quadrant is full if its largest key is at most the record's. A nearer voxel takes samples over, so the
//! picture is the same in any order of drawing.
//!
//! A word of the pyramid holds the keys of a node's four quadrants. The last one read stays in a register.

use hwmodel::{Datapath, Probe, Word};

use crate::budget::{self, Shortage};
use crate::frame::quadtree::{FULL, nodes_to};
use crate::frame::{FillVectors, QuadNode};

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(super) struct OrderKey(u64);

impl OrderKey {
    /// Of a sample without a voxel: larger than all others.
    const NONE: Self = Self(1 << 62);

    /// Of a child, nearest 0, that is `below` levels above the finest voxels.
    #[inline(always)]
    pub(super) fn child(self, rank: u8, below: u32) -> Self {
        let bits = u64::from(rank).checked_shl(bits(below)).unwrap_or(0);
        Self(self.0 | bits)
    }

    /// Of the ancestor that is `below` levels above the finest voxels.
    pub(super) fn ancestor(self, below: u32) -> Self {
        let kept = u64::MAX.checked_shl(bits(below)).unwrap_or(0);
        Self(self.0 & kept)
    }

    fn word(self) -> Word {
        Word::from_host(self.0 as i64)
    }
}

/// Three per level.
fn bits(levels: u32) -> u32 {
    (levels << 1) + levels
}

#[derive(Debug)]
pub(super) struct Keys {
    levels: u32,
    /// By address of the quadtree node. Samples outside the picture have the smallest.
    largest: Vec<OrderKey>,
    /// The tile in progress. For the nodes above it, the rest of the picture is full.
    pub(super) tile: QuadNode,
}

impl Keys {
    /// Of an empty picture, which has these fill vectors.
    pub(super) fn new(empty: &FillVectors) -> Result<Self, Shortage> {
        let levels = empty.levels();
        let what = "the order of a picture";
        let mut largest = budget::filled(what, OrderKey::NONE, nodes_to(levels))?;
        for level in 0..=levels {
            let side = 1u32 << level;
            for node in (0..side).flat_map(|y| (0..side).map(move |x| QuadNode { level, x, y })) {
                if empty.vector(node) == FULL {
                    largest[node.address()] = OrderKey::default();
                }
            }
        }
        Ok(Self {
            levels,
            largest,
            tile: QuadNode::ROOT,
        })
    }

    /// The node whose word has the key of a sample, or of another node's quadrants.
    pub(super) fn word_of(&self, node: QuadNode) -> QuadNode {
        node.ancestor(node.level.min(self.levels.saturating_sub(1)))
    }

    /// The fill vector of a node, as a record with this key finds it.
    pub(super) fn vector(
        &self,
        node: QuadNode,
        key: OrderKey,
        mut at_most: impl FnMut(OrderKey, OrderKey) -> bool,
    ) -> u8 {
        let mut is_full = |of: QuadNode| at_most(self.largest[of.address()], key);
        if node.level == self.levels {
            return if is_full(node) { FULL } else { 0 };
        }
        if node.level < self.tile.level {
            let towards_tile = self.tile.ancestor(node.level + 1).in_parent();
            return u8::from(is_full(self.tile)) << towards_tile;
        }
        (0..4).fold(0, |bits, quadrant| {
            bits | u8::from(is_full(node.quadrant(quadrant))) << quadrant
        })
    }

    /// Gives a sample to the voxel with this key, nearer than the voxel that had it. `access` reports the read and the write
    /// of one word.
    pub(super) fn claim<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        sample: QuadNode,
        key: OrderKey,
        mut access: impl FnMut(&mut Datapath<P>, QuadNode),
    ) {
        self.largest[sample.address()] = key;
        let mut node = sample;
        while node.level > self.tile.level {
            node = node.ancestor(node.level - 1);
            access(dp, node);
            let mut largest = OrderKey::default();
            for quadrant in 0..4 {
                let of = self.largest[node.quadrant(quadrant).address()];
                if quadrant > 0 {
                    dp.max(largest.word(), of.word());
                }
                largest = largest.max(of);
            }
            let before = &mut self.largest[node.address()];
            if at_most(dp, *before, largest) {
                break;
            }
            *before = largest;
        }
    }
}

pub(super) fn at_most<P: Probe>(dp: &mut Datapath<P>, a: OrderKey, b: OrderKey) -> bool {
    dp.le(a.word(), b.word())
}
