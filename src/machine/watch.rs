//! Events of whole records; all others go to an [`hwmodel::Probe`].

use super::cage::CageCoordinate;
use super::record::Record;
use crate::budget::{self, Shortage};
use crate::frame::QuadNode;
use crate::frame::quadtree::nodes_to;

#[derive(Debug, Clone, Copy)]
pub(super) enum Event<'r, L> {
    /// The turn of a record begins; with its quadtree node.
    Turn(QuadNode),
    /// A child was pushed; with its place in the occlusion order, 0 (nearest) to 7.
    Pushed(u8),
    Made(&'r Record<L>),
}

/// Receives the events of records. The calls compile to nothing for the watch `()`.
pub(super) trait Watch {
    fn see<L: CageCoordinate>(&mut self, event: Event<'_, L>);
}

impl Watch for () {
    #[inline(always)]
    fn see<L: CageCoordinate>(&mut self, _: Event<'_, L>) {}
}

impl<W: Watch> Watch for Option<W> {
    #[inline(always)]
    fn see<L: CageCoordinate>(&mut self, event: Event<'_, L>) {
        if let Some(watch) = self {
            watch.see(event);
        }
    }
}

/// Counts the turns at each quadtree node, for a map of work.
#[derive(Debug)]
pub(super) struct RecordsBySample {
    /// Level of the samples.
    levels: u32,
    /// By address of the quadtree node.
    turns: Vec<u32>,
}

impl RecordsBySample {
    pub(super) fn new(levels: u32) -> Result<Self, Shortage> {
        let turns = budget::filled("a map of work", 0, nodes_to(levels))?;
        Ok(Self { levels, turns })
    }

    /// Writes each sample's share, in rows of `width`: a record counts 1, spread evenly over its node's samples.
    pub(super) fn write_shares(&self, width: u32, shares: &mut [f32]) {
        let width = width as usize;
        for (at, share) in shares.iter_mut().enumerate() {
            let (level, x, y) = (self.levels, (at % width) as u32, (at / width) as u32); // host: a map of work
            let sample = QuadNode { level, x, y };
            *share = (0..=self.levels)
                .map(|level| {
                    let below = self.levels - level;
                    let samples = f64::from(1u32 << below) * f64::from(1u32 << below); // host: a map of work
                    f64::from(self.turns[sample.ancestor(level).address()]) / samples // host: a map of work
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
