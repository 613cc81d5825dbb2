//! Tables of octants (rule R9), and the slabs of a node's 64 parts.

use super::lanes::{Isa, Lanes, U8x16};

/// Child masks, turned by octant: bit `c` is child `c ^ octant`.
static TURNED: [[u8; 256]; 8] = {
    let mut table = [[0u8; 256]; 8];
    let mut octant = 0;
    while octant < 8 {
        let mut mask = 0;
        while mask < 256 {
            let mut child = 0;
            while child < 8 {
                table[octant][mask] |= ((mask >> (child ^ octant)) as u8 & 1) << child;
                child += 1;
            }
            mask += 1;
        }
        octant += 1;
    }
    table
};

#[inline(always)]
pub(super) fn turned(mask: u8, octant: u8) -> u8 {
    TURNED[usize::from(octant & 7)][usize::from(mask)]
}

#[inline(always)]
pub(super) fn turned_parts<I: Isa>(isa: I, parts: u64, octant: u8) -> u64 {
    let [outer, low, high] = &TURNED_BYTES[usize::from(octant & 7)];
    let [lower, upper] = isa
        .bytes(parts)
        .look_up(I::U8x16::load(isa, outer))
        .nibbles();
    let low = I::U8x16::load(isa, low).look_up(lower);
    low.or(I::U8x16::load(isa, high).look_up(upper)).low()
}

/// By octant: the outer octants' order, and a mask's lower and upper half turned.
static TURNED_BYTES: [[[u8; 16]; 3]; 8] = {
    let mut table = [[[0u8; 16]; 3]; 8];
    let mut octant = 0;
    while octant < 8 {
        let mut i = 0;
        while i < 16 {
            table[octant][0][i] = (i as u8 & 7) ^ octant as u8;
            table[octant][1][i] = TURNED[octant][i];
            table[octant][2][i] = TURNED[octant][i << 4];
            i += 1;
        }
        octant += 1;
    }
    table
};

pub(super) const fn along(part: usize, axis: usize) -> usize {
    (part >> (5 - axis) & 1) << 1 | part >> (2 - axis) & 1
}

pub(super) static SLABS: [[u64; 4]; 3] = {
    let mut table = [[0; 4]; 3];
    let mut part = 0;
    while part < 64 {
        let mut axis = 0;
        while axis < 3 {
            table[axis][along(part, axis)] |= 1 << part;
            axis += 1;
        }
        part += 1;
    }
    table
};

/// Middle of the filled range, from the node's centre, and half its extent, in sides of a slab. Indexed by axis and by
/// its filled slabs; the numbers are in the axis' lane.
pub(super) static EXTENTS: [[[[f32; 4]; 2]; 16]; 3] = {
    let mut table = [[[[0.0; 4]; 2]; 16]; 3];
    let mut slabs = 1u32;
    while slabs < 16 {
        let first = slabs.trailing_zeros() as f32;
        let end = 32.0 - slabs.leading_zeros() as f32;
        let mut axis = 0;
        while axis < 3 {
            table[axis][slabs as usize][0][axis] = (first + end) / 2.0 - 2.0;
            table[axis][slabs as usize][1][axis] = (end - first) / 2.0;
            axis += 1;
        }
        slabs += 1;
    }
    table
};
