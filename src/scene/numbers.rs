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
    /// The type of a kind, `i`, `u` or `f`, and of as many bytes as a digit says.
    pub(super) fn of(kind: u8, size: u8) -> Option<Self> {
        Some(match [kind, size] {
            [b'i', b'1'] => Self::I8,
            [b'i', b'2'] => Self::I16,
            [b'i', b'4'] => Self::I32,
            [b'i', b'8'] => Self::I64,
            [b'u', b'1'] => Self::U8,
            [b'u', b'2'] => Self::U16,
            [b'u', b'4'] => Self::U32,
            [b'u', b'8'] => Self::U64,
            [b'f', b'4'] => Self::F32,
            [b'f', b'8'] => Self::F64,
            _ => return None,
        })
    }

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

    /// The numbers at the beginnings of some bytes; missing bytes count as 0.
    #[inline]
    pub(super) fn decode<'a>(
        self,
        big_endian: bool,
        numbers: impl Iterator<Item = (&'a [u8], &'a mut Number)>,
    ) {
        macro_rules! each {
            ($type:ty, $number:expr) => {
                for (bytes, number) in numbers {
                    let bytes = bytes.first_chunk().copied().unwrap_or_default();
                    let value = match big_endian {
                        true => <$type>::from_be_bytes(bytes),
                        false => <$type>::from_le_bytes(bytes),
                    };
                    *number = $number(value);
                }
            };
        }
        match self {
            Self::I8 => each!(i8, |n: i8| Number::Whole(n.into())),
            Self::U8 => each!(u8, |n: u8| Number::Whole(n.into())),
            Self::I16 => each!(i16, |n: i16| Number::Whole(n.into())),
            Self::U16 => each!(u16, |n: u16| Number::Whole(n.into())),
            Self::I32 => each!(i32, |n: i32| Number::Whole(n.into())),
            Self::U32 => each!(u32, |n: u32| Number::Whole(n.into())),
            Self::I64 => each!(i64, Number::Whole),
            Self::U64 => {
                each!(u64, |n: u64| i64::try_from(n)
                    .map_or(Number::Real(n as f64), Number::Whole))
            }
            Self::F32 => each!(f32, |x: f32| Number::Real(x.into())),
            Self::F64 => each!(f64, Number::Real),
        }
    }

    pub(super) fn decode_one(self, big_endian: bool, bytes: &[u8]) -> Number {
        let mut number = Number::Whole(0);
        self.decode(big_endian, std::iter::once((bytes, &mut number)));
        number
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
