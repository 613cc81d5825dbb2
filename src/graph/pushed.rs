//! Pushed voxels, until they are sorted. A growing `Vec` takes up to three times its contents, so they are kept in
//! pieces, each freed after it is copied to one array at the end.

use rayon::prelude::*;

use super::build::BuildError;
use super::{PackedNormal, morton};
use crate::budget::{self, Shortage};

pub(super) fn extent(min: [i32; 3], max: [i32; 3]) -> Result<[u64; 3], BuildError> {
    let mut extent = [0; 3];
    for (axis, name) in ['x', 'y', 'z'].into_iter().enumerate() {
        let side = i64::from(max[axis]) - i64::from(min[axis]) + 1;
        extent[axis] = side.unsigned_abs();
        if extent[axis] > morton::MAX_SIDE {
            return Err(BuildError::TooLarge {
                axis: name,
                extent: extent[axis],
            });
        }
    }
    Ok(extent)
}

/// Voxels per piece, 40 MB.
const PIECE: usize = 1 << 21;

const VOXELS: &str = "voxels that are sorted";

#[derive(Debug, Clone, Copy)]
pub(super) struct PushedVoxel {
    /// Packed index while pushing, then the Morton key. Two halves, because eight-byte alignment would cost four bytes.
    key_high: u32,
    key_low: u32,
    sequence: u32,
    pub(super) color: [u8; 3],
    pub(super) normal: PackedNormal,
}

impl PushedVoxel {
    pub(super) fn new(
        index: [i32; 3],
        sequence: u32,
        color: [u8; 3],
        normal: PackedNormal,
    ) -> Self {
        let record = Self {
            key_high: 0,
            key_low: 0,
            sequence,
            color,
            normal,
        };
        record.with_key(morton::pack(index))
    }

    pub(super) fn key(&self) -> u64 {
        u64::from(self.key_high) << 32 | u64::from(self.key_low)
    }

    /// The sorting key: the Morton key, then the last pushed first. One number, so that a comparison has no branch.
    fn order(&self) -> u128 {
        u128::from(self.key()) << 32 | u128::from(!self.sequence)
    }

    fn with_key(self, key: u64) -> Self {
        Self {
            key_high: (key >> 32) as u32,
            key_low: key as u32,
            ..self
        }
    }

    fn placed(&self, min: [i32; 3]) -> Self {
        self.with_key(morton::key_from(self.key(), min))
    }
}

/// All voxels pushed, 20 bytes each, and room for at most one piece.
#[derive(Debug, Default)]
pub(super) struct PushedVoxels {
    pieces: Vec<Vec<PushedVoxel>>,
}

impl PushedVoxels {
    pub(super) fn len(&self) -> usize {
        self.pieces.iter().map(Vec::len).sum()
    }

    pub(super) fn push(&mut self, record: PushedVoxel) -> Result<(), Shortage> {
        match self.pieces.last_mut() {
            Some(last) if last.len() < PIECE => {
                let more = last.len() + 1;
                let refused = |_| budget::refused::<PushedVoxel>(VOXELS, more);
                last.try_reserve(1).map_err(refused)?;
                last.push(record);
            }
            None => self.pieces.push(vec![record]),
            Some(_) => {
                let mut piece = budget::room(VOXELS, PIECE)?;
                piece.push(record);
                self.pieces.push(piece);
            }
        }
        Ok(())
    }

    /// Sorts by Morton key from the lowest corner. Of voxels at one index, the last pushed stays.
    pub(super) fn sorted(self, min: [i32; 3]) -> Result<Vec<PushedVoxel>, Shortage> {
        let mut sorted = self.in_one(min)?;
        sorted.par_sort_unstable_by_key(PushedVoxel::order);
        sorted.dedup_by_key(|record| record.key());
        Ok(sorted)
    }

    /// All voxels in one array, with their Morton keys.
    fn in_one(mut self, min: [i32; 3]) -> Result<Vec<PushedVoxel>, Shortage> {
        if self.pieces.len() == 1
            && let Some(mut only) = self.pieces.pop()
        {
            only.par_iter_mut()
                .for_each(|record| *record = record.placed(min));
            return Ok(only);
        }
        let mut all = budget::room(VOXELS, self.len())?;
        for piece in self.pieces {
            all.par_extend(piece.par_iter().map(|record| record.placed(min)));
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_hold_little_more_than_their_voxels_and_sort() {
        assert_eq!(size_of::<PushedVoxel>(), 20);
        let count = 2 * PIECE + 1000;
        let mut grown = PushedVoxels::default();
        for i in 0..count as u32 {
            // The last of each thousand lies where the first does, in a row that runs through all axes.
            let at = if i % 1000 == 999 { i - 999 } else { i };
            let index = [at % 100, at / 100 % 200, at / 20_000].map(|c| c as i32 - 50);
            let pushed = PushedVoxel::new(index, i, [i as u8; 3], PackedNormal::NONE);
            grown.push(pushed).unwrap();
            let room: usize = grown.pieces.iter().map(Vec::capacity).sum();
            let first = grown.len().next_power_of_two().max(4);
            assert!(room <= first.min(grown.len() + PIECE).max(4));
        }
        assert_eq!((grown.len(), grown.pieces.len()), (count, 3));
        let grown = grown.sorted([-50; 3]).unwrap();
        assert!(grown.is_sorted_by_key(PushedVoxel::key));
        // The last pushed stays.
        assert_eq!(
            (grown.len(), grown[0].sequence),
            (count - count / 1000, 999)
        );
    }
}
