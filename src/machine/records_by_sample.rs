//! Records per sample: the frame's `records`, a measure of work that reports show as a heat map.

use super::cage::CageCoordinate;
use super::watch::{Event, Watch};
use crate::frame::QuadNode;
use crate::frame::quadtree::nodes_to;

/// Counts the turns at each quadtree node.
#[derive(Debug)]
pub(super) struct RecordsBySample {
    levels: u32,
    /// By address of the quadtree node.
    turns: Vec<u32>,
}

impl RecordsBySample {
    /// For a quadtree whose samples are at level `levels`.
    pub(super) fn new(levels: u32) -> Self {
        Self {
            levels,
            turns: vec![0; nodes_to(levels)],
        }
    }

    /// Writes each sample's share: a record counts 1, spread evenly over the samples of its node. `shares` has rows of
    /// `width` samples.
    pub(super) fn write_shares(&self, width: u32, shares: &mut [f32]) {
        let width = width as usize;
        for (at, share) in shares.iter_mut().enumerate() {
            let (level, x, y) = (self.levels, (at % width) as u32, (at / width) as u32);
            let sample = QuadNode { level, x, y };
            *share = (0..=self.levels)
                .map(|level| {
                    let below = self.levels - level;
                    let samples = f64::from(1u32 << below) * f64::from(1u32 << below);
                    f64::from(self.turns[sample.ancestor(level).address()]) / samples
                })
                .sum::<f64>() as f32;
        }
    }
}

impl Watch for RecordsBySample {
    #[inline(always)]
    fn see<L: CageCoordinate>(&mut self, event: Event<'_, L>) {
        if let Event::Turn(quad) = event {
            self.turns[quad.address()] += 1;
        }
    }
}
