//! Blending, under the rule `alpha` (`SPEC.md`, R11). A side counts by the square of its cosine, which is unbiased over
//! all directions. Products are sums of shifts over one factor's bits, at most nine.

use crate::machine::stages::RecordStage;
use hwmodel::{Datapath, Memory, Narrow, Probe, Short, Word};

use super::blocks::{Block, LEVEL_BITS};
use super::constants::BlendEye;
use super::record::Cube;
use crate::frame::Blend;
use crate::graph::Opacity;
use crate::project::{ALL_LEFT, OPAQUE_ENOUGH, SHARES};

/// Bits of a share of a direction, 0 to 16.
const SHARE_BITS: u32 = 5;
/// Bits of a weight, and of a sample's transmittance: 0 to 256.
const WEIGHT_BITS: u32 = 9;
/// Bits of a weight times a transmittance, plus a half.
const PRODUCT_BITS: u32 = 17;
/// Bits of a colour times a share, and of the sum of those.
const LIGHT_BITS: u32 = 24;
const COLOR_BITS: u32 = 16;
const OPACITY_BITS: u32 = 4;
const WHOLE: Narrow = Narrow::from_host(ALL_LEFT);

/// By axis, the visible side's sixteenths of a voxel's outline.
#[derive(Debug, Clone, Copy)]
struct VisibleSides([Narrow; 3]);

impl VisibleSides {
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
        // An eye at the centre sees no side; the divisor must not be zero.
        let all = dp.max(all, Word::from_host(1));
        let sixteen = Word::from_host(SHARES);
        let x = sixteenths_of(dp, along[0], all);
        let y = sixteenths_of(dp, along[1], all);
        let left = dp.sub(sixteen, x);
        let y = dp.min(y, left);
        let z = dp.sub(left, y);
        let shares = [x, y, z].map(|share| dp.narrowed(share, SHARE_BITS));
        let shares_shown = wires(shares, SHARE_BITS);
        dp.tap(Block::BlendShares, &along, &shares_shown);
        let squares = shares
            .map(|share| plus_product(dp, WEIGHT_BITS, Narrow::ZERO, share, share, SHARE_BITS));
        let length = length_of(dp, squares);
        let counts = squares.map(|square| quotient_of(dp, square, length));
        dp.tap(
            Block::BlendCounts,
            &shares_shown,
            &wires(counts, SHARE_BITS),
        );
        Self(counts)
    }

    /// A voxel's weight, 0 to 256. `high`: by axis, whether the eye is on the side of the greater coordinate.
    fn weight<P: Probe>(&self, dp: &mut Datapath<P>, opacity: Opacity, high: [bool; 3]) -> Narrow {
        let mut weight = Narrow::ZERO;
        let mut is_whole = false;
        for (k, count) in self.0.into_iter().enumerate() {
            let sides = [false, true].map(|high| u32::from(opacity.from_side(k, high)));
            let [low_side, high_side] = sides.map(Narrow::from_host);
            let opacity = dp.select_narrow(OPACITY_BITS, high[k], high_side, low_side);
            let eighth = dp.shr_narrow(OPACITY_BITS, opacity, 3);
            let covered = dp.add_narrow(SHARE_BITS, opacity, eighth);
            weight = plus_product(dp, WEIGHT_BITS, weight, covered, count, SHARE_BITS);
            // Sixteen sixteenths: one bit. Otherwise a ray that grazes a wall would pass many of its voxels.
            is_whole |= dp.bit_narrow(covered, OPACITY_BITS);
        }
        let weight = dp.select_narrow(WEIGHT_BITS, is_whole, WHOLE, weight);
        let sides: [[Short; 2]; 3] = std::array::from_fn(|k| {
            [false, true].map(|high| Short::unsigned(opacity.from_side(k, high), OPACITY_BITS))
        });
        dp.tap(
            Block::BlendWeight,
            &(sides, high, wires(self.0, SHARE_BITS)),
            &Short::narrow(weight, WEIGHT_BITS),
        );
        weight
    }
}

#[inline(always)]
fn wires<const N: usize>(numbers: [Narrow; N], bits: u32) -> [Short; N] {
    numbers.map(|number| Short::narrow(number, bits))
}

/// `16 a / all` to the nearest, halves up, by a restoring divide. `0 <= a <= all`.
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

/// The root of the sum of three squares of numbers whose sum is 16, to the nearest: 9 to 16.
fn length_of<P: Probe>(dp: &mut Datapath<P>, [x, y, z]: [Narrow; 3]) -> Narrow {
    let two = dp.add_narrow(WEIGHT_BITS, x, y);
    let all = dp.add_narrow(WEIGHT_BITS, two, z);
    let mut length = Narrow::from_host(LEAST_LENGTH);
    for (longer, half_way) in (LEAST_LENGTH + 1..).zip(HALF_WAYS) {
        let is_less = dp.le_narrow(WEIGHT_BITS, all, Narrow::from_host(half_way));
        length = dp.select_narrow(SHARE_BITS, is_less, length, Narrow::from_host(longer));
    }
    length
}

const LEAST_LENGTH: u32 = 9;
/// `n (n + 1)`, `n` from 9 to 15, is `(n + 1/2)^2 - 1/4`: roots of greater whole numbers are above `n + 1/2`.
const HALF_WAYS: [u32; 7] = [90, 110, 132, 156, 182, 210, 240];

/// A square of at most 256 divided by a length that is at least its root, to the nearest, halves up.
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

/// `sum` plus `a` times `b`, by adding over the `of` bits of `b`.
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

#[derive(Debug, Clone, Copy)]
pub(super) struct BlendColor {
    /// 0 to 256.
    pub(super) weight: Narrow,
    /// Linear light, 0 to 65535 per channel.
    pub(super) light: [Narrow; 3],
}

impl BlendColor {
    /// `None`: the weight is zero. `eye_floor`: the eye in the units of `cube`.
    pub(super) fn of_voxel<P: Probe>(
        dp: &mut Datapath<P>,
        eye: &BlendEye,
        eye_floor: &[Word; 3],
        cube: &Cube,
        opacity: Opacity,
        light: [u16; 3],
    ) -> Option<Self> {
        dp.stage(RecordStage::Blend);
        dp.read(Memory::Attribute, u64::from(cube.node));
        let sides = VisibleSides::new(dp, eye, &cube.min, &cube.max);
        let high = std::array::from_fn(|k| {
            let centre = dp.midpoint(cube.min[k], cube.max[k]);
            !dp.lt(eye_floor[k], centre)
        });
        let weight = sides.weight(dp, opacity, high);
        let light = light.map(|channel| Narrow::from_host(u32::from(channel)));
        let is_seen = !dp.le_narrow(WEIGHT_BITS, weight, Narrow::ZERO);
        is_seen.then_some(Self { weight, light })
    }

    /// Adds the voxel to sample number `at`. Returns whether it is the first there, and makes the sample opaque enough.
    pub(super) fn add_to<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        at: u64,
        sample: &mut Blend,
    ) -> [bool; 2] {
        dp.stage(RecordStage::Blend);
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
            *sum = plus_product(dp, LIGHT_BITS, before, light, share, WEIGHT_BITS).to_host(); // host: the sample's memory
        }
        sample.left = rest.to_host() as u16; // host: the sample's memory
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
        [is_first, is_full]
    }
}
