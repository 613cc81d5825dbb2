//! Morton order: the bits of x, y and z interleaved, x highest.

pub(super) const MAX_BITS: u32 = 21;
pub(super) const MAX_SIDE: u64 = 1 << MAX_BITS;

/// Inserts two zeros after each of 21 bits.
fn spread(value: u32) -> u64 {
    let mut bits = u64::from(value) & 0x1f_ffff;
    bits = (bits | bits << 32) & 0x001f_0000_0000_ffff;
    bits = (bits | bits << 16) & 0x001f_0000_ff00_00ff;
    bits = (bits | bits << 8) & 0x100f_00f0_0f00_f00f;
    bits = (bits | bits << 4) & 0x10c3_0c30_c30c_30c3;
    (bits | bits << 2) & 0x1249_2492_4924_9249
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
    index.into_iter().rev().fold(0, |packed, index| {
        packed << MAX_BITS | u64::from(index as u32) & (MAX_SIDE - 1)
    })
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
