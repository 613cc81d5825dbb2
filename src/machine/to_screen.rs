//! The change from clip to screen space (`SPEC.md`, R5): the only place where the machine divides.

use crate::machine::stages::RecordStage;
use hwmodel::{Datapath, OpClass, Probe, Short, Word};

use super::blocks::{Block, LEVEL_BITS, NODE_BITS, PLACES_BITS};
use super::cage::CageCoordinate;
use super::constants::Constants;
use super::levels;
use super::record::{Clip, ImagePlace, Screen};
use crate::project::options::SCREEN_GUARD_SHIFT;

/// Integer bits of a quotient: positions from -4 to 12 node widths.
const INTEGER_BITS: u32 = 4;
/// `w << OFFSET_SHIFT` is added to a numerator to make it positive.
const OFFSET_SHIFT: u32 = 2;

/// Whether a record may change: it is far enough away, and not too far beyond the picture's edges.
pub(super) fn may_change<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    level: u32,
    place: ImagePlace,
    clip: &Clip<L>,
) -> bool {
    let Some(least) = constants.screen_depth[level as usize] else {
        return false;
    };
    dp.stage(RecordStage::ToScreen);
    let deep = !dp.lt(clip.w_min, least);
    dp.tap(Block::ChangeDepth, &(clip.w_min, least), &deep);
    deep && (place.inside || within_guard(dp, constants, place, clip))
}

pub(super) fn change<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    place: ImagePlace,
    clip: &Clip<L>,
) -> Screen<L> {
    let below = levels::above(dp, place.quad.level, constants.levels) as i32;
    let bits = levels::places(dp, constants.screen_frac as i32, below) as u32;
    let mut along = |x: &L, column: u32| {
        // The node's left edge, less the numerators' offset.
        dp.control(OpClass::Sub, NODE_BITS);
        dp.control(OpClass::Shift, NODE_BITS);
        let edge = (i64::from(column) - (1 << OFFSET_SHIFT)) << bits;
        let edge = dp.load(edge);
        let projected = L::project(dp, x, &clip.w, |dp, x, w| divide(dp, x, w, bits));
        let moved = projected.moved(dp, edge);
        let span = moved.span(dp);
        (moved, span)
    };
    let (x, x_span) = along(&clip.x, place.quad.x);
    let (y, y_span) = along(&clip.y, place.quad.y);
    Screen {
        x,
        y,
        spans: [x_span, y_span],
    }
}

/// Whether the box leaves the picture by at most an eighth of its side, or four sides with infinite tolerance.
fn within_guard<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    place: ImagePlace,
    clip: &Clip<L>,
) -> bool {
    let level = place.quad.level as i32;
    let guard = if constants.finite_tolerance {
        SCREEN_GUARD_SHIFT as i32
    } else {
        -(OFFSET_SHIFT as i32)
    };
    let places = levels::places(dp, guard, -level);
    if levels::reaches(dp, place.quad.level, 1) && places <= 0 {
        // Below the root the search lets no box leave its node by more than the node's width.
        return true;
    }
    [&clip.x, &clip.y].into_iter().all(|x| {
        // Position and guard times 2^places: exact, and the same for every node.
        let from_left = x.zip(&clip.w, |x, w| beyond(dp, x, w, places));
        let (low, _) = from_left.span(dp);
        let to_right = x.zip(&clip.w, |x, w| {
            let left_over = dp.sub(w, x);
            beyond(dp, left_over, w, places)
        });
        let (high, _) = to_right.span(dp);
        let near = !dp.is_negative(low) && !dp.is_negative(high);
        let places = Short::signed(places, PLACES_BITS);
        dp.tap(Block::ChangeGuard, &(x, &clip.w, places), &near);
        near
    })
}

/// A positive multiple of `x + w / 2^places`, exact.
fn beyond<P: Probe>(dp: &mut Datapath<P>, x: Word, w: Word, places: i32) -> Word {
    let (x, w) = if places >= 0 {
        (dp.shl(x, places as u32), w)
    } else {
        (x, dp.shl(w, places.unsigned_abs()))
    };
    dp.add(x, w)
}

/// `floor((x / w + 4) * 2^fraction_bits)`, for `w > 0` and `-4w <= x < 12w`, by a restoring divide.
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
