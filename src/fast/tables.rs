//! Tables of one subtree, kept from brick to brick: where the parts of a node
//! are, and what samples add to the functions.

use super::lanes::Isa;
use super::subtree::{LANES, STRIPS, Subtree};
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

    /// Cuts the strips of parts to bytes: of a node one level above the finest,
    /// of its 8 children; of one two or three levels above, of the 64 children of
    /// its children, which are one finest voxel wide, or two.
    /// `left`: levels from the node to the finest.
    ///
    /// Sums of cut numbers are at most one below the cut sum, differences at
    /// most one above the cut difference: so a value that is within its width
    /// is, in bytes, at most two above it.
    #[inline(always)]
    fn make<I: Isa>(&mut self, isa: I, subtree: &Subtree, octant: u8, left: u32) {
        // Parts of a node three levels above are twice as large.
        let twice = u32::from(left == 3);
        for f in 0..STRIPS {
            // Values differ by less than this; a little more for what cutting adds.
            let range = (subtree.brick_range(f) as u32 + 1) << twice;
            let bits = 32 - (range + range / 32).leading_zeros();
            let shift = bits.saturating_sub(8);
            self.shift[f] = shift as i32;
            let half = (subtree.half_width[f] << twice) + subtree.reach[f];
            self.width[f] = [((2 * half) >> shift) as u8 + 2; 32];
            // The exclusive or with the octant turns axes around.
            let mut children = [0i32; 8];
            let [x, y, z] = [
                turned(subtree.half_edge[0][f] << twice, octant >> 2),
                turned(subtree.half_edge[1][f] << twice, octant >> 1),
                turned(subtree.half_edge[2][f] << twice, octant),
            ];
            for i in 0..8 {
                children[i] = NEAREST[0][i] * x + NEAREST[1][i] * y + NEAREST[2][i] * z;
            }
            isa.byte_table(&mut self.parts[f], &children, shift, left == 1);
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
    pub(super) made_for: Option<(u32, u8)>,
    /// The parts of a node, in bytes.
    pub(super) parts: Coarse,
    /// By levels above the finest, less one, in occlusion order: the centre of
    /// a child relative to its parent's.
    children: [[[i32; LANES]; 8]; 3],
    /// The first of `children` by function: strips, box across, box down.
    pub(super) by_function: [[i32; 8]; STRIPS + 2],
    /// What so many columns, and so many rows, add.
    steps: [[[i32; LANES]; 8]; 2],
    /// The bound of a finest voxel: [`Subtree::bound`].
    pub(super) half: [i32; LANES],
    /// Twice as much.
    pub(super) width: [i32; LANES],
    /// In a frame without tolerance, what a value is less from the lower bound
    /// that is certain to be inside, and the width of what is.
    pub(super) sure: [[i32; LANES]; 2],
    /// Whether anything is certain: no such width is below zero.
    pub(super) has_sure: bool,
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
            children: [[[0; LANES]; 8]; 3],
            by_function: [[0; 8]; STRIPS + 2],
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
            isa.square_table(&mut self.square[f], subtree.step[0][f], subtree.step[1][f]);
            most = most.max(subtree.voxel_range(f)).max(2 * subtree.bound[f]);
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
            lower[lane] = subtree.bound[lane];
            self.width[lane] = 2 * subtree.bound[lane];
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
            let twice = isa.add(child, child);
            self.children[1][i] = isa.store(twice);
            if left == 3 {
                self.children[2][i] = isa.store(isa.add(twice, twice));
                for (f, by_child) in self.by_function.iter_mut().enumerate() {
                    // Behind the strips a lane is left out.
                    by_child[i] = self.children[0][i][f + usize::from(f >= STRIPS)];
                }
            }
        }
        self.parts.make(isa, subtree, octant, left);
    }

    /// The functions at a sample of a square, from those at its first.
    #[inline(always)]
    pub(super) fn value_at<I: Isa>(&self, isa: I, first: I::Eight, bit: u32) -> I::Eight {
        let value = isa.add(first, isa.load(&self.steps[0][bit as usize & 7]));
        isa.add(value, isa.load(&self.steps[1][bit as usize >> 3 & 7]))
    }

    /// A value relative to the centre of a lane's finest voxel, from one
    /// relative to the centre of a node `levels` levels above.
    #[inline(always)]
    pub(super) fn in_part<I: Isa>(
        &self,
        isa: I,
        value: I::Eight,
        levels: u32,
        lane: u32,
    ) -> I::Eight {
        let [inner, outer, _] = &self.children;
        let value = isa.sub(value, isa.load(&inner[lane as usize & 7]));
        if levels == 1 {
            return value;
        }
        isa.sub(value, isa.load(&outer[lane as usize >> 3 & 7]))
    }

    /// A value relative to the centre of a lane's part, of which `lane` counts
    /// those one level above the finest, from one relative to the centre of a
    /// node three levels above.
    #[inline(always)]
    pub(super) fn in_large_part<I: Isa>(&self, isa: I, value: I::Eight, lane: u32) -> I::Eight {
        let [_, inner, outer] = &self.children;
        let value = isa.sub(value, isa.load(&inner[lane as usize & 7]));
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
