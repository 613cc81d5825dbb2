//! The quadrants of a quadtree node that a box overlaps (`SPEC.md`, R6; image-order paper, 3.5). In clip space `x` runs
//! from 0 to `w` across the node, and the sign of `2x - w` is the side of the bisector.

use hwmodel::{Datapath, Probe, Short, Word};

use super::blocks::{Block, LEVEL_BITS, PLACES_BITS, node_wires};
use super::cage::CageCoordinate;
use super::constants::{Constants, Margin};
use super::levels;
use super::record::{Clip, Spans};
use super::shifts::margin;
use crate::frame::QuadNode;
use crate::frame::quadtree::FULL;

#[derive(Clone, Copy)]
pub(super) struct Halves {
    pub(super) low: bool,
    pub(super) high: bool,
}

/// The quadrants (bit `y << 1 | x`) in the given halves: four gates, counted with the 4-bit "and" that follows.
#[inline(always)]
pub(super) fn quadrants<P: Probe>(dp: &mut Datapath<P>, x: Halves, y: Halves) -> u8 {
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

pub(super) fn only(quadrants: u8) -> Option<u8> {
    quadrants
        .is_power_of_two()
        .then(|| quadrants.trailing_zeros() as u8)
}

pub(super) trait ImageBox: Copy {
    type Tested: Copy;

    /// The quadrants of a node that the box overlaps.
    fn quadrants<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        constants: &Constants,
        quad: QuadNode,
    ) -> (u8, Self::Tested);

    fn in_quadrant<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        quadrant: u8,
        tested: Self::Tested,
    ) -> Self;

    /// Up by some levels, then into another quadrant.
    fn climb<P: Probe>(dp: &mut Datapath<P>, levels: u32);
}

impl<L: CageCoordinate> ImageBox for Clip<L> {
    /// X and y relative to the far halves.
    type Tested = [L; 2];

    fn quadrants<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        constants: &Constants,
        quad: QuadNode,
    ) -> (u8, [L; 2]) {
        let below = levels::above(dp, quad.level, constants.levels);
        let (far_x, x) = bisect(dp, constants, below, &self.x, &self.w);
        let (far_y, y) = bisect(dp, constants, below, &self.y, &self.w);
        (quadrants(dp, x, y), [far_x, far_y])
    }

    /// Doubled in a near half.
    fn in_quadrant<P: Probe>(&self, dp: &mut Datapath<P>, quadrant: u8, far: [L; 2]) -> Self {
        let mut half = |is_far: bool, near: &L, far: L| match is_far {
            true => far,
            false => near.map(|x| dp.shl(x, 1)),
        };
        Self {
            x: half(quadrant & 1 != 0, &self.x, far[0]),
            y: half(quadrant & 2 != 0, &self.y, far[1]),
            ..*self
        }
    }

    /// Kept, where hardware moves a box back one level at a time.
    fn climb<P: Probe>(dp: &mut Datapath<P>, levels: u32) {
        dp.next_step(levels + 1);
    }
}

/// Screen positions are relative to the picture, equal for all nodes.
impl ImageBox for Spans {
    type Tested = ();

    #[inline(always)]
    fn quadrants<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        constants: &Constants,
        quad: QuadNode,
    ) -> (u8, ()) {
        let below = levels::above(dp, quad.level, constants.levels);
        let x = screen_halves(dp, constants, below, quad.x, self[0]);
        let y = screen_halves(dp, constants, below, quad.y, self[1]);
        (quadrants(dp, x, y), ())
    }

    #[inline]
    fn in_quadrant<P: Probe>(&self, _: &mut Datapath<P>, _: u8, (): ()) -> Self {
        *self
    }

    #[inline]
    fn climb<P: Probe>(_: &mut Datapath<P>, _: u32) {}
}

/// `2x - w`, and the overlapped halves of the node, `below` levels above the samples.
fn bisect<P: Probe, L: CageCoordinate>(
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
    let mut margin = w.map(|_| Word::ZERO);
    // Whether the comparisons are closed, and whether both halves must contain the sample.
    let (halves, kind) = match &constants.margin {
        Margin::Plain => {
            let (low, high) = relative.span(dp);
            let low = dp.is_negative(low);
            let high = dp.is_positive(high) || !low;
            (Halves { low, high }, (false, false))
        }
        &Margin::Grow(grow) => {
            let places = levels::places(dp, grow, below as i32 - 1);
            margin = margins(dp, w, places);
            (closed(dp, &relative, &margin), (true, false))
        }
        Margin::Gap if below > 0 => {
            // Half a sample, negative: the box is narrowed.
            margin = w.map(|w| {
                let sample = dp.shr(w, below);
                dp.neg(sample)
            });
            let node = Short::unsigned(below, LEVEL_BITS);
            dp.tap(Block::MarginGap, &(w, node), &margin);
            (closed(dp, &relative, &margin), (true, false))
        }
        Margin::Gap => {
            // A sample has one sample point, in its middle.
            let span = relative.span(dp);
            let halves = closed_halves(dp, span);
            let both = halves.low && halves.high;
            let halves = Halves {
                low: both,
                high: both,
            };
            (halves, (true, true))
        }
    };
    dp.tap(
        Block::BisectorClip,
        &((x, w, &margin), kind),
        &(&relative, halves.low, halves.high),
    );
    (relative, halves)
}

pub(super) fn margins<P: Probe, L: CageCoordinate>(dp: &mut Datapath<P>, w: &L, places: i32) -> L {
    let margins = w.map(|w| margin(dp, w, places));
    let places = Short::signed(places, PLACES_BITS);
    dp.tap(Block::MarginGrow, &(w, places), &margins);
    margins
}

fn closed<P: Probe, L: CageCoordinate>(dp: &mut Datapath<P>, relative: &L, margin: &L) -> Halves {
    let lowered = relative.zip(margin, |v, m| dp.sub(v, m));
    let raised = relative.zip(margin, |v, m| dp.add(v, m));
    let (low, _) = lowered.span(dp);
    let (_, high) = raised.span(dp);
    closed_halves(dp, (low, high))
}

/// The bisector is 0.
fn closed_halves<P: Probe>(dp: &mut Datapath<P>, (low, high): (Word, Word)) -> Halves {
    Halves {
        low: !dp.is_positive(low),
        high: !dp.is_negative(high),
    }
}

/// Half-open: the positions include the margin.
#[inline(always)]
fn screen_halves<P: Probe>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    below: u32,
    column: u32,
    (low, high): (Word, Word),
) -> Halves {
    let [left, right] = constants.half_sample_places;
    // The node's middle is at `2 column + 1` halves of its width.
    let middle = Word::from_host(i64::from(column << 1 | 1) << (below + left) >> right);
    let in_low = dp.lt(low, middle);
    let halves = Halves {
        low: in_low,
        high: dp.lt(middle, high) || !in_low,
    };
    dp.tap(
        Block::BisectorScreen,
        &(low, high, node_wires(column, below)),
        &(halves.low, halves.high),
    );
    halves
}
