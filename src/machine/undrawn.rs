//! The first undrawn sample of a box, for records across a bisector (`SPEC.md`, R6) and for `any`.

use crate::machine::stages::RecordStage;
use hwmodel::{Datapath, Probe};

use super::cage::CageCoordinate;
use super::constants::Constants;
use super::fill::FillStore;
use super::levels;
use super::quadrants::ImageBox;
use super::record::{Pose, Record};
use crate::frame::QuadNode;
use crate::frame::quadtree::FULL;

#[inline]
pub(super) fn first_undrawn<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    fill: &FillStore<'_>,
    record: &Record<L>,
) -> Option<QuadNode> {
    let quad = record.place.quad;
    let found = match &record.pose {
        Pose::Clip(clip, _) => first(dp, constants, fill, quad, *clip),
        Pose::Screen(screen) => first_inlined(dp, constants, fill, quad, screen.spans),
    };
    found.ok()
}

/// As [`first`], inlined into the caller: faster for small boxes.
#[inline(always)]
fn first_inlined<P: Probe, B: ImageBox>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    fill: &FillStore<'_>,
    mut quad: QuadNode,
    mut of: B,
) -> Result<QuadNode, u32> {
    dp.stage(RecordStage::QuadtreeFit);
    loop {
        let open = !fill.read(dp, quad) & FULL;
        if levels::reaches(dp, quad.level, constants.levels) {
            return if open != 0 { Ok(quad) } else { Err(quad.level) };
        }
        let (overlapped, tested) = of.quadrants(dp, constants, quad);
        let mut candidates = dp.and_bits(4, overlapped, open);
        if candidates == 0 {
            return Err(quad.level);
        }
        while !candidates.is_power_of_two() {
            let quadrant = candidates.trailing_zeros() as u8;
            candidates &= candidates - 1;
            let inner = of.in_quadrant(dp, quadrant, tested);
            levels::next(dp, quad.level);
            match first(dp, constants, fill, quad.quadrant(quadrant), inner) {
                Ok(sample) => return Ok(sample),
                Err(deepest) => B::climb(dp, deepest - quad.level),
            }
        }
        // The last one, usually the only one, replaces this node.
        let quadrant = candidates.trailing_zeros() as u8;
        of = of.in_quadrant(dp, quadrant, tested);
        levels::next(dp, quad.level);
        quad = quad.quadrant(quadrant);
    }
}

/// The first undrawn sample of `quad` that a box overlaps; otherwise the level of the last examined node.
fn first<P: Probe, B: ImageBox>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    fill: &FillStore<'_>,
    quad: QuadNode,
    of: B,
) -> Result<QuadNode, u32> {
    first_inlined(dp, constants, fill, quad, of)
}
