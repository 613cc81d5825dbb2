//! The image quadtree and its fill vectors (image-order paper, 3.3).
//!
//! A bit per quadrant (`y << 1 | x`). A drawn sample sets all its bits; a full node sets its bit in its parent. Quadrants
//! outside the picture are full from the start, so clipping is the same test as occlusion.

use crate::budget::{self, Shortage};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct QuadNode {
    /// Level, 0 = root; a sample is at the deepest level.
    pub level: u32,
    pub x: u32,
    pub y: u32,
}

impl QuadNode {
    pub const ROOT: Self = Self {
        level: 0,
        x: 0,
        y: 0,
    };

    #[inline]
    #[must_use]
    pub const fn quadrant(self, quadrant: u8) -> Self {
        Self {
            level: self.level + 1,
            x: self.x << 1 | (quadrant & 1) as u32,
            y: self.y << 1 | (quadrant >> 1) as u32,
        }
    }

    #[inline(always)]
    #[must_use]
    pub const fn ancestor(self, level: u32) -> Self {
        let below = self.level - level;
        Self {
            level,
            x: self.x >> below,
            y: self.y >> below,
        }
    }

    /// Address of the node's fill vector: level by level, row by row.
    #[inline]
    pub const fn address(self) -> usize {
        level_start(self.level) + ((self.y as usize) << self.level) + self.x as usize
    }

    #[inline]
    pub const fn in_parent(self) -> u8 {
        ((self.y & 1) << 1 | self.x & 1) as u8
    }
}

pub const FULL: u8 = 0b1111;

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FillVectors {
    levels: u32,
    vectors: Vec<u8>,
    empty_picture: Vec<u8>,
}

const LEVELS: usize = 32;

/// Place of each level's first node among all nodes: `(4^level - 1) / 3`.
const LEVEL_STARTS: [usize; LEVELS] = {
    let mut starts = [0usize; LEVELS];
    let mut level = 1;
    while level < LEVELS {
        // Beyond 32 bits only where no picture of that size can exist.
        starts[level] = starts[level - 1].wrapping_mul(4).wrapping_add(1);
        level += 1;
    }
    starts
};

#[inline(always)]
const fn level_start(level: u32) -> usize {
    LEVEL_STARTS[level as usize % LEVELS]
}

/// Nodes of the image quadtree from its root to the samples, at level `levels`.
pub const fn nodes_to(levels: u32) -> usize {
    level_start(levels + 1)
}

impl FillVectors {
    /// Errors: [`Shortage`] if there is too little memory.
    pub fn new(levels: u32, width: u32, height: u32) -> Result<Self, Shortage> {
        let (what, nodes) = ("the fill vectors of a picture", nodes_to(levels));
        if nodes > 1 << 23 {
            budget::check(what, 2 * nodes as u64)?;
        }
        let mut fill = Self {
            levels,
            vectors: budget::filled(what, 0, nodes)?,
            empty_picture: budget::room(what, nodes)?,
        };
        for level in (0..=levels).rev() {
            let side = 1u32 << level;
            for y in 0..side {
                for x in 0..side {
                    let node = QuadNode { level, x, y };
                    let vector = if level == levels {
                        if x < width && y < height { 0 } else { FULL }
                    } else {
                        (0..4).fold(0, |bits, quadrant| {
                            let full = fill.vector(node.quadrant(quadrant)) == FULL;
                            bits | u8::from(full) << quadrant
                        })
                    };
                    let at = node.address();
                    fill.vectors[at] = vector;
                }
            }
        }
        fill.empty_picture.extend_from_slice(&fill.vectors);
        Ok(fill)
    }

    pub fn clear(&mut self) {
        self.vectors.copy_from_slice(&self.empty_picture);
    }

    pub fn levels(&self) -> u32 {
        self.levels
    }

    #[inline]
    pub fn vector(&self, node: QuadNode) -> u8 {
        self.vectors[node.address()]
    }

    #[inline]
    pub fn set(&mut self, node: QuadNode, bits: u8) -> u8 {
        let at = node.address();
        self.vectors[at] |= bits;
        self.vectors[at]
    }

    pub fn replace(&mut self, node: QuadNode, vector: u8) -> u8 {
        std::mem::replace(&mut self.vectors[node.address()], vector)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outside_the_picture_is_full_from_the_start() {
        let fill = FillVectors::new(3, 5, 2).expect("memory");
        // Rows 4..8 are outside: both lower quadrants of the root. Column 4 alone is inside the upper right quadrant.
        assert_eq!(fill.vector(QuadNode::ROOT), 0b1100);
        assert_eq!(fill.vector(QuadNode::ROOT.quadrant(1)), 0b1110);
        for (level, y, x) in (0..3).flat_map(|level| {
            let side = 1 << level;
            (0..side * side).map(move |at| (level, at / side, at % side))
        }) {
            let node = QuadNode { level, x, y };
            for quadrant in 0..4 {
                let is_full = fill.vector(node.quadrant(quadrant)) == FULL;
                assert_eq!(is_full, fill.vector(node) >> quadrant & 1 != 0);
            }
        }
        let mut fill = FillVectors::new(0, 1, 1).expect("memory");
        assert_eq!(fill.vector(QuadNode::ROOT), 0);
        assert_eq!(fill.set(QuadNode::ROOT, FULL), FULL);
        fill.clear();
        assert_eq!(fill.vector(QuadNode::ROOT), 0);
    }
}
