//! Helpers of the tests of the datapath: a reference in 128-bit integers, edge cases, and a probe that records every
//! event.

use hwmodel::{
    Datapath, Format, MAX_BITS, MIN_BITS, Memory, NoProbe, Number, OpClass, Overflow, Probe,
    StageLevel, WideWord, Word,
};
use proptest::prelude::*;

/// The three policies.
pub(crate) const POLICIES: [Overflow; 3] = [Overflow::Trap, Overflow::Wrap, Overflow::Saturate];

/// Either of the two types of number, as the host sees it.
pub(crate) trait Host: Number + PartialEq + std::fmt::Debug {
    fn of(value: i64) -> Self;
    fn value(self) -> i64;
    /// Width of this type on a datapath of `format`, from the rule itself
    /// (wide words have twice the bits, 64 at most) and not from `Format`.
    fn bits(format: Format) -> u32;
}

impl Host for Word {
    fn of(value: i64) -> Self {
        Self::from_host(value)
    }
    fn value(self) -> i64 {
        self.to_host()
    }
    fn bits(format: Format) -> u32 {
        format.bits()
    }
}

impl Host for WideWord {
    fn of(value: i64) -> Self {
        Self::from_host(value)
    }
    fn value(self) -> i64 {
        self.to_host()
    }
    fn bits(format: Format) -> u32 {
        (2 * format.bits()).min(64)
    }
}

/// A format of this width.
pub(crate) fn format(bits: u32) -> Format {
    Format::new(bits, bits / 4).expect("a width within 16..=64")
}

/// All widths.
pub(crate) fn widths() -> std::ops::RangeInclusive<u32> {
    MIN_BITS..=MAX_BITS
}

/// A datapath without a probe.
pub(crate) fn datapath(bits: u32, policy: Overflow) -> Datapath<NoProbe> {
    Datapath::new(format(bits), policy, NoProbe)
}

/// Least number of `bits` bits.
pub(crate) fn least(bits: u32) -> i128 {
    -(1i128 << (bits - 1))
}

/// Greatest number of `bits` bits.
pub(crate) fn greatest(bits: u32) -> i128 {
    (1i128 << (bits - 1)) - 1
}

/// An exact result in a word of `bits` bits, and whether it overflowed. After a trap the word is the wrapped one.
pub(crate) fn fit(exact: i128, bits: u32, policy: Overflow) -> (i64, bool) {
    let overflowed = exact < least(bits) || exact > greatest(bits);
    let kept = match policy {
        Overflow::Trap | Overflow::Wrap => {
            let residue = exact.rem_euclid(1i128 << bits);
            if residue > greatest(bits) {
                residue - (1i128 << bits)
            } else {
                residue
            }
        }
        Overflow::Saturate => exact.clamp(least(bits), greatest(bits)),
    };
    let kept = i64::try_from(kept).expect("64 bits at most");
    (kept, overflowed)
}

/// Numbers of `bits` bits at which carries, signs and rounding change.
pub(crate) fn edge_cases(bits: u32) -> Vec<i64> {
    let (low, high) = (least(bits), greatest(bits));
    let half = 1i128 << (bits - 2);
    let all = [
        low,
        low + 1,
        -half - 1,
        -half,
        -half + 1,
        -3,
        -2,
        -1,
        0,
        1,
        2,
        3,
        half - 1,
        half,
        half + 1,
        high - 1,
        high,
    ];
    all.map(|value| i64::try_from(value).expect("64 bits at most"))
        .to_vec()
}

/// Any number of `bits` bits, small or large.
pub(crate) fn any_value(bits: u32) -> impl Strategy<Value = i64> {
    let spare = 64 - bits;
    prop_oneof![
        3 => (any::<i64>(), 0..bits).prop_map(move |(v, less)| v >> (spare + less)),
        1 => proptest::sample::select(edge_cases(bits)),
    ]
}

/// A width, and two numbers that fit a word of it.
pub(crate) fn any_pair() -> impl Strategy<Value = (u32, i64, i64)> {
    widths().prop_flat_map(|bits| (Just(bits), any_value(bits), any_value(bits)))
}

/// A width, and two numbers that fit a wide word of it.
pub(crate) fn any_wide_pair() -> impl Strategy<Value = (u32, i64, i64)> {
    widths().prop_flat_map(|bits| {
        let wide = (2 * bits).min(64);
        (Just(bits), any_value(wide), any_value(wide))
    })
}

/// An event of a probe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Event {
    Op(OpClass, u32, StageLevel, u32),
    Read(Memory, u64, StageLevel),
    Write(Memory, u64, StageLevel),
    Record(u64, u32),
}

/// A probe that writes everything down.
#[derive(Debug, Default)]
pub(crate) struct Log(pub Vec<Event>);

impl Probe for Log {
    fn op(&mut self, class: OpClass, bits: u32, place: StageLevel, times: u32) {
        self.0.push(Event::Op(class, bits, place, times));
    }
    fn read(&mut self, memory: Memory, address: u64, place: StageLevel) {
        self.0.push(Event::Read(memory, address, place));
    }
    fn write(&mut self, memory: Memory, address: u64, place: StageLevel) {
        self.0.push(Event::Write(memory, address, place));
    }
    fn record(&mut self, index: u64, level: u32) {
        self.0.push(Event::Record(index, level));
    }
}
