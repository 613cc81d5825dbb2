//! Formats, numbers and places for several tests.

use hwmodel::{Format, MAX_BITS, MIN_BITS, Stage, StageLevel};
use proptest::prelude::*;

pub(crate) const fn at(stage: Stage, level: u32) -> StageLevel {
    StageLevel { stage, level }
}

pub(crate) fn format(bits: u32) -> Format {
    Format::new(bits, bits / 4).expect("a width within 16..=64")
}

pub(crate) fn widths() -> std::ops::RangeInclusive<u32> {
    MIN_BITS..=MAX_BITS
}

pub(crate) fn least(bits: u32) -> i128 {
    -(1i128 << (bits - 1))
}

pub(crate) fn greatest(bits: u32) -> i128 {
    (1i128 << (bits - 1)) - 1
}

/// Numbers of `bits` bits at which carries, signs and rounding change.
pub(crate) fn edge_cases(bits: u32) -> Vec<i64> {
    let (low, high, half) = (least(bits), greatest(bits), 1i128 << (bits - 2));
    let ends = [low, low + 1, high - 1, high];
    let halves = [-half, half].map(|half| [half - 1, half, half + 1]);
    let all = ends.into_iter().chain(halves.concat()).chain(-3..=3);
    all.map(|value| i64::try_from(value).expect("64 bits at most"))
        .collect()
}

/// Any number of `bits` bits, small or large.
pub(crate) fn any_value(bits: u32) -> impl Strategy<Value = i64> {
    let spare = 64 - bits;
    prop_oneof![
        3 => (any::<i64>(), 0..bits).prop_map(move |(v, less)| v >> (spare + less)),
        1 => proptest::sample::select(edge_cases(bits)),
    ]
}
