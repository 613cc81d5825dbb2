//! The smallest unfilled quadtree node that holds a voxel's box (paper, 3.5).
//!
//! From the parent's node on, the box is tested against the two bisectors;
//! if all quadrants that it overlaps are full, it is rejected; if it overlaps
//! exactly one, that quadrant is next; else the node is found. Where a record
//! ends does not depend on what is drawn, only whether it is rejected does.

use hwmodel::{Datapath, Memory, Probe, Short, Stage, WideWord, Word};

use super::constants::{Constants, Margin};
use super::lattice::Lattice;
use super::record::{Clip, Planes, Spans};
use super::taps::{Block, LEVEL_BITS, NODE_BITS, PLACES_BITS};
use crate::frame::QuadNode;
use crate::frame::quadtree::FULL;

/// Which halves a box overlaps along one axis.
#[derive(Clone, Copy)]
struct Halves {
    low: bool,
    high: bool,
}

/// The four quadrants (`y << 1 | x`) that halves along x and y leave. Four
/// gates on the comparators' outputs, a part of the 4-bit and that follows.
#[inline(always)]
fn quadrants<P: Probe>(dp: &mut Datapath<P>, x: Halves, y: Halves) -> u8 {
    // By low and high along x (bits 0 and 1) and along y (bits 2 and 3).
    const QUADRANTS: [u8; 16] = {
        let mut of = [0; 16];
        let mut halves = 0;
        while halves < 16 {
            let across = [0, 0b0101, 0b1010, FULL][halves & 3];
            let down = [0, 0b0011, 0b1100, FULL][halves >> 2];
            of[halves] = across & down;
            halves += 1;
        }
        of
    };
    let bits = [x.low, x.high, y.low, y.high].map(usize::from);
    let both = QUADRANTS[bits[0] | bits[1] << 1 | bits[2] << 2 | bits[3] << 3];
    dp.tap(
        Block::Quadrants,
        &(x.low, x.high, y.low, y.high),
        &Short::unsigned(both, 4),
    );
    both
}

/// The fill vectors as the fit sees them.
pub(super) struct Fill<'f> {
    /// By address.
    pub(super) vectors: &'f [u8],
    /// Whether full quadrants reject.
    pub(super) reject: bool,
}

impl Fill<'_> {
    /// Whether a box that overlaps `quadrants` of `quad` has nowhere to go.
    #[inline]
    fn rejects<P: Probe>(&self, dp: &mut Datapath<P>, quad: QuadNode, quadrants: u8) -> bool {
        if !self.reject {
            return quadrants == 0;
        }
        let address = quad.address();
        dp.read(Memory::FillVector, address as u64);
        let vector = self.vectors[address];
        let rejects = dp.and_bits(4, quadrants, !vector & FULL) == 0;
        let choice = only(quadrants);
        dp.tap(
            Block::NodeChoice,
            &(Short::unsigned(quadrants, 4), Short::unsigned(vector, 4)),
            &(
                rejects,
                choice.is_some(),
                Short::unsigned(choice.unwrap_or(0), 2),
            ),
        );
        rejects
    }
}

/// The only quadrant of a vector, if it has just one.
fn only(quadrants: u8) -> Option<u8> {
    quadrants
        .is_power_of_two()
        .then(|| quadrants.trailing_zeros() as u8)
}

/// `a >> places`, or to the left for negative `places`.
#[inline]
pub(super) fn shift<P: Probe>(dp: &mut Datapath<P>, a: Word, places: i32) -> Word {
    if places >= 0 {
        dp.shr(a, places as u32)
    } else {
        dp.shl(a, places.unsigned_abs())
    }
}

/// A margin: `a` shifted, not rounded down. For a vertex behind the eye `a` is
/// negative, and rounding down would narrow the box.
fn part_of<P: Probe>(dp: &mut Datapath<P>, a: Word, places: i32) -> Word {
    let part = shift(dp, a, places);
    if places > 0 {
        dp.add(part, Word::from_host(1))
    } else {
        part
    }
}

/// The margin of a whole cage.
fn widening<P: Probe, L: Lattice>(dp: &mut Datapath<P>, w: &L, places: i32) -> L {
    let margin = w.map(|w| part_of(dp, w, places));
    let places = Short::signed(places, PLACES_BITS);
    dp.tap(Block::MarginGrow, &(w, places), &margin);
    margin
}

/// A position in the image: quadtree node, and whether the box lies inside it.
pub(super) struct Place {
    pub(super) quad: QuadNode,
    pub(super) inside: bool,
}

/// Fits a clip-space voxel, and makes its coordinates and planes relative to
/// the node found. `None`: rejected.
pub(super) fn clip<P: Probe, L: Lattice>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    fill: &Fill<'_>,
    place: &Place,
    pose: &mut Clip<L>,
    planes: &mut Planes,
) -> Option<Place> {
    dp.stage(Stage::QuadtreeFit);
    let mut quad = place.quad;
    let inside = place.inside
        || match border(dp, constants, quad, pose) {
            Border::Outside => return None,
            Border::Across => false,
            Border::Inside => true,
        };
    loop {
        let (overlapped, far) = clip_quadrants(dp, constants, quad, pose);
        if fill.rejects(dp, quad, overlapped) {
            return None;
        }
        let Some(quadrant) = only(overlapped).filter(|_| quad.level < constants.levels) else {
            break;
        };
        let to = clip_in_quadrant(dp, pose, quadrant, far);
        let (right, lower) = (quadrant & 1 != 0, quadrant & 2 != 0);
        dp.tap(Block::HalfClip, &(&pose.x, &far[0], right), &to.x);
        dp.tap(Block::HalfClip, &(&pose.y, &far[1], lower), &to.y);
        let leaves_little = inside || near_node(dp, &to.x, &to.w) && near_node(dp, &to.y, &to.w);
        if !leaves_little {
            // Too far outside: coordinates would grow beyond the word.
            break;
        }
        *pose = to;
        if constants.coverage == crate::project::Coverage::Exact {
            rebase_planes(dp, constants, planes, quadrant);
        }
        quad = quad.quadrant(quadrant);
    }
    Some(Place { quad, inside })
}

/// Twice the coordinate less the width: its sign is the side of the
/// bisector, its values are the right half's coordinates.
fn bisect<P: Probe, L: Lattice>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    below: u32,
    x: &L,
    w: &L,
) -> (L, Halves) {
    let relative = x.zip(w, |x, w| {
        let doubled = dp.shl(x, 1);
        dp.sub(doubled, w)
    });
    let below = below as i32;
    let halves = match &constants.margin {
        Margin::Plain => {
            let (low, high) = relative.span(dp);
            let low = dp.is_negative(low);
            let high = dp.is_positive(high) || !low;
            let halves = Halves { low, high };
            let none = w.map(|_| Word::ZERO);
            tap_bisector(dp, (x, w, &none), (false, false), &relative, halves);
            halves
        }
        &Margin::Grow(grow) => {
            let margin = widening(dp, w, grow + below - 1);
            let halves = closed(dp, &relative, &margin);
            tap_bisector(dp, (x, w, &margin), (true, false), &relative, halves);
            halves
        }
        Margin::Gap if below > 0 => {
            // Narrowed: half a sample, taken with the other sign.
            let margin = w.map(|w| {
                let sample = dp.shr(w, below.unsigned_abs());
                dp.neg(sample)
            });
            let node = Short::unsigned(below.unsigned_abs(), LEVEL_BITS);
            dp.tap(Block::MarginGap, &(w, node), &margin);
            let halves = closed(dp, &relative, &margin);
            tap_bisector(dp, (x, w, &margin), (true, false), &relative, halves);
            halves
        }
        Margin::Gap => {
            // At a sample there is one sample point, in the middle.
            let halves = closed_plain(dp, &relative);
            let margin = w.map(|_| Word::ZERO);
            let both = halves.low && halves.high;
            let halves = Halves {
                low: both,
                high: both,
            };
            tap_bisector(dp, (x, w, &margin), (true, true), &relative, halves);
            halves
        }
    };
    (relative, halves)
}

/// Shows the test of a clip-space box against a bisector. `kind`: whether
/// the comparisons are closed, and whether both halves must hold the sample.
#[inline(always)]
fn tap_bisector<P: Probe, L: Lattice>(
    dp: &mut Datapath<P>,
    box_and_margin: (&L, &L, &L),
    kind: (bool, bool),
    relative: &L,
    halves: Halves,
) {
    dp.tap(
        Block::BisectorClip,
        &(box_and_margin, kind),
        &(relative, halves.low, halves.high),
    );
}

/// `a` times a factor, as shifted copies of `a`, each `extra` places further right.
pub(super) fn sum_of_shifts<P: Probe>(
    dp: &mut Datapath<P>,
    a: Word,
    shifts: &[i32],
    extra: i32,
) -> Word {
    let mut sum = Word::ZERO;
    for (i, &places) in shifts.iter().enumerate() {
        let part = shift(dp, a, places + extra);
        sum = if i == 0 { part } else { dp.add(sum, part) };
    }
    sum
}

/// Both sides of a line, boxes closed and widened by `margin`.
fn closed<P: Probe, L: Lattice>(dp: &mut Datapath<P>, relative: &L, margin: &L) -> Halves {
    let lowered = relative.zip(margin, |v, m| dp.sub(v, m));
    let raised = relative.zip(margin, |v, m| dp.add(v, m));
    let (low, _) = lowered.span(dp);
    let (_, high) = raised.span(dp);
    Halves {
        low: !dp.is_positive(low),
        high: !dp.is_negative(high),
    }
}

fn closed_plain<P: Probe, L: Lattice>(dp: &mut Datapath<P>, relative: &L) -> Halves {
    let (low, high) = relative.span(dp);
    Halves {
        low: !dp.is_positive(low),
        high: !dp.is_negative(high),
    }
}

/// The coordinates in the left half (doubled) or in the right half (as tested).
fn rebase<P: Probe, L: Lattice>(dp: &mut Datapath<P>, right: bool, x: &L, tested: L) -> L {
    if right {
        tested
    } else {
        x.map(|x| dp.shl(x, 1))
    }
}

/// Whether a box leaves a node by at most the node's width.
fn near_node<P: Probe, L: Lattice>(dp: &mut Datapath<P>, x: &L, w: &L) -> bool {
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

/// Planes relative to a quadrant: `c' = 2c + bx a + by b`.
fn rebase_planes<P: Probe>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    planes: &mut Planes,
    quadrant: u8,
) {
    for plane in &mut planes.edge {
        plane[2] = rebased(dp, [plane[0], plane[1]], plane[2], quadrant);
    }
    for (c, &ab) in planes.axis_c.iter_mut().zip(&constants.axis_ab) {
        *c = rebased(dp, ab, *c, quadrant);
    }
}

/// The constant of `a x + b y + c` in a quadrant's own coordinates, doubled.
#[inline]
pub(super) fn rebased<P: Probe>(
    dp: &mut Datapath<P>,
    [a, b]: [WideWord; 2],
    c: WideWord,
    quadrant: u8,
) -> WideWord {
    let mut to = dp.shl(c, 1);
    if quadrant & 1 != 0 {
        to = dp.add(to, a);
    }
    if quadrant & 2 != 0 {
        to = dp.add(to, b);
    }
    let quadrant = Short::unsigned(quadrant, 2);
    dp.tap(Block::PlaneQuadrant, &([a, b], c, quadrant), &to);
    to
}

/// How a box lies to the edges of a node that is cut by the picture's border.
enum Border {
    Inside,
    Across,
    Outside,
}

/// The box against the four edges of a node, which are the picture's where
/// the parent's box left it.
fn border<P: Probe, L: Lattice>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    quad: QuadNode,
    pose: &Clip<L>,
) -> Border {
    let below = (constants.levels - quad.level) as i32;
    let mut inside = true;
    for x in [&pose.x, &pose.y] {
        let from_left = *x;
        let from_right = x.zip(&pose.w, |x, w| dp.sub(x, w));
        let mut border_margin = pose.w.map(|_| Word::ZERO);
        let (left, right) = match constants.grow {
            None => (from_left.span(dp), from_right.span(dp)),
            Some(grow) => {
                let margin = widening(dp, &pose.w, grow + below);
                border_margin = margin;
                let outward = |dp: &mut Datapath<P>, v: &L| {
                    let raised = v.zip(&margin, |v, m| dp.add(v, m));
                    let lowered = v.zip(&margin, |v, m| dp.sub(v, m));
                    let (_, high) = raised.span(dp);
                    let (low, _) = lowered.span(dp);
                    (low, high)
                };
                (outward(dp, &from_left), outward(dp, &from_right))
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
            &(x, &pose.w, &border_margin, is_wider),
            &(outside, within),
        );
        if outside {
            return Border::Outside;
        }
        inside &= within;
    }
    if inside {
        Border::Inside
    } else {
        Border::Across
    }
}

/// The quadrants of its node that a clip-space box overlaps, and the
/// coordinates in the far halves.
pub(super) fn clip_quadrants<P: Probe, L: Lattice>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    quad: QuadNode,
    pose: &Clip<L>,
) -> (u8, [L; 2]) {
    let below = constants.levels - quad.level;
    let (far_x, x) = bisect(dp, constants, below, &pose.x, &pose.w);
    let (far_y, y) = bisect(dp, constants, below, &pose.y, &pose.w);
    (quadrants(dp, x, y), [far_x, far_y])
}

/// A clip-space voxel relative to a quadrant of its node.
pub(super) fn clip_in_quadrant<P: Probe, L: Lattice>(
    dp: &mut Datapath<P>,
    pose: &Clip<L>,
    quadrant: u8,
    [far_x, far_y]: [L; 2],
) -> Clip<L> {
    Clip {
        x: rebase(dp, quadrant & 1 != 0, &pose.x, far_x),
        y: rebase(dp, quadrant & 2 != 0, &pose.y, far_y),
        ..*pose
    }
}

/// The quadrants of a node that a screen-space box overlaps.
#[inline(always)]
pub(super) fn screen_quadrants<P: Probe>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    quad: QuadNode,
    spans: &Spans,
) -> u8 {
    let below = constants.levels - quad.level;
    let x = screen_halves(dp, constants, below, quad.x, spans[0]);
    let y = screen_halves(dp, constants, below, quad.y, spans[1]);
    quadrants(dp, x, y)
}

/// Fits a screen-space voxel. `None`: rejected.
#[inline(always)]
pub(super) fn screen<P: Probe>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    fill: &Fill<'_>,
    place: &Place,
    spans: &Spans,
) -> Option<Place> {
    dp.stage(Stage::QuadtreeFit);
    let mut quad = place.quad;
    let inside = place.inside
        || match screen_border(dp, constants, quad, spans) {
            Border::Outside => return None,
            Border::Across => false,
            Border::Inside => true,
        };
    loop {
        let overlapped = screen_quadrants(dp, constants, quad, spans);
        if fill.rejects(dp, quad, overlapped) {
            return None;
        }
        let Some(quadrant) = only(overlapped).filter(|_| quad.level < constants.levels) else {
            break;
        };
        quad = quad.quadrant(quadrant);
    }
    Some(Place { quad, inside })
}

/// A position on the picture in half samples, as a screen-space word: wires.
fn at_half_samples(constants: &Constants, half_samples: i64) -> Word {
    let [left, right] = constants.half_sample_places;
    Word::from_host(half_samples << left >> right)
}

#[inline(always)]
fn screen_halves<P: Probe>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    below: u32,
    column: u32,
    (low, high): (Word, Word),
) -> Halves {
    let [left, right] = constants.half_sample_places;
    // As in `at_half_samples`.
    let middle = Word::from_host(i64::from(column << 1 | 1) << (below + left) >> right);
    // Half-open boxes; margins are in the positions.
    let in_low = dp.lt(low, middle);
    let halves = Halves {
        low: in_low,
        high: dp.lt(middle, high) || !in_low,
    };
    let node = (
        Short::unsigned(column, NODE_BITS),
        Short::unsigned(below, LEVEL_BITS),
    );
    dp.tap(
        Block::BisectorScreen,
        &(low, high, node),
        &(halves.low, halves.high),
    );
    halves
}

fn screen_border<P: Probe>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    quad: QuadNode,
    &[x, y]: &Spans,
) -> Border {
    let below = constants.levels - quad.level;
    let mut inside = true;
    for (column, (low, high)) in [(quad.x, x), (quad.y, y)] {
        let left = at_half_samples(constants, i64::from(column) << (below + 1));
        let right = at_half_samples(constants, i64::from(column + 1) << (below + 1));
        let outside = dp.lt(high, left) || dp.lt(right, low);
        let within = !outside && dp.le(left, low) && dp.le(high, right);
        let node = (
            Short::unsigned(column, NODE_BITS),
            Short::unsigned(below, LEVEL_BITS),
        );
        dp.tap(Block::BorderScreen, &(low, high, node), &(outside, within));
        if outside {
            return Border::Outside;
        }
        inside &= within;
    }
    if inside {
        Border::Inside
    } else {
        Border::Across
    }
}
