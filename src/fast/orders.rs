//! Order by octants (rule R9), and the slabs of a node's 64 parts.

/// Distances between the parts that a bit of an octant swaps, and the lower ones of them.
const SWAPS: [(u32, u64); 6] = [
    (1, 0x5555_5555_5555_5555),
    (2, 0x3333_3333_3333_3333),
    (4, 0x0f0f_0f0f_0f0f_0f0f),
    (8, 0x00ff_00ff_00ff_00ff),
    (16, 0x0000_ffff_0000_ffff),
    (32, 0xffff_ffff),
];

/// A mask of parts, turned by octant: bit `p` is part `p ^ 9 octant`.
pub(super) const fn turned_parts(mut parts: u64, octant: u8) -> u64 {
    let mut i = 0;
    while i < 6 {
        let (places, lower) = SWAPS[i];
        if octant >> (i % 3) & 1 != 0 {
            parts = (parts & lower) << places | parts >> places & lower;
        }
        i += 1;
    }
    parts
}

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
