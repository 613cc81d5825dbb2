//! The order in which rays are cast: what a cache finds depends on it.

use serde::{Deserialize, Serialize};

/// An order of a picture's rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RayOrder {
    /// Row by row, from the left.
    Rows,
    /// Tiles of 8 x 8 row by row, and the rays of each row by row.
    Tiles,
    /// Along the Z curve (Morton), whose every quadrant is done before the next.
    Morton,
}

const TILE: u32 = 8;

impl RayOrder {
    /// Calls `visit` with column and row of every sample of a picture, once each.
    pub fn for_each(self, width: u32, height: u32, mut visit: impl FnMut(u32, u32)) {
        match self {
            Self::Rows => {
                for j in 0..height {
                    (0..width).for_each(|i| visit(i, j));
                }
            }
            Self::Tiles => {
                for top in (0..height).step_by(TILE as usize) {
                    for left in (0..width).step_by(TILE as usize) {
                        for j in top..height.min(top + TILE) {
                            (left..width.min(left + TILE)).for_each(|i| visit(i, j));
                        }
                    }
                }
            }
            Self::Morton => {
                let side = u64::from(width.max(height).max(1).next_power_of_two());
                for place in 0..side * side {
                    let (i, j) = (even_bits(place), even_bits(place >> 1));
                    if i < width && j < height {
                        visit(i, j);
                    }
                }
            }
        }
    }
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
        let order = |of: RayOrder, width, height| {
            let mut visited = Vec::new();
            of.for_each(width, height, |i, j| visited.push((i, j)));
            visited
        };
        let all: Vec<_> = (0..19 * 13).map(|at| (at % 19, at / 19)).collect();
        assert_eq!(order(RayOrder::Rows, 19, 13), all);
        for of in [RayOrder::Tiles, RayOrder::Morton] {
            let mut visited = order(of, 19, 13);
            visited.sort_unstable_by_key(|&(i, j)| (j, i));
            assert_eq!(visited, all, "{of:?}");
        }
        let tiles = order(RayOrder::Tiles, 16, 16);
        assert_eq!((tiles[9], tiles[64]), ((1, 1), (8, 0)));
        // 13 is 0b1101: bits 0 and 2 are the column 0b11, bits 1 and 3 the row 0b10.
        assert_eq!(order(RayOrder::Morton, 16, 16)[13], (3, 2));
    }
}
