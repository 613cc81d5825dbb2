//! Values on the wires of a block, for test benches.

use crate::{Format, Narrow, WideWord, Word};

/// Width and sign of a signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SignalKind {
    /// A word.
    Word,
    /// A wide word.
    Wide,
    /// A number of 1 to 64 bits that is never negative.
    Unsigned(u32),
    /// A two's complement number of 1 to 64 bits.
    Signed(u32),
}

impl SignalKind {
    /// Width.
    pub const fn bits(self, format: Format) -> u32 {
        match self {
            Self::Word => format.bits(),
            Self::Wide => format.wide().bits(),
            Self::Unsigned(bits) | Self::Signed(bits) => bits,
        }
    }

    /// Whether the highest bit is a sign.
    pub const fn is_signed(self) -> bool {
        !matches!(self, Self::Unsigned(_))
    }
}

/// A value on the wires of a block, in units of the last place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "names of the fields say what they are")]
pub struct Signal {
    pub kind: SignalKind,
    pub value: i64,
}

/// A short number that is not a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Short(Signal);

impl Short {
    /// A number that is never negative, on `bits` wires.
    #[inline(always)]
    pub fn unsigned(value: impl Into<u32>, bits: u32) -> Self {
        Self(Signal {
            kind: SignalKind::Unsigned(bits),
            value: i64::from(value.into()),
        })
    }

    /// A two's complement number on `bits` wires.
    #[inline(always)]
    pub fn signed(value: i32, bits: u32) -> Self {
        Self(Signal {
            kind: SignalKind::Signed(bits),
            value: i64::from(value),
        })
    }

    /// A narrow number, on `bits` wires.
    #[inline(always)]
    pub fn narrow(value: Narrow, bits: u32) -> Self {
        Self::unsigned(value.to_host(), bits)
    }
}

/// A value as signals.
pub trait Wires {
    /// Adds the signals, the most significant first.
    fn show(&self, to: &mut Vec<Signal>);
}

impl Wires for Word {
    fn show(&self, to: &mut Vec<Signal>) {
        to.push(Signal {
            kind: SignalKind::Word,
            value: self.0,
        });
    }
}

impl Wires for WideWord {
    fn show(&self, to: &mut Vec<Signal>) {
        to.push(Signal {
            kind: SignalKind::Wide,
            value: self.0,
        });
    }
}

impl Wires for Short {
    fn show(&self, to: &mut Vec<Signal>) {
        to.push(self.0);
    }
}

impl Wires for bool {
    fn show(&self, to: &mut Vec<Signal>) {
        to.push(Signal {
            kind: SignalKind::Unsigned(1),
            value: i64::from(*self),
        });
    }
}

impl<T: Wires + ?Sized> Wires for &T {
    fn show(&self, to: &mut Vec<Signal>) {
        (**self).show(to);
    }
}

impl<T: Wires, const N: usize> Wires for [T; N] {
    fn show(&self, to: &mut Vec<Signal>) {
        for part in self {
            part.show(to);
        }
    }
}

macro_rules! wires_of_tuples {
    ($(($($part:ident)+))+) => {$(
        impl<$($part: Wires),+> Wires for ($($part,)+) {
            #[expect(non_snake_case, reason = "parts are named like their types")]
            fn show(&self, to: &mut Vec<Signal>) {
                let ($($part,)+) = self;
                $($part.show(to);)+
            }
        }
    )+};
}

wires_of_tuples! { (A B) (A B C) (A B C D) (A B C D E) }
