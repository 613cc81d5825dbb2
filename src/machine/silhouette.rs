//! Drawing a solid at once: its silhouette is carried down the image
//! quadtree, whole quadrants are accepted or refused, samples decided by
//! their centres.

use hwmodel::{Datapath, Probe, Short};

/// What is known of a quadtree node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cover {
    /// No sample of the node is covered.
    None,
    /// Some may be.
    Some,
    /// All are.
    All,
}

impl Cover {
    /// On two wires: 0 outside, 1 mixed, 2 covered.
    #[inline]
    pub(super) fn wires(self) -> Short {
        Short::unsigned(self as u8, 2)
    }
}

/// A silhouette relative to a quadtree node.
pub(super) trait Silhouette: Clone {
    /// What the node, `below` levels above the samples, has of the
    /// silhouette; never [`Cover::Some`] for a sample (`below` = 0).
    fn cover<P: Probe>(&mut self, dp: &mut Datapath<P>, below: u32) -> Cover;

    /// The silhouette relative to a quadrant (`y << 1 | x`) of a node that is
    /// `below` levels above the samples.
    fn quadrant<P: Probe>(&self, dp: &mut Datapath<P>, quadrant: u8, below: u32) -> Self;
}
