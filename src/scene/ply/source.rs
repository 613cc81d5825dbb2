//! Bytes, lines and numbers from a stream, and where in the file they are.

use std::io::BufRead;

use super::header::{Encoding, Scalar};
use crate::scene::error::{Fault, Problem};

/// A number as a file has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Number {
    /// Of an integer type.
    Whole(i64),
    /// Of a floating point type, or an integer type's number written with a point.
    Real(f64),
}

impl Number {
    /// As a whole number, where it is one that `f64` holds exactly.
    pub(super) fn whole(self) -> Option<i64> {
        match self {
            Self::Whole(n) => Some(n),
            // Below 2^53 the cast is exact.
            Self::Real(x) if x == x.trunc() && x.abs() < 9_007_199_254_740_992.0 => Some(x as i64),
            Self::Real(_) => None,
        }
    }

    /// As a real number.
    pub(super) fn real(self) -> f64 {
        match self {
            Self::Whole(n) => n as f64,
            Self::Real(x) => x,
        }
    }
}

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Whole(n) => n.fmt(f),
            Self::Real(x) => x.fmt(f),
        }
    }
}

/// A stream that knows its position.
pub(super) struct Source<'a, R> {
    reader: &'a mut R,
    offset: u64,
}

impl<'a, R: BufRead> Source<'a, R> {
    pub(super) fn new(reader: &'a mut R) -> Self {
        Self { reader, offset: 0 }
    }

    /// Bytes read so far.
    pub(super) fn offset(&self) -> u64 {
        self.offset
    }

    /// Reads a line without its end; `false` at the end of the file.
    pub(super) fn line(
        &mut self,
        line: &mut Vec<u8>,
        longest: usize,
        part: &str,
    ) -> Result<bool, Problem> {
        line.clear();
        let begin = self.offset;
        loop {
            let buffer = self.reader.fill_buf().map_err(Problem::Read)?;
            if buffer.is_empty() {
                return Ok(self.offset > begin);
            }
            let end = buffer.iter().position(|b| *b == b'\n');
            let used = end.map_or(buffer.len(), |end| end + 1);
            line.extend_from_slice(&buffer[..end.unwrap_or(buffer.len())]);
            self.reader.consume(used);
            self.offset += used as u64;
            if line.len() > longest {
                return Err(Fault::new(
                    part,
                    begin,
                    format!("lines of at most {longest} bytes, ended by a line feed"),
                    "a longer one",
                    "the file is damaged, or binary where its header says ascii; export it again",
                )
                .into());
            }
            if end.is_some() {
                if line.last() == Some(&b'\r') {
                    line.pop();
                }
                return Ok(true);
            }
        }
    }

    /// Skips bytes; `false` where the file ends first.
    pub(super) fn skip(&mut self, mut count: u64) -> Result<bool, Problem> {
        while count > 0 {
            let buffer = self.reader.fill_buf().map_err(Problem::Read)?;
            if buffer.is_empty() {
                return Ok(false);
            }
            let used = usize::try_from(count)
                .unwrap_or(usize::MAX)
                .min(buffer.len());
            self.reader.consume(used);
            self.offset += used as u64;
            count -= used as u64;
        }
        Ok(true)
    }

    /// Reads a binary number; `None` where the file ends first.
    #[inline]
    pub(super) fn number(
        &mut self,
        scalar: Scalar,
        encoding: Encoding,
    ) -> Result<Option<Number>, Problem> {
        let mut bytes = [0u8; 8];
        let size = scalar.size();
        // Nearly always more than a number is at hand. What lies behind it is not looked at.
        if let Ok(buffer) = self.reader.fill_buf()
            && let Some(at_hand) = buffer.first_chunk()
        {
            bytes = *at_hand;
            self.reader.consume(size);
            self.offset += size as u64;
        } else {
            match self.reader.read_exact(&mut bytes[..size]) {
                Ok(()) => self.offset += size as u64,
                Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => return Ok(None),
                Err(error) => return Err(Problem::Read(error)),
            }
        }
        if encoding == Encoding::Big {
            bytes[..size].reverse();
        }
        let [a, b, c, d, ..] = bytes;
        Ok(Some(match scalar {
            Scalar::I8 => Number::Whole(i64::from(a as i8)),
            Scalar::U8 => Number::Whole(i64::from(a)),
            Scalar::I16 => Number::Whole(i64::from(i16::from_le_bytes([a, b]))),
            Scalar::U16 => Number::Whole(i64::from(u16::from_le_bytes([a, b]))),
            Scalar::I32 => Number::Whole(i64::from(i32::from_le_bytes([a, b, c, d]))),
            Scalar::U32 => Number::Whole(i64::from(u32::from_le_bytes([a, b, c, d]))),
            Scalar::F32 => Number::Real(f64::from(f32::from_le_bytes([a, b, c, d]))),
            Scalar::F64 => Number::Real(f64::from_le_bytes(bytes)),
        }))
    }
}

/// A number of an ASCII body.
pub(super) fn parse_number(word: &[u8]) -> Option<Number> {
    let text = std::str::from_utf8(word).ok()?;
    if let Ok(whole) = text.parse() {
        return Some(Number::Whole(whole));
    }
    text.parse().ok().map(Number::Real)
}
