//! The first sample of a box that is not drawn yet.
//!
//! Unlike the fit this goes on where a box lies across a bisector.

use hwmodel::{Datapath, Memory, Probe, Stage};

use super::constants::Constants;
use super::fit::{self, Fill};
use super::lattice::Lattice;
use super::record::{Clip, Spans};
use crate::frame::QuadNode;
use crate::frame::quadtree::FULL;

/// A voxel's box in the image, relative to a quadtree node.
pub(super) trait ImageBox: Copy {
    /// What the test of a node leaves for its quadrants.
    type Tested: Copy;

    /// The quadrants of `quad` that the box overlaps.
    fn quadrants<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        constants: &Constants,
        quad: QuadNode,
    ) -> (u8, Self::Tested);

    /// The box relative to a quadrant of a node.
    fn in_quadrant<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        quadrant: u8,
        tested: Self::Tested,
    ) -> Self;
}

/// The first sample of `quad` that a box overlaps and that is not drawn yet:
/// [`first`] without a call, for boxes that are small.
#[inline(always)]
pub(super) fn first_in_place<P: Probe, B: ImageBox>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    fill: &Fill<'_>,
    mut quad: QuadNode,
    mut of: B,
) -> Option<QuadNode> {
    dp.stage(Stage::QuadtreeFit);
    loop {
        let address = quad.address();
        dp.read(Memory::FillVector, address as u64);
        let open = !fill.vectors[address] & FULL;
        if quad.level == constants.levels {
            return (open != 0).then_some(quad);
        }
        let (overlapped, tested) = of.quadrants(dp, constants, quad);
        let mut candidates = dp.and_bits(4, overlapped, open);
        if candidates == 0 {
            return None;
        }
        while !candidates.is_power_of_two() {
            let quadrant = candidates.trailing_zeros() as u8;
            candidates &= candidates - 1;
            let inner = of.in_quadrant(dp, quadrant, tested);
            let found = first(dp, constants, fill, quad.quadrant(quadrant), inner);
            if found.is_some() {
                return found;
            }
        }
        // The last one, most often the only one, takes this node's place.
        let quadrant = candidates.trailing_zeros() as u8;
        of = of.in_quadrant(dp, quadrant, tested);
        quad = quad.quadrant(quadrant);
    }
}

/// The first sample of `quad` that a box overlaps and that is not drawn yet.
pub(super) fn first<P: Probe, B: ImageBox>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    fill: &Fill<'_>,
    quad: QuadNode,
    of: B,
) -> Option<QuadNode> {
    first_in_place(dp, constants, fill, quad, of)
}

impl<L: Lattice> ImageBox for Clip<L> {
    type Tested = [L; 2];

    fn quadrants<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        constants: &Constants,
        quad: QuadNode,
    ) -> (u8, [L; 2]) {
        fit::clip_quadrants(dp, constants, quad, self)
    }

    fn in_quadrant<P: Probe>(&self, dp: &mut Datapath<P>, quadrant: u8, far: [L; 2]) -> Self {
        fit::clip_in_quadrant(dp, self, quadrant, far)
    }
}

/// Positions in the picture, which are the same in every node.
impl ImageBox for Spans {
    type Tested = ();

    #[inline]
    fn quadrants<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        constants: &Constants,
        quad: QuadNode,
    ) -> (u8, ()) {
        (fit::screen_quadrants(dp, constants, quad, self), ())
    }

    #[inline]
    fn in_quadrant<P: Probe>(&self, _: &mut Datapath<P>, _: u8, (): ()) -> Self {
        *self
    }
}
