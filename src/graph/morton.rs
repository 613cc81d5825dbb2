//! Morton order: the bits of x, y and z interleaved, x highest.

pub(super) const MAX_BITS: u32 = 21;
pub(super) const MAX_SIDE: u64 = 1 << MAX_BITS;

/// Bytes with two zeros after each bit.
const SPREAD: [u32; 256] = {
    let mut table = [0; 256];
    let mut value = 0;
    while value < 256 {
        let mut bit = 0;
        while bit < 8 {
            table[value] |= (value as u32 >> bit & 1) << (3 * bit);
            bit += 1;
        }
        value += 1;
    }
    table
};

/// Inserts two zeros after each of 21 bits.
#[inline]
fn spread(value: u32) -> u64 {
    let byte = |shift: u32| u64::from(SPREAD[(value >> shift & 0xff) as usize]);
    byte(0) | byte(8) << 24 | (byte(16) & 0x1fff) << 48
}

/// The Morton key of coordinates below `2^21`: per level, from the root, an octant `x << 2 | y << 1 | z`.
pub(super) fn key(at: [u32; 3]) -> u64 {
    spread(at[0]) << 2 | spread(at[1]) << 1 | spread(at[2])
}

fn gather(bits: u64) -> u32 {
    let mut value = bits & 0x1249_2492_4924_9249;
    value = (value | value >> 2) & 0x10c3_0c30_c30c_30c3;
    value = (value | value >> 4) & 0x100f_00f0_0f00_f00f;
    value = (value | value >> 8) & 0x001f_0000_ff00_00ff;
    value = (value | value >> 16) & 0x001f_0000_0000_ffff;
    ((value | value >> 32) & 0x1f_ffff) as u32
}

pub(super) fn at(key: u64) -> [u32; 3] {
    [gather(key >> 2), gather(key >> 1), gather(key)]
}

/// An index along three axes, modulo `2^21`, in 63 bits.
pub(super) fn pack(index: [i32; 3]) -> u64 {
    let [x, y, z] = index.map(|c| u64::from(c as u32) & (MAX_SIDE - 1));
    x | y << MAX_BITS | z << (2 * MAX_BITS)
}

/// The Morton key of a packed index, counted from a corner at most `2^21 - 1` below it.
pub(super) fn key_from(packed: u64, corner: [i32; 3]) -> u64 {
    key([0, 1, 2].map(|axis| {
        let low_bits = (packed >> (axis as u32 * MAX_BITS)) as u32;
        low_bits.wrapping_sub(corner[axis] as u32) & (MAX_SIDE as u32 - 1)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_interleaved_and_come_back() {
        for bit in 0..3 * MAX_BITS {
            let mut place = [0; 3];
            place[2 - bit as usize % 3] = 1 << (bit / 3);
            assert_eq!((key(place), at(1 << bit)), (1 << bit, place));
        }
        assert_eq!(
            at(key([0x1f_ffff, 0x12_3456, 7])),
            [0x1f_ffff, 0x12_3456, 7]
        );
    }
}
