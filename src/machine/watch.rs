//! Events of whole records, for a [`Watch`]. Operations, memory accesses and wires go to an [`hwmodel::Probe`] instead.

use super::cage::CageCoordinate;
use super::record::Record;
use crate::frame::QuadNode;

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
