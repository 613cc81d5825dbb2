//! Bytes, lines and numbers from a stream, and where in the file they are.

use std::io::{BufRead, Read};

use super::numbers::{Encoding, Scalar};
use crate::scene::fault::{Fault, Problem};

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
            // Below 2^53 the casts are exact.
            Self::Real(x) => {
                let whole = x as i64;
                (whole as f64 == x && x.abs() < 9_007_199_254_740_992.0).then_some(whole)
            }
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
        let most = longest as u64 + 1;
        let read = self.reader.by_ref().take(most).read_until(b'\n', line);
        let read = read.map_err(Problem::Read)? as u64;
        self.offset += read;
        if line.last() == Some(&b'\n') {
            line.pop();
            if line.last() == Some(&b'\r') {
                line.pop();
            }
        } else if read == most {
            return Err(Fault::new(
                part,
                begin,
                format!("lines of at most {longest} bytes, ended by a line feed"),
                "a longer one",
                "the file is damaged, or binary where its header says ascii; export it again",
            )
            .into());
        }
        Ok(read > 0)
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

    /// Reads so many bytes; `None` where the file ends first. `scratch`: for those that do not lie side by side in
    /// the reader's buffer.
    #[inline]
    pub(super) fn bytes<T>(
        &mut self,
        count: usize,
        scratch: &mut Vec<u8>,
        decode: impl FnOnce(&[u8]) -> T,
    ) -> Result<Option<T>, Problem> {
        if let Some(bytes) = self.reader.fill_buf().map_err(Problem::Read)?.get(..count) {
            let decoded = decode(bytes);
            self.reader.consume(count);
            self.offset += count as u64;
            return Ok(Some(decoded));
        }
        scratch.resize(count, 0);
        match self.reader.read_exact(scratch) {
            Ok(()) => {
                self.offset += count as u64;
                Ok(Some(decode(scratch)))
            }
            Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => Ok(None),
            Err(error) => Err(Problem::Read(error)),
        }
    }

    /// Reads a binary number; `None` where the file ends first.
    #[inline]
    pub(super) fn number(
        &mut self,
        scalar: Scalar,
        encoding: Encoding,
    ) -> Result<Option<Number>, Problem> {
        let mut bytes = [0u8; 8];
        let bytes = &mut bytes[..scalar.size()];
        match self.reader.read_exact(bytes) {
            Ok(()) => {
                self.offset += bytes.len() as u64;
                Ok(Some(decode(scalar, encoding, bytes)))
            }
            Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => Ok(None),
            Err(error) => Err(Problem::Read(error)),
        }
    }
}

/// The binary number that bytes begin with; 0 where there are too few.
#[inline]
pub(super) fn decode(scalar: Scalar, encoding: Encoding, bytes: &[u8]) -> Number {
    #[inline]
    fn first<const N: usize>(bytes: &[u8], encoding: Encoding) -> [u8; N] {
        let mut first = bytes.first_chunk().copied().unwrap_or([0; N]);
        if encoding == Encoding::Big {
            first.reverse();
        }
        first
    }
    match scalar {
        Scalar::I8 => Number::Whole(i64::from(i8::from_le_bytes(first(bytes, encoding)))),
        Scalar::U8 => Number::Whole(i64::from(u8::from_le_bytes(first(bytes, encoding)))),
        Scalar::I16 => Number::Whole(i64::from(i16::from_le_bytes(first(bytes, encoding)))),
        Scalar::U16 => Number::Whole(i64::from(u16::from_le_bytes(first(bytes, encoding)))),
        Scalar::I32 => Number::Whole(i64::from(i32::from_le_bytes(first(bytes, encoding)))),
        Scalar::U32 => Number::Whole(i64::from(u32::from_le_bytes(first(bytes, encoding)))),
        Scalar::F32 => Number::Real(f64::from(f32::from_le_bytes(first(bytes, encoding)))),
        Scalar::F64 => Number::Real(f64::from_le_bytes(first(bytes, encoding))),
    }
}

/// A number of an ASCII body.
pub(super) fn parse_number(word: &[u8]) -> Option<Number> {
    if let Some(whole) = parse_short(word) {
        return Some(Number::Whole(whole));
    }
    let text = std::str::from_utf8(word).ok()?;
    if let Ok(whole) = text.parse() {
        return Some(Number::Whole(whole));
    }
    text.parse().ok().map(Number::Real)
}

/// A whole number of up to 18 digits, as nearly all are.
#[inline]
fn parse_short(word: &[u8]) -> Option<i64> {
    let (digits, sign) = match word {
        [b'-', digits @ ..] => (digits, -1),
        digits => (digits, 1),
    };
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    let mut size = 0;
    for digit in digits {
        let digit = digit.wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        size = 10 * size + i64::from(digit);
    }
    Some(sign * size)
}
