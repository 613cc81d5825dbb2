//! How many records were worked on for each sample: the frame's `records`.

use super::watch::Watch;
use crate::frame::QuadNode;
use crate::frame::quadtree::nodes_to;

/// Counts the records of each quadtree node.
#[derive(Debug)]
pub(super) struct Heat {
    /// Level of the samples.
    levels: u32,
    /// Records by the address of their node.
    records: Vec<u32>,
}

impl Heat {
    /// For a quadtree whose samples are at level `levels`.
    pub(super) fn new(levels: u32) -> Self {
        Self {
            levels,
            records: vec![0; nodes_to(levels)],
        }
    }

    /// Writes each sample's share: a record counts 1, spread evenly over the
    /// samples of its node. `shares`: row by row, `width` samples a row.
    pub(super) fn write_shares(&self, width: u32, shares: &mut [f32]) {
        let width = width as usize;
        for (at, share) in shares.iter_mut().enumerate() {
            let (x, y) = ((at % width) as u32, (at / width) as u32);
            *share = (0..=self.levels)
                .map(|level| {
                    let below = self.levels - level;
                    let quad = QuadNode {
                        level,
                        x: x >> below,
                        y: y >> below,
                    };
                    let samples = f64::from(1u32 << below) * f64::from(1u32 << below);
                    f64::from(self.records[quad.address()]) / samples
                })
                .sum::<f64>() as f32;
        }
    }
}

impl Watch for Heat {
    #[inline(always)]
    fn turn(&mut self, quad: QuadNode) {
        self.records[quad.address()] += 1;
    }
}
