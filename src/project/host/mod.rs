//! The host's arithmetic, so that it can be counted while it is done.
//!
//! Set-up computes with `Num`s: a number and a `Host` that is told of each
//! step. `Untold` takes no room and hears nothing, so a `Num` of it is the
//! number; a [`Tally`] counts. The code is the same for both, and so are the bits.
//!
//! Not numbers here, and so not counted: levels, numbers of bits, places of
//! shifts, indices; 32-bit integers all, which say what is done, not to what.

mod number;
mod vector;

use std::cell::Cell;

use serde::Serialize;

pub(crate) use number::{Num, Number, Real, Whole};
pub(crate) use vector::{cross, dot, lift_all, times, values};

/// What is done to numbers: one entry for each kind of step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum Step {
    /// Two added, or one subtracted from the other.
    Add,
    /// Two multiplied.
    Multiply,
    /// One divided by another; for integers with the remainder or without.
    Divide,
    /// A square root.
    SquareRoot,
    /// A logarithm to base 2.
    Logarithm,
    /// A tangent.
    Tangent,
    /// Two compared, or one asked whether it is finite.
    Compare,
    /// The smaller or larger of two.
    MinMax,
    /// A sign turned or taken away.
    Sign,
    /// Multiplied by a power of two that is given by its exponent.
    Scale,
    /// Rounded to an integer, up, down, or to the nearest.
    Round,
    /// Made another kind of number; counted as the kind that it becomes.
    Convert,
    /// Shifted.
    Shift,
    /// And, or the place of the first bit.
    Logic,
}

impl Step {
    /// All kinds, in the order of their discriminants.
    pub const ALL: [Self; 14] = [
        Self::Add,
        Self::Multiply,
        Self::Divide,
        Self::SquareRoot,
        Self::Logarithm,
        Self::Tangent,
        Self::Compare,
        Self::MinMax,
        Self::Sign,
        Self::Scale,
        Self::Round,
        Self::Convert,
        Self::Shift,
        Self::Logic,
    ];

    /// The kind in words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Add => "add, subtract",
            Self::Multiply => "multiply",
            Self::Divide => "divide",
            Self::SquareRoot => "square root",
            Self::Logarithm => "logarithm",
            Self::Tangent => "tangent",
            Self::Compare => "compare",
            Self::MinMax => "min/max",
            Self::Sign => "sign",
            Self::Scale => "scale by a power of two",
            Self::Round => "round",
            Self::Convert => "convert",
            Self::Shift => "shift",
            Self::Logic => "logic",
        }
    }
}

/// What numbers are, as the source has them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum Kind {
    /// `f64`.
    Float,
    /// Integers of 64 bits.
    Integer,
    /// Integers of 128 bits.
    LongInteger,
}

impl Kind {
    /// All, in the order of their discriminants.
    pub const ALL: [Self; 3] = [Self::Float, Self::Integer, Self::LongInteger];

    /// The kind in words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Float => "float",
            Self::Integer | Self::LongInteger => "integer",
        }
    }

    /// Width, bits.
    #[must_use]
    pub const fn bits(self) -> u32 {
        match self {
            Self::Float | Self::Integer => 64,
            Self::LongInteger => 128,
        }
    }
}

/// What a step is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum Part {
    /// The camera's axes, and the object's edges seen along them.
    #[default]
    View,
    /// How many fraction bits fit, the integers of that many, how far they reach.
    Quantise,
    /// The eye, solved exactly.
    Eye,
    /// Sizes and shifts that settings ask for.
    Limits,
    /// The depths by level from which on records change to screen space or are solid.
    Depths,
    /// The machine's words, silhouette planes among them.
    Words,
}

impl Part {
    /// All, in the order of their discriminants.
    pub const ALL: [Self; 6] = [
        Self::View,
        Self::Quantise,
        Self::Eye,
        Self::Limits,
        Self::Depths,
        Self::Words,
    ];

    /// The part in words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::View => "camera and view",
            Self::Quantise => "fraction bits and integers",
            Self::Eye => "the exact eye",
            Self::Limits => "settings",
            Self::Depths => "depths by level",
            Self::Words => "the machine's words",
        }
    }
}

/// Is told of each step of the host's arithmetic.
pub(crate) trait Host: Copy {
    /// A step was done on numbers of this kind.
    fn tell(self, step: Step, kind: Kind);

    /// What follows is for this part.
    fn enter(self, part: Part);

    /// A number that it is told about.
    #[inline(always)]
    fn lift<T: Number>(self, value: T) -> Num<Self, T> {
        Num { value, by: self }
    }
}

/// Hears nothing and costs nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Untold;

impl Host for Untold {
    #[inline(always)]
    fn tell(self, _: Step, _: Kind) {}

    #[inline(always)]
    fn enter(self, _: Part) {}
}

/// One cell of a [`Tally`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct HostCell {
    /// What it was for.
    pub part: Part,
    /// What was done.
    pub step: Step,
    /// To what.
    pub kind: Kind,
    /// Width of the numbers, bits.
    pub bits: u32,
    /// How often.
    pub times: u64,
}

/// Counts the host's steps.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    part: Cell<Part>,
    times: [[[Cell<u64>; Kind::ALL.len()]; Step::ALL.len()]; Part::ALL.len()],
}

impl Host for &Tally {
    fn tell(self, step: Step, kind: Kind) {
        let cell = &self.times[self.part.get() as usize][step as usize][kind as usize];
        cell.set(cell.get() + 1);
    }

    fn enter(self, part: Part) {
        self.part.set(part);
    }
}

impl Tally {
    /// What was counted, without what never was done.
    pub fn cells(&self) -> impl Iterator<Item = HostCell> {
        let of_part = move |part: Part| {
            Step::ALL.into_iter().flat_map(move |step| {
                Kind::ALL.into_iter().map(move |kind| HostCell {
                    part,
                    step,
                    kind,
                    bits: kind.bits(),
                    times: self.times[part as usize][step as usize][kind as usize].get(),
                })
            })
        };
        let all = Part::ALL.into_iter().flat_map(of_part);
        all.filter(|cell| cell.times > 0)
    }
}
