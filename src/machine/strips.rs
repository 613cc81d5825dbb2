//! Silhouettes in screen space: where a voxel is a parallelepiped, its
//! outline is the intersection of three strips, one along each edge
//! direction (`SPEC.md`, "Strips").
//!
//! The products that a strip needs are made by shifts and adds over the ten
//! bits of its normal. Normals are rounded, so strips are taken wide enough
//! to hold all eight vertices, and the box cuts off what that adds.

use hwmodel::{Datapath, Probe, WideWord, Word};

use super::constants::Constants;
use super::lattice::Lattice;
use super::record::Screen;
use super::silhouette::{Cover, Silhouette};
use crate::frame::QuadNode;

/// Bits of a strip's normal, without sign.
const NORMAL_BITS: u32 = 10;

/// `low <= gx x + gy y + c <= high`, in half units of the last place.
#[derive(Debug, Clone, Copy)]
struct Strip {
    gx: Word,
    gy: Word,
    /// `|gx| + |gy|`.
    slope: WideWord,
    /// The function's value in the middle of the node.
    value: WideWord,
    low: WideWord,
    high: WideWord,
    /// Whether all samples of the node are inside.
    settled: bool,
}

/// The silhouette of a screen-space voxel: three strips, and its box.
#[derive(Debug, Clone)]
pub(super) struct StripSilhouette {
    strips: [Strip; 5],
    /// Fraction bits of screen positions.
    frac: u32,
}

/// `small * a` by shifts and adds; `|small| < 2^NORMAL_BITS`.
fn times<P: Probe>(dp: &mut Datapath<P>, small: Word, a: Word) -> WideWord {
    let negative = dp.is_negative(small);
    let negated = dp.neg(small);
    let magnitude = dp.select(negative, negated, small);
    let a = dp.widen(a);
    let mut sum = WideWord::ZERO;
    for place in 0..NORMAL_BITS {
        let part = dp.shl(a, place);
        let with = dp.add(sum, part);
        let bit = dp.bit(magnitude, place);
        sum = dp.select(bit, with, sum);
    }
    let negated = dp.neg(sum);
    dp.select(negative, negated, sum)
}

impl Strip {
    fn settle<P: Probe>(&mut self, dp: &mut Datapath<P>, below: u32, frac: u32) -> Cover {
        if self.settled {
            return Cover::All;
        }
        // Samples lie within (2^below - 1) half samples of the middle.
        let most = dp.shl(self.slope, below + frac);
        let half = dp.shl(self.slope, frac);
        let reach = dp.sub(most, half);
        let greatest = dp.add(self.value, reach);
        let least = dp.sub(self.value, reach);
        if dp.lt(greatest, self.low) || dp.lt(self.high, least) {
            return Cover::None;
        }
        self.settled = dp.le(self.low, least) && dp.le(greatest, self.high);
        if self.settled {
            Cover::All
        } else {
            Cover::Some
        }
    }

    fn quadrant<P: Probe>(&self, dp: &mut Datapath<P>, quadrant: u8, places: u32) -> Self {
        if self.settled {
            return *self;
        }
        let mut value = self.value;
        for (g, positive) in [(self.gx, quadrant & 1 != 0), (self.gy, quadrant & 2 != 0)] {
            let g = dp.widen(g);
            let step = dp.shl(g, places);
            value = if positive {
                dp.add(value, step)
            } else {
                dp.sub(value, step)
            };
        }
        Self { value, ..*self }
    }
}

impl StripSilhouette {
    pub(super) fn new<P: Probe, L: Lattice>(
        dp: &mut Datapath<P>,
        constants: &Constants,
        quad: QuadNode,
        pose: &Screen<L>,
    ) -> Self {
        let frac = constants.screen_frac;
        let below = constants.levels - quad.level;
        let edges_x = pose.x.edges(dp);
        let edges_y = pose.y.edges(dp);
        // The node's middle, in half units: whole half samples.
        let middle = |column: u32| Word::from_host(i64::from(2 * column + 1) << (below + frac));
        let corner_x = dp.shl(pose.x.corner(), 1);
        let corner_y = dp.shl(pose.y.corner(), 1);
        let (middle_x, middle_y) = (middle(quad.x), middle(quad.y));
        let from_corner_x = dp.sub(middle_x, corner_x);
        let from_corner_y = dp.sub(middle_y, corner_y);
        let strip = |dp: &mut Datapath<P>, j: usize| {
            let (normal_x, normal_y) = normal(dp, edges_x[j], edges_y[j]);
            let gx = dp.neg(normal_y);
            let gy = normal_x;
            let function = |dp: &mut Datapath<P>, x: Word, y: Word| {
                let along_x = times(dp, gx, x);
                let along_y = times(dp, gy, y);
                dp.add(along_x, along_y)
            };
            let mut low = WideWord::ZERO;
            let mut high = WideWord::ZERO;
            for k in 0..3 {
                let across = function(dp, edges_x[k], edges_y[k]);
                let across = dp.shl(across, 1);
                let below = dp.min(across, WideWord::ZERO);
                let above = dp.max(across, WideWord::ZERO);
                low = dp.add(low, below);
                high = dp.add(high, above);
            }
            let value = function(dp, from_corner_x, from_corner_y);
            let slope = slope(dp, gx, gy);
            Strip {
                gx,
                gy,
                slope,
                value,
                low,
                high,
                settled: false,
            }
        };
        let one = Word::from_host(1);
        let strips = [
            strip(dp, 0),
            strip(dp, 1),
            strip(dp, 2),
            side_strip(dp, [one, Word::ZERO], middle_x, pose.x_span),
            side_strip(dp, [Word::ZERO, one], middle_y, pose.y_span),
        ];
        Self { strips, frac }
    }
}

/// An edge's direction in `NORMAL_BITS` bits.
fn normal<P: Probe>(dp: &mut Datapath<P>, x: Word, y: Word) -> (Word, Word) {
    let length_x = dp.bit_length(x);
    let length_y = dp.bit_length(y);
    let places = length_x.max(length_y).saturating_sub(NORMAL_BITS);
    // Towards zero, so that no component reaches 2^NORMAL_BITS.
    let mut part = |v: Word| {
        let negative = dp.is_negative(v);
        let negated = dp.neg(v);
        let magnitude = dp.select(negative, negated, v);
        let small = dp.shr(magnitude, places);
        let negated = dp.neg(small);
        dp.select(negative, negated, small)
    };
    (part(x), part(y))
}

fn slope<P: Probe>(dp: &mut Datapath<P>, gx: Word, gy: Word) -> WideWord {
    let mut magnitude = |g: Word| {
        let negated = dp.neg(g);
        dp.max(g, negated)
    };
    let x = magnitude(gx);
    let y = magnitude(gy);
    let sum = dp.add(x, y);
    dp.widen(sum)
}

/// One pair of the box's sides.
fn side_strip<P: Probe>(
    dp: &mut Datapath<P>,
    [gx, gy]: [Word; 2],
    middle: Word,
    (low, high): (Word, Word),
) -> Strip {
    let low = dp.widen(low);
    let low = dp.shl(low, 1);
    let high = dp.widen(high);
    let high = dp.shl(high, 1);
    Strip {
        gx,
        gy,
        slope: WideWord::from_host(1),
        value: dp.widen(middle),
        low,
        high,
        settled: false,
    }
}

impl Silhouette for StripSilhouette {
    fn cover<P: Probe>(&mut self, dp: &mut Datapath<P>, below: u32) -> Cover {
        let mut all = true;
        for strip in &mut self.strips {
            match strip.settle(dp, below, self.frac) {
                Cover::None => return Cover::None,
                Cover::Some => all = false,
                Cover::All => {}
            }
        }
        if all { Cover::All } else { Cover::Some }
    }

    fn quadrant<P: Probe>(&self, dp: &mut Datapath<P>, quadrant: u8, below: u32) -> Self {
        // From a node's middle to a quadrant's: 2^(below - 1) half samples.
        let places = below - 1 + self.frac;
        Self {
            strips: std::array::from_fn(|i| self.strips[i].quadrant(dp, quadrant, places)),
            frac: self.frac,
        }
    }
}
