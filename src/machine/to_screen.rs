//! The change from clip space to screen space: the one place where the
//! machine divides, bit by bit, with subtractions and shifts.

use hwmodel::{Datapath, Probe, Short, Stage, Word};

use super::constants::Constants;
use super::fit::Place;
use super::lattice::Lattice;
use super::record::{Clip, Screen};
use super::taps::{Block, LEVEL_BITS, PLACES_BITS};
use crate::project::setup::SCREEN_GUARD_SHIFT;

/// Integer bits of a quotient: positions from -4 to 12 node widths.
const INTEGER_BITS: u32 = 4;
/// What is added to a numerator to make it positive: `w << this`.
const OFFSET_SHIFT: u32 = 2;

/// Whether a record may change at its level.
pub(super) fn may_change<P: Probe, L: Lattice>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    level: u32,
    place: &Place,
    pose: &Clip<L>,
) -> bool {
    let Some(&Some(least)) = constants.screen_depth.get(level as usize) else {
        return false;
    };
    dp.stage(Stage::ToScreen);
    let deep = !dp.lt(pose.w_min, least);
    dp.tap(Block::ChangeDepth, &(pose.w_min, least), &deep);
    deep && (place.inside || within_guard(dp, constants, place, pose))
}

/// The vertices in screen space, of a record that may change.
pub(super) fn change<P: Probe, L: Lattice>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    place: &Place,
    pose: &Clip<L>,
) -> Screen<L> {
    let bits = constants.levels - place.quad.level + constants.screen_frac;
    let mut along = |x: &L, column: u32| {
        // The node's left edge, less the numerators' offset.
        let edge = (i64::from(column) - (1 << OFFSET_SHIFT)) << bits;
        let edge = dp.load(edge);
        let to = L::project(dp, x, &pose.w, |dp, x, w| divide(dp, x, w, bits));
        let to = to.moved(dp, edge);
        let span = to.span(dp);
        (to, span)
    };
    let (x, x_span) = along(&pose.x, place.quad.x);
    let (y, y_span) = along(&pose.y, place.quad.y);
    Screen {
        x,
        y,
        spans: [x_span, y_span],
    }
}

/// Whether the box leaves the picture by no more than the tolerance's bound
/// allows for: an eighth of it; with an infinite tolerance, four times.
fn within_guard<P: Probe, L: Lattice>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    place: &Place,
    pose: &Clip<L>,
) -> bool {
    let level = place.quad.level as i32;
    let places = if constants.finite_tolerance {
        SCREEN_GUARD_SHIFT as i32 - level
    } else {
        -(OFFSET_SHIFT as i32) - level
    };
    if level > 0 && places <= 0 {
        // The fit has seen to it that no box leaves a node by more than its width.
        return true;
    }
    [&pose.x, &pose.y].into_iter().all(|x| {
        // Numerators and guard times 2^places, so that nothing is rounded and
        // the answer is the same whatever the node.
        let from_left = x.zip(&pose.w, |x, w| beyond(dp, x, w, places));
        let (low, _) = from_left.span(dp);
        let to_right = x.zip(&pose.w, |x, w| {
            let left_over = dp.sub(w, x);
            beyond(dp, left_over, w, places)
        });
        let (high, _) = to_right.span(dp);
        let near = !dp.is_negative(low) && !dp.is_negative(high);
        let places = Short::signed(places, PLACES_BITS);
        dp.tap(Block::ChangeGuard, &(x, &pose.w, places), &near);
        near
    })
}

/// The sign of `x + w / 2^places`: a multiple of it, exact.
fn beyond<P: Probe>(dp: &mut Datapath<P>, x: Word, w: Word, places: i32) -> Word {
    let (x, w) = if places >= 0 {
        (dp.shl(x, places as u32), w)
    } else {
        (x, dp.shl(w, places.unsigned_abs()))
    };
    dp.add(x, w)
}

/// `floor((x / w + 4) * 2^fraction_bits)` by a restoring divide.
///
/// `w > 0` and `-4w <= x < 12w`. One step for each integer and fraction bit.
fn divide<P: Probe>(dp: &mut Datapath<P>, x: Word, w: Word, fraction_bits: u32) -> Word {
    let offset = dp.shl(w, OFFSET_SHIFT);
    let mut remainder = dp.add(x, offset);
    let mut quotient = Word::ZERO;
    for place in (0..INTEGER_BITS).rev() {
        let (rest, bit) = dp.divide_integer_step(remainder, w, place);
        remainder = rest;
        quotient = dp.shift_in(quotient, bit);
    }
    for _ in 0..fraction_bits {
        let (rest, bit) = dp.divide_step(remainder, w, false);
        remainder = rest;
        quotient = dp.shift_in(quotient, bit);
    }
    let places = Short::unsigned(fraction_bits, LEVEL_BITS);
    dp.tap(Block::ToScreenDivide, &(x, w, places), &quotient);
    quotient
}
