//! Numbers as PLY and NumPy files store them.

use std::fmt;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    pub(super) fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// The number at the beginning of some bytes; missing bytes count as 0.
    #[inline]
    pub(super) fn decode(self, big_endian: bool, bytes: &[u8]) -> Number {
        let size = self.size();
        let mut little = [0; 8];
        for (to, from) in little[..size].iter_mut().zip(bytes) {
            *to = *from;
        }
        if big_endian {
            little[..size].reverse();
        }
        let bits = u64::from_le_bytes(little);
        match self {
            Self::I8 => Number::Whole((bits as i8).into()),
            Self::I16 => Number::Whole((bits as i16).into()),
            Self::I32 => Number::Whole((bits as i32).into()),
            Self::U8 | Self::U16 | Self::U32 | Self::I64 => Number::Whole(bits as i64),
            Self::U64 => i64::try_from(bits).map_or(Number::Real(bits as f64), Number::Whole),
            Self::F32 => Number::Real(f32::from_bits(bits as u32).into()),
            Self::F64 => Number::Real(f64::from_bits(bits)),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    /// Of an integer type, or written without a point.
    Whole(i64),
    /// Of a floating point type, or written with a point.
    Real(f64),
}

impl Number {
    /// As a whole number, if it is one that `f64` holds exactly.
    pub fn whole(self) -> Option<i64> {
        match self {
            Self::Whole(n) => Some(n),
            Self::Real(x) => {
                let whole = x as i64;
                (whole as f64 == x && x.abs() < 9_007_199_254_740_992.0).then_some(whole)
            }
        }
    }

    pub fn real(self) -> f64 {
        match self {
            Self::Whole(n) => n as f64,
            Self::Real(x) => x,
        }
    }

    /// A colour channel as a byte: a whole number up to 255, or a real one as a share of 1, rounded to nearest.
    pub fn channel(self) -> Option<u8> {
        match self {
            Self::Whole(n) => u8::try_from(n).ok(),
            // From 0.5 to 255.5 after scaling, so the cast truncates within a byte.
            Self::Real(x) if (0.0..=1.0).contains(&x) => Some((x * 255.0 + 0.5) as u8),
            Self::Real(_) => None,
        }
    }

    pub(super) fn parse(word: &[u8]) -> Option<Self> {
        let text = std::str::from_utf8(word).ok()?;
        let whole = text.parse().map(Self::Whole);
        whole.or_else(|_| text.parse().map(Self::Real)).ok()
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole(n) => n.fmt(f),
            Self::Real(x) => x.fmt(f),
        }
    }
}
