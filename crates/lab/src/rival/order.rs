//! The order in which rays are cast, on which it depends what a cache finds: along the Z curve (Morton), whose every
//! quadrant is done before the next.

/// Column and row of every sample of a picture, once each.
pub(super) fn samples(width: u32, height: u32) -> impl Iterator<Item = (u32, u32)> {
    let side = u64::from(width.max(height).max(1).next_power_of_two());
    let along = (0..side * side).map(|place| (even_bits(place), even_bits(place >> 1)));
    along.filter(move |&(i, j)| i < width && j < height)
}

fn even_bits(number: u64) -> u32 {
    let mut bits = number & 0x5555_5555_5555_5555;
    for (shift, mask) in [
        (1, 0x3333_3333_3333_3333),
        (2, 0x0f0f_0f0f_0f0f_0f0f),
        (4, 0x00ff_00ff_00ff_00ff),
        (8, 0x0000_ffff_0000_ffff),
        (16, 0x0000_0000_ffff_ffff),
    ] {
        bits = (bits | bits >> shift) & mask;
    }
    bits as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sample_once() {
        let mut visited: Vec<_> = samples(19, 13).collect();
        visited.sort_unstable_by_key(|&(i, j)| (j, i));
        let all: Vec<_> = (0..19 * 13).map(|at| (at % 19, at / 19)).collect();
        assert_eq!(visited, all);
        // 13 is 0b1101: bits 0 and 2 are the column 0b11, bits 1 and 3 the row 0b10.
        assert_eq!(samples(16, 16).nth(13), Some((3, 2)));
    }
}
