//! Pushed voxels, until they are sorted.

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

/// From this number on, a list grows by a quarter. Its pages are moved, not copied, where the system can.
const MANY: usize = 1 << 20;

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
        let mut record = Self {
            key_high: 0,
            key_low: 0,
            sequence,
            color,
            normal,
        };
        record.set_key(morton::pack(index));
        record
    }

    pub(super) fn key(&self) -> u64 {
        u64::from(self.key_high) << 32 | u64::from(self.key_low)
    }

    /// The sorting key: the Morton key, then the last pushed first. One number, so that a comparison has no branch.
    fn order(&self) -> u128 {
        u128::from(self.key()) << 32 | u128::from(!self.sequence)
    }

    fn set_key(&mut self, key: u64) {
        self.key_high = (key >> 32) as u32;
        self.key_low = key as u32;
    }
}

/// All voxels pushed, 20 bytes each.
#[derive(Debug, Default)]
pub(super) struct PushedVoxels(Vec<PushedVoxel>);

impl PushedVoxels {
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    #[inline]
    pub(super) fn push(&mut self, record: PushedVoxel) -> Result<(), Shortage> {
        if self.0.len() == self.0.capacity() {
            self.grow()?;
        }
        self.0.push(record);
        Ok(())
    }

    #[cold]
    fn grow(&mut self) -> Result<(), Shortage> {
        let length = self.len();
        let grown = match length < MANY {
            true => self.0.try_reserve(1),
            false => self.0.try_reserve_exact(length / 4),
        };
        grown.map_err(|_| budget::refused::<PushedVoxel>(VOXELS, length + 1))
    }

    /// Sorts by Morton key from the lowest corner. Of voxels at one index, the last pushed stays.
    pub(super) fn sorted(self, min: [i32; 3]) -> Vec<PushedVoxel> {
        let mut sorted = self.0;
        let place = |record: &mut PushedVoxel| record.set_key(morton::key_from(record.key(), min));
        sorted.par_iter_mut().for_each(place);
        sorted.par_sort_unstable_by_key(PushedVoxel::order);
        sorted.dedup_by_key(|record| record.key());
        sorted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_take_little_more_than_their_contents_and_sort() {
        assert_eq!(size_of::<PushedVoxel>(), 20);
        let count = 2 * MANY + 1000;
        let mut grown = PushedVoxels::default();
        for i in 0..count as u32 {
            // The last of each thousand lies where the first does, in a row that runs through all axes.
            let at = if i % 1000 == 999 { i - 999 } else { i };
            let index = [at % 100, at / 100 % 200, at / 20_000].map(|c| c as i32 - 50);
            let pushed = PushedVoxel::new(index, i, [i as u8; 3], PackedNormal::NONE);
            grown.push(pushed).unwrap();
            let length = grown.len();
            assert!(grown.0.capacity() <= (length + MANY.min(length).max(length / 4)).max(4));
        }
        assert_eq!(grown.len(), count);
        let grown = grown.sorted([-50; 3]);
        assert!(grown.is_sorted_by_key(PushedVoxel::key));
        // The last pushed stays.
        assert_eq!(
            (grown.len(), grown[0].sequence),
            (count - count / 1000, 999)
        );
    }
}
