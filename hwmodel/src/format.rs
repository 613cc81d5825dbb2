//! Word formats.

use serde::{Deserialize, Serialize};

/// Bits of the narrowest word.
pub const MIN_BITS: u32 = 16;
/// Bits of the widest word.
pub const MAX_BITS: u32 = 64;

/// A two's complement word format: `bits` bits, `frac` of them fraction.
///
/// Values run from `-2^(bits-1)` to `2^(bits-1) - 1` units of `2^-frac`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Format {
    bits: u32,
    frac: u32,
    wide_bits: u32,
}

/// Why a pair of numbers is no word format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum FormatError {
    /// Outside 16..=64.
    #[error("a word has {MIN_BITS} to {MAX_BITS} bits, not {0}")]
    Bits(u32),
    /// The fraction leaves no integer bit beside the sign.
    #[error("a word of {bits} bits holds at most {max} fraction bits, not {frac}", max = bits - 2)]
    #[expect(missing_docs, reason = "as in `Format::new`")]
    Frac { bits: u32, frac: u32 },
}

impl Format {
    /// A format of `bits` (16..=64) with `frac` (0..=bits-2) fraction bits.
    pub const fn new(bits: u32, frac: u32) -> Result<Self, FormatError> {
        if bits < MIN_BITS || bits > MAX_BITS {
            return Err(FormatError::Bits(bits));
        }
        if frac > bits - 2 {
            return Err(FormatError::Frac { bits, frac });
        }
        let wide_bits = widest(bits);
        Ok(Self {
            bits,
            frac,
            wide_bits,
        })
    }

    /// Width in bits, 16..=64.
    pub const fn bits(self) -> u32 {
        self.bits
    }

    /// Fraction bits, 0..=bits-2.
    pub const fn frac(self) -> u32 {
        self.frac
    }

    /// The format of wide words: twice the bits, at most 64, unless set by [`with_wide_bits`](Self::with_wide_bits).
    #[must_use]
    pub const fn wide(self) -> Self {
        Self {
            bits: self.wide_bits,
            frac: self.frac,
            wide_bits: widest(self.wide_bits),
        }
    }

    /// Sets the bits of wide words, clamped between a word's bits and the default.
    #[must_use]
    pub const fn with_wide_bits(self, bits: u32) -> Self {
        let most = widest(self.bits);
        let bits = if bits > most { most } else { bits };
        let bits = if bits < self.bits { self.bits } else { bits };
        Self {
            wide_bits: bits,
            ..self
        }
    }

    /// Largest value, in units of the last place.
    pub const fn max(self) -> i64 {
        i64::MAX >> (64 - self.bits)
    }
}

const fn widest(bits: u32) -> u32 {
    if bits > 32 { 64 } else { bits * 2 }
}

/// The result of an operation whose exact result does not fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Overflow {
    /// The machine stops with an error.
    #[default]
    Trap,
    /// The bits above the word are dropped.
    Wrap,
    /// The nearest value of the format is taken.
    Saturate,
}
