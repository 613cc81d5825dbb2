//! Blending, under the rule `alpha` (`SPEC.md`, section 11): how much of its
//! outline a voxel covers, and what that adds to a sample.
//!
//! A voxel is seen from three sides at most, and the share that each has in
//! its outline is that of the way to it along that axis; it counts by the
//! square of the cosine, for that is without bias over all directions. Quotients
//! of few bits, made for each voxel that is drawn.
//! With the opacities of the three sides they make the voxel's weight; a
//! sample takes of each voxel that weight times what it still lets through.
//! Products are sums of shifts over the bits of a number of nine.

use hwmodel::{Datapath, Memory, Narrow, Probe, Short, Stage, Word};

use super::lattice::Lattice;
use super::record::Record;
use super::taps::{Block, LEVEL_BITS};
use super::walk::Walk;
use crate::frame::Blend;
use crate::graph::Opacity;
use crate::project::host::Host;
use crate::project::{ALL_LEFT, FrameSetup, OPAQUE_ENOUGH, SEEN_SHARE, SHARES};

/// Bits of a share of a direction, 0 to 16.
const SHARE_BITS: u32 = 5;
/// Bits of a weight, and of what a sample lets through: 0 to 256.
const WEIGHT_BITS: u32 = 9;
/// Bits of a product of two of those but for the weight of all.
const PRODUCT_BITS: u32 = 17;
/// Bits of a colour in linear light, weighed, and of its sum.
const LIGHT_BITS: u32 = 24;
/// Bits of a colour in linear light.
const COLOR_BITS: u32 = 16;
/// Bits of an opacity.
const OPACITY_BITS: u32 = 4;
/// The weight of a voxel that lets nothing through.
const WHOLE: Narrow = Narrow::from_host(ALL_LEFT);

/// The frame's constants of blending.
#[derive(Debug, Clone, Copy)]
pub(super) struct BlendEye {
    shift: u32,
    at: [Word; 3],
}

impl BlendEye {
    /// Loads them: host work, of which `by` is told.
    pub(super) fn load<P: Probe, H: Host>(dp: &mut Datapath<P>, setup: &FrameSetup, by: H) -> Self {
        let eye = setup.opacity_eye_by(by);
        Self {
            shift: eye.shift,
            at: eye.at.map(|c| dp.load(c)),
        }
    }
}

/// By axis, what a side counts for, in sixteenths of an outline, and whether
/// its share of the outline is large enough for a full side to hide all.
#[derive(Debug, Clone, Copy)]
pub(super) struct Aim {
    counts: [Narrow; 3],
    is_seen: [bool; 3],
}

impl Aim {
    /// Seen from the eye, of a voxel between two corners.
    fn new<P: Probe>(
        dp: &mut Datapath<P>,
        eye: &BlendEye,
        min: &[Word; 3],
        max: &[Word; 3],
    ) -> Self {
        let along: [Word; 3] = std::array::from_fn(|k| {
            let centre = dp.midpoint(min[k], max[k]);
            let centre = dp.shr(centre, eye.shift);
            let way = dp.sub(centre, eye.at[k]);
            let back = dp.neg(way);
            let along = dp.max(way, back);
            let shift = Short::unsigned(eye.shift, LEVEL_BITS);
            dp.tap(Block::BlendWay, &(min[k], max[k], eye.at[k], shift), &along);
            along
        });
        let two = dp.add(along[0], along[1]);
        let all = dp.add(two, along[2]);
        // An eye at the centre sees nothing; it must not divide by it either.
        let all = dp.max(all, Word::from_host(1));
        let sixteen = Word::from_host(SHARES);
        let x = sixteenths_of(dp, along[0], all);
        let y = sixteenths_of(dp, along[1], all);
        let left = dp.sub(sixteen, x);
        let y = dp.min(y, left);
        let z = dp.sub(left, y);
        let shares = [x, y, z].map(|share| dp.narrowed(share, SHARE_BITS));
        let is_seen = shares.map(|share| dp.le_narrow(SHARE_BITS, SEEN, share));
        let shares_shown = wires(shares, SHARE_BITS);
        dp.tap(Block::BlendShares, &along, &(shares_shown, is_seen));
        let squares = shares
            .map(|share| plus_product(dp, WEIGHT_BITS, Narrow::ZERO, share, share, SHARE_BITS));
        let length = length_of(dp, squares);
        let counts = squares.map(|square| quotient_of(dp, square, length));
        dp.tap(
            Block::BlendCounts,
            &shares_shown,
            &wires(counts, SHARE_BITS),
        );
        Self { counts, is_seen }
    }

    /// A voxel's weight, 0 to 256, of its opacities from the three sides that
    /// the eye is on.
    fn weight<P: Probe>(&self, dp: &mut Datapath<P>, opacity: Opacity, high: [bool; 3]) -> Narrow {
        let mut weight = Narrow::ZERO;
        let mut is_whole = false;
        for (k, count) in self.counts.into_iter().enumerate() {
            let sides = [false, true].map(|high| u32::from(opacity.from_side(k, high)));
            let [low_side, high_side] = sides.map(Narrow::from_host);
            let opacity = dp.select_narrow(OPACITY_BITS, high[k], high_side, low_side);
            let eighth = dp.shr_narrow(OPACITY_BITS, opacity, 3);
            let covered = dp.add_narrow(SHARE_BITS, opacity, eighth);
            weight = plus_product(dp, WEIGHT_BITS, weight, covered, count, SHARE_BITS);
            // Sixteen sixteenths: one bit.
            is_whole |= self.is_seen[k] && dp.bit_narrow(covered, OPACITY_BITS);
        }
        let weight = dp.select_narrow(WEIGHT_BITS, is_whole, WHOLE, weight);
        let sides: [[Short; 2]; 3] = std::array::from_fn(|k| {
            [false, true].map(|high| Short::unsigned(opacity.from_side(k, high), OPACITY_BITS))
        });
        dp.tap(
            Block::BlendWeight,
            &(sides, high, wires(self.counts, SHARE_BITS), self.is_seen),
            &Short::narrow(weight, WEIGHT_BITS),
        );
        weight
    }
}

/// Narrow numbers on the wires of a block's border.
#[inline(always)]
fn wires<const N: usize>(numbers: [Narrow; N], bits: u32) -> [Short; N] {
    numbers.map(|number| Short::narrow(number, bits))
}

const SEEN: Narrow = Narrow::from_host(SEEN_SHARE as u32);

/// `16 a / all` to the nearest, halves up, by a restoring divide of one
/// integer step and five more. `0 <= a <= all`.
fn sixteenths_of<P: Probe>(dp: &mut Datapath<P>, a: Word, all: Word) -> Word {
    let (mut remainder, bit) = dp.divide_integer_step(a, all, 0);
    let mut quotient = dp.shift_in(Word::ZERO, bit);
    for _ in 0..SHARE_BITS {
        let (rest, bit) = dp.divide_step(remainder, all, false);
        remainder = rest;
        quotient = dp.shift_in(quotient, bit);
    }
    let up = dp.add(quotient, Word::from_host(1));
    dp.shr(up, 1)
}

/// The square root of the sum of three squares, to the nearest whole number:
/// 9 to 16, for numbers that are 16 together.
fn length_of<P: Probe>(dp: &mut Datapath<P>, [x, y, z]: [Narrow; 3]) -> Narrow {
    let two = dp.add_narrow(WEIGHT_BITS, x, y);
    let all = dp.add_narrow(WEIGHT_BITS, two, z);
    // Half way between a number and the next, squared, less a quarter.
    let mut length = Narrow::from_host(LEAST_LENGTH);
    for (longer, half_way) in (LEAST_LENGTH + 1..).zip(HALF_WAYS) {
        let is_less = dp.le_narrow(WEIGHT_BITS, all, Narrow::from_host(half_way));
        length = dp.select_narrow(SHARE_BITS, is_less, length, Narrow::from_host(longer));
    }
    length
}

const LEAST_LENGTH: u32 = 9;
/// `n (n + 1)` of 9 to 15: a sum above has a root above `n + 1/2`.
const HALF_WAYS: [u32; 7] = [90, 110, 132, 156, 182, 210, 240];

/// A square of at most 256 over a length that is no less than its root, to the
/// nearest, halves up.
fn quotient_of<P: Probe>(dp: &mut Datapath<P>, square: Narrow, length: Narrow) -> Narrow {
    let doubled = dp.shl_narrow(WEIGHT_BITS + 1, square, 1);
    let length = dp.widened(length);
    let mut remainder = dp.widened(doubled);
    let mut quotient = Word::ZERO;
    for place in (0..=SHARE_BITS).rev() {
        let (rest, bit) = dp.divide_integer_step(remainder, length, place);
        remainder = rest;
        quotient = dp.shift_in(quotient, bit);
    }
    let up = dp.add(quotient, Word::from_host(1));
    let rounded = dp.shr(up, 1);
    dp.narrowed(rounded, SHARE_BITS)
}

/// `sum + a times b`, over the `of` bits of `b`.
fn plus_product<P: Probe>(
    dp: &mut Datapath<P>,
    bits: u32,
    mut sum: Narrow,
    a: Narrow,
    b: Narrow,
    of: u32,
) -> Narrow {
    for place in 0..of {
        let part = dp.shl_narrow(bits, a, place);
        let bit = dp.bit_narrow(b, place);
        let part = dp.select_narrow(bits, bit, part, Narrow::ZERO);
        sum = dp.add_narrow(bits, sum, part);
    }
    sum
}

/// What a voxel adds to samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ink {
    weight: Narrow,
    light: [Narrow; 3],
}

/// What became of a sample that took a voxel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Taken {
    /// Whether it is the first that the sample took.
    pub(super) is_first: bool,
    /// Whether the sample is opaque enough by now.
    pub(super) is_full: bool,
}

impl Ink {
    /// Adds a voxel to what a sample has so far.
    pub(super) fn take<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        at: u64,
        sample: &mut Blend,
    ) -> Taken {
        dp.stage(Stage::Blend);
        dp.read(Memory::Accumulator, at);
        let left = Narrow::from_host(u32::from(sample.left));
        let half = Narrow::from_host(ALL_LEFT >> 1);
        let product = plus_product(dp, PRODUCT_BITS, half, left, self.weight, WEIGHT_BITS);
        let share = dp.shr_narrow(PRODUCT_BITS, product, WEIGHT_BITS - 1);
        let rest = dp.sub_narrow(WEIGHT_BITS, left, share);
        let is_full = dp.le_narrow(WEIGHT_BITS, rest, Narrow::from_host(OPAQUE_ENOUGH));
        let share = dp.select_narrow(WEIGHT_BITS, is_full, left, share);
        let rest = dp.select_narrow(WEIGHT_BITS, is_full, Narrow::ZERO, rest);
        let is_first = sample.left == ALL_LEFT as u16;
        let sums = sample.light;
        for (sum, light) in sample.light.iter_mut().zip(self.light) {
            let before = Narrow::from_host(*sum);
            *sum = plus_product(dp, LIGHT_BITS, before, light, share, WEIGHT_BITS).to_host();
        }
        sample.left = rest.to_host() as u16;
        let lights_shown = |sums: [u32; 3]| sums.map(|sum| Short::unsigned(sum, LIGHT_BITS));
        dp.tap(
            Block::BlendSample,
            &(
                wires([left, self.weight], WEIGHT_BITS),
                wires(self.light, COLOR_BITS),
                lights_shown(sums),
            ),
            &(
                Short::narrow(rest, WEIGHT_BITS),
                lights_shown(sample.light),
                [is_first, is_full],
            ),
        );
        dp.write(Memory::Accumulator, at);
        Taken { is_first, is_full }
    }
}

impl<P: Probe, L: Lattice> Walk<'_, P, L> {
    /// Makes what a solid that is drawn adds to samples, under the rule that
    /// blends. Whether there is anything to draw.
    pub(super) fn take_up_ink(&mut self, record: &Record<L>) -> bool {
        let Some(eye) = &self.constants.blend_eye else {
            return true;
        };
        let dp = &mut self.dp;
        dp.stage(Stage::Blend);
        dp.read(Memory::Attribute, u64::from(record.node));
        let aim = Aim::new(dp, eye, &record.min, &record.max);
        let high = std::array::from_fn(|k| {
            let centre = dp.midpoint(record.min[k], record.max[k]);
            !dp.lt(self.constants.eye_floor[k], centre)
        });
        let weight = aim.weight(dp, self.graph.opacity_of(record.node), high);
        let light = self.graph.light_of(record.node);
        let light = light.map(|channel| Narrow::from_host(u32::from(channel)));
        let is_seen = !dp.le_narrow(WEIGHT_BITS, weight, Narrow::ZERO);
        dp.stage(Stage::Draw);
        self.canvas.ink = Some(Ink { weight, light });
        is_seen
    }
}
