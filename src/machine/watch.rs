//! Watching the machine, record by record.
//!
//! Single operations, accesses to memory and what crosses the borders of blocks
//! are reported to an [`hwmodel::Probe`]; what the record loop does with whole
//! records is reported to a [`Watch`].

use super::cage::CageCoordinate;
use super::record::Record;
use crate::frame::QuadNode;

/// Receives what happens to records. Every method does nothing by default, so
/// that the calls compile to nothing for the watch `()`.
pub(super) trait Watch {
    /// The turn of a record begins, whose quadtree node is `quad`.
    fn turn(&mut self, quad: QuadNode) {
        let _ = quad;
    }

    /// A child was pushed. `rank`: its place among the eight children in the
    /// occlusion order, 0 (nearest) to 7.
    fn pushed(&mut self, rank: u8) {
        let _ = rank;
    }

    /// A record was made, and is where it belongs in the picture.
    fn made<L: CageCoordinate>(&mut self, record: &Record<L>) {
        let _ = record;
    }
}

impl Watch for () {}

impl<W: Watch> Watch for Option<W> {
    #[inline(always)]
    fn turn(&mut self, quad: QuadNode) {
        if let Some(watch) = self {
            watch.turn(quad);
        }
    }

    #[inline(always)]
    fn pushed(&mut self, rank: u8) {
        if let Some(watch) = self {
            watch.pushed(rank);
        }
    }
}
