//! Blocks of clusters, and the clusters around a block.
//!
//! A voxel's normal needs the clusters around its own. A block is a cube of `2^shift` clusters per side, contiguous in
//! Morton order. Clusters at its face are copied to the blocks beside it.

use std::io;

use super::runs::{Merge, Sorter};
use crate::graph::morton;
use crate::graph::normals::cluster::{Cluster, Surroundings, put};

/// Bits per coordinate in a block's grid, which is one cluster wider on each side.
fn slot_bits(shift: u32) -> u32 {
    if shift == 0 { 2 } else { shift + 1 }
}

/// Copies a cluster to the blocks beside its own. `blocks_bits`: bits of a block's coordinate within the object.
pub(super) fn hand_on(
    cluster_key: u64,
    word: u64,
    shift: u32,
    blocks_bits: u32,
    sorter: &mut Sorter,
) -> io::Result<()> {
    let side = 1i64 << shift;
    let at = morton::at(cluster_key).map(i64::from);
    let within = at.map(|c| c & (side - 1));
    if within.iter().all(|&c| c > 0 && c < side - 1) || blocks_bits == 0 {
        return Ok(());
    }
    let block = at.map(|c| c >> shift);
    let rows = Cluster::from(word).by_rows;
    let reaches = |axis: usize, step: i64| match step {
        -1 => within[axis] == 0,
        1 => within[axis] == side - 1,
        _ => true,
    };
    for neighbour in (0..27).filter(|&neighbour| neighbour != 13) {
        let step = [neighbour / 9 - 1, neighbour / 3 % 3 - 1, neighbour % 3 - 1];
        let target = [0, 1, 2].map(|axis| block[axis] + step[axis]);
        let exists = target.iter().all(|&c| c >= 0 && c >> blocks_bits == 0);
        if !exists || !(0..3).all(|axis| reaches(axis, step[axis])) {
            continue;
        }
        let slot = [0, 1, 2].map(|axis| (within[axis] - step[axis] * side + 1) as u64);
        let bits = slot_bits(shift);
        let slot = slot[0] << (2 * bits) | slot[1] << bits | slot[2];
        let key = morton::key(target.map(|c| c as u32)) << (3 * bits) | slot;
        sorter.push(u128::from(key) << 64 | u128::from(rows))?;
    }
    Ok(())
}

/// The clusters of a block and around it, by rows; 0 where there is none.
#[derive(Debug)]
pub(super) struct Grid {
    shift: u32,
    words: Vec<u64>,
    filled: Vec<u32>,
    halo: Merge,
    /// A copy that was read and belongs to a later block.
    ahead: Option<u128>,
}

impl Grid {
    pub(super) fn new(shift: u32, halo: Merge) -> Self {
        let side = (1usize << shift) + 2;
        Self {
            shift,
            words: vec![0; side.pow(3)],
            filled: Vec::new(),
            halo,
            ahead: None,
        }
    }

    fn place(&self, at: [usize; 3]) -> usize {
        let side = (1usize << self.shift) + 2;
        (at[0] * side + at[1]) * side + at[2]
    }

    fn place_of(&self, cluster_key: u64) -> usize {
        let within = (1u32 << self.shift) - 1;
        self.place(morton::at(cluster_key).map(|c| (c & within) as usize + 1))
    }

    fn set(&mut self, place: usize, rows: u64) {
        self.words[place] = rows;
        self.filled.push(place as u32);
    }

    pub(super) fn fill(&mut self, block: u64, clusters: &[[u64; 2]]) -> io::Result<()> {
        for place in self.filled.drain(..) {
            self.words[place as usize] = 0;
        }
        for &[cluster_key, word] in clusters {
            self.set(self.place_of(cluster_key), Cluster::from(word).by_rows);
        }
        let bits = slot_bits(self.shift);
        let mask = (1u64 << bits) - 1;
        loop {
            let next = match self.ahead.take() {
                Some(copy) => Some(copy),
                None => self.halo.next()?,
            };
            let Some(copy) = next else { return Ok(()) };
            let key = super::record::key(copy);
            let of = key >> (3 * bits);
            if of > block {
                self.ahead = Some(copy);
                return Ok(());
            }
            if of == block {
                let slot = [2, 1, 0].map(|axis| (key >> (axis * bits) & mask) as usize);
                self.set(self.place(slot), copy as u64);
            }
        }
    }

    pub(super) fn surroundings(&self, cluster_key: u64) -> Surroundings {
        let side = (1usize << self.shift) + 2;
        let place = self.place_of(cluster_key);
        let mut rows = Surroundings::default();
        for neighbour in 0..27 {
            let [x, y, z] = [neighbour / 9, neighbour / 3 % 3, neighbour % 3];
            let word = self.words[place + (x * side + y) * side + z - (side + 1) * side - 1];
            if word != 0 {
                put(&mut rows, neighbour, word);
            }
        }
        rows
    }
}
