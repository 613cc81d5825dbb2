//! The smallest unfilled quadtree node that holds a box (`SPEC.md`, R6; image-order paper, 3.5). Only the rejection
//! depends on drawn samples.
//!
//! ```text
//! from the parent's node on:
//!     find the quadrants that the box overlaps
//!     if all of them are full: reject the box
//!     if there is exactly one: continue with that quadrant
//!     else: this is the node
//! ```

use crate::machine::stages::RecordStage;
use hwmodel::{Datapath, OpClass, Probe, Word};

use super::blocks::{Block, NODE_BITS, node_wires};
use super::cage::CageCoordinate;
use super::constants::Constants;
use super::fill::FillStore;
use super::levels;
use super::planes;
use super::quadrants::{ImageBox, margins, only};
use super::record::{Clip, ImagePlace, Planes, Spans};
use crate::frame::QuadNode;

/// Finds the node, and makes cage and planes relative to it. `None`: rejected.
pub(super) fn clip<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    fill: &FillStore<'_>,
    place: ImagePlace,
    clip: &mut Clip<L>,
    planes: &mut Planes,
) -> Option<ImagePlace> {
    dp.stage(RecordStage::QuadtreeFit);
    let mut quad = place.quad;
    let inside = place.inside || is_inside(dp, constants, quad, clip)?;
    loop {
        let (overlapped, far) = clip.quadrants(dp, constants, quad);
        if fill.rejects(dp, quad, overlapped) {
            return None;
        }
        let is_sample = levels::reaches(dp, quad.level, constants.levels);
        let Some(quadrant) = only(overlapped).filter(|_| !is_sample) else {
            break;
        };
        let to = clip.in_quadrant(dp, quadrant, far);
        let (right, lower) = (quadrant & 1 != 0, quadrant & 2 != 0);
        dp.tap(Block::HalfClip, &(&clip.x, &far[0], right), &to.x);
        dp.tap(Block::HalfClip, &(&clip.y, &far[1], lower), &to.y);
        let is_near = inside || near_node(dp, &to.x, &to.w) && near_node(dp, &to.y, &to.w);
        if !is_near {
            // Its coordinates there would outgrow the word.
            break;
        }
        *clip = to;
        if constants.outline.has_planes() {
            planes::move_to_quadrant(dp, constants, planes, quadrant);
        }
        levels::next(dp, quad.level);
        quad = quad.quadrant(quadrant);
    }
    Some(ImagePlace { quad, inside })
}

#[inline(always)]
pub(super) fn screen<P: Probe>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    fill: &FillStore<'_>,
    place: ImagePlace,
    spans: &Spans,
) -> Option<ImagePlace> {
    dp.stage(RecordStage::QuadtreeFit);
    let mut quad = place.quad;
    let inside = place.inside || is_screen_inside(dp, constants, quad, spans)?;
    loop {
        let (overlapped, ()) = spans.quadrants(dp, constants, quad);
        if fill.rejects(dp, quad, overlapped) {
            return None;
        }
        let is_sample = levels::reaches(dp, quad.level, constants.levels);
        let Some(quadrant) = only(overlapped).filter(|_| !is_sample) else {
            break;
        };
        levels::next(dp, quad.level);
        quad = quad.quadrant(quadrant);
    }
    Some(ImagePlace { quad, inside })
}

/// Whether a clip-space box leaves a node by at most the node's width.
pub(super) fn near_node<P: Probe, L: CageCoordinate>(dp: &mut Datapath<P>, x: &L, w: &L) -> bool {
    let from_left = x.zip(w, |x, w| dp.add(x, w));
    let (low, _) = from_left.span(dp);
    let to_right = x.zip(w, |x, w| {
        let double = dp.shl(w, 1);
        dp.sub(x, double)
    });
    let (_, high) = to_right.span(dp);
    let near = !dp.is_negative(low) && !dp.is_positive(high);
    dp.tap(Block::NearNode, &(x, w), &near);
    near
}

/// Whether a box, widened by [`Constants::grow`], lies inside a node. `None`: outside. The node's edges are the
/// picture's wherever the parent's box left the picture.
fn is_inside<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    quad: QuadNode,
    clip: &Clip<L>,
) -> Option<bool> {
    let below = levels::above(dp, quad.level, constants.levels) as i32;
    let mut inside = true;
    for x in [&clip.x, &clip.y] {
        let from_left = *x;
        let from_right = x.zip(&clip.w, |x, w| dp.sub(x, w));
        let mut margin = clip.w.map(|_| Word::ZERO);
        let (left, right) = match constants.grow {
            None => (from_left.span(dp), from_right.span(dp)),
            Some(grow) => {
                let places = levels::places(dp, grow, below);
                margin = margins(dp, &clip.w, places);
                let widened = |dp: &mut Datapath<P>, v: &L| {
                    let raised = v.zip(&margin, |v, m| dp.add(v, m));
                    let lowered = v.zip(&margin, |v, m| dp.sub(v, m));
                    let (_, high) = raised.span(dp);
                    let (low, _) = lowered.span(dp);
                    (low, high)
                };
                (widened(dp, &from_left), widened(dp, &from_right))
            }
        };
        let is_wider = constants.grow.is_some();
        let outside = dp.is_negative(left.1) || dp.is_positive(right.0);
        let within = !outside
            && if is_wider {
                dp.is_positive(left.0) && dp.is_negative(right.1)
            } else {
                !dp.is_negative(left.0) && !dp.is_positive(right.1)
            };
        dp.tap(
            Block::BorderClip,
            &(x, &clip.w, &margin, is_wider),
            &(outside, within),
        );
        if outside {
            return None;
        }
        inside &= within;
    }
    Some(inside)
}

fn is_screen_inside<P: Probe>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    quad: QuadNode,
    &[x, y]: &Spans,
) -> Option<bool> {
    let below = levels::above(dp, quad.level, constants.levels);
    // A multiple of the node's width, as a screen position.
    let edge = |column: u32| {
        let [left, right] = constants.half_sample_places;
        Word::from_host(i64::from(column) << (below + 1) << left >> right)
    };
    let mut inside = true;
    for (column, (low, high)) in [(quad.x, x), (quad.y, y)] {
        let (left, right) = (edge(column), edge(column + 1));
        // The next column, and a shift for each edge.
        dp.control(OpClass::Add, NODE_BITS);
        dp.control(OpClass::Shift, NODE_BITS);
        dp.control(OpClass::Shift, NODE_BITS);
        let outside = dp.lt(high, left) || dp.lt(right, low);
        let within = !outside && dp.le(left, low) && dp.le(high, right);
        let node = node_wires(column, below);
        dp.tap(Block::BorderScreen, &(low, high, node), &(outside, within));
        if outside {
            return None;
        }
        inside &= within;
    }
    Some(inside)
}
