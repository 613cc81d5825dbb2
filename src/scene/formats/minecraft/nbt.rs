//! NBT, the tree of named values in Minecraft's files. It is read in place: arrays and lists are slices of the file.
//!
//! The crate `fastnbt` would recurse as deep as a file asks for, so a small damaged file could exhaust the stack.

use std::io::{BufRead, Read};

use flate2::bufread::MultiGzDecoder;

use crate::budget;
use crate::scene::fault::{Fault, Problem, printable};
use crate::scene::input::Input;

/// Levels of nested values, as in Minecraft.
const MOST_LEVELS: u32 = 512;

const AGAIN: &str = "the file is damaged or cut short; export or copy it again";

/// A value; the numbers of arrays are big endian.
#[derive(Debug, Clone, Copy)]
pub(super) enum Value<'b> {
    Whole(i64),
    /// A real number, or an array of 4-byte numbers.
    Other,
    Text(&'b [u8]),
    Bytes(&'b [u8]),
    /// Numbers of 8 bytes.
    Longs(&'b [u8]),
    /// Elements of one kind. The cursor is at the first.
    List {
        kind: u8,
        count: usize,
        at: Cursor<'b>,
    },
    /// The cursor is at the first entry.
    Compound(Cursor<'b>),
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Cursor<'b> {
    rest: &'b [u8],
    length: usize,
}

pub(super) fn fault(
    offset: usize,
    expected: impl Into<String>,
    found: impl Into<String>,
) -> Problem {
    Fault::new("NBT", offset as u64, expected, found, AGAIN).into()
}

/// The content of a file, unpacked if it is compressed by gzip.
pub(super) fn content(input: &mut Input<'_>) -> Result<Vec<u8>, Problem> {
    let begin = input.reader.fill_buf().map_err(Problem::Read)?;
    if !begin.starts_with(b"\x1f\x8b") {
        return input.bytes().map_err(Problem::Read);
    }
    // A vector that grows is held twice for a moment.
    let most = budget::available().map_or(u64::MAX - 1, |free| free / 3);
    let mut bytes = Vec::new();
    let mut unpacked = MultiGzDecoder::new(&mut input.reader).take(most + 1);
    unpacked
        .read_to_end(&mut bytes)
        .map_err(|error| match error.kind() {
            std::io::ErrorKind::OutOfMemory => Problem::Read(error),
            _ => fault(0, "a file compressed by gzip", error.to_string()),
        })?;
    if bytes.len() as u64 > most {
        let expected = format!("at most {most} bytes after unpacking, for which there is memory");
        let advice = "save a part of the scene, or use a computer with more memory";
        return Err(Problem::Limit(Fault::new(
            "gzip", 0, expected, "more", advice,
        )));
    }
    Ok(bytes)
}

impl<'b> Cursor<'b> {
    /// The compound that a file is.
    pub(super) fn root(bytes: &'b [u8]) -> Result<Self, Problem> {
        let mut root = Self {
            rest: bytes,
            length: bytes.len(),
        };
        let [kind] = root.array()?;
        if kind != 10 {
            return Err(fault(0, "a compound, 10", kind.to_string()));
        }
        root.text()?;
        Ok(root)
    }

    pub(super) fn offset(&self) -> usize {
        self.length - self.rest.len()
    }

    /// Passes each entry of this compound to `visit`.
    pub(super) fn entries(
        mut self,
        mut visit: impl FnMut(&'b [u8], Value<'b>) -> Result<(), Problem>,
    ) -> Result<(), Problem> {
        self.each(MOST_LEVELS, &mut visit)
    }

    /// The value of an entry of this compound, the first of that name.
    pub(super) fn get(self, name: &str) -> Result<Option<Value<'b>>, Problem> {
        let mut found = None;
        self.entries(|key, value| {
            if key == name.as_bytes() {
                found.get_or_insert(value);
            }
            Ok(())
        })?;
        Ok(found)
    }

    /// The compounds of a list, from its first element on.
    pub(super) fn compounds(
        mut self,
        count: usize,
        mut visit: impl FnMut(Self) -> Result<(), Problem>,
    ) -> Result<(), Problem> {
        for _ in 0..count {
            visit(self)?;
            self.skip_compound(MOST_LEVELS)?;
        }
        Ok(())
    }

    fn each(
        &mut self,
        levels: u32,
        visit: &mut dyn FnMut(&'b [u8], Value<'b>) -> Result<(), Problem>,
    ) -> Result<(), Problem> {
        loop {
            let [kind] = self.array()?;
            if kind == 0 {
                return Ok(());
            }
            let name = self.text()?;
            let value = self.value(kind, levels)?;
            visit(name, value)?;
        }
    }

    fn skip_compound(&mut self, levels: u32) -> Result<(), Problem> {
        self.each(levels, &mut |_, _| Ok(()))
    }

    /// Reads a value of a kind, and moves behind it.
    fn value(&mut self, kind: u8, levels: u32) -> Result<Value<'b>, Problem> {
        let begin = self.offset();
        Ok(match kind {
            1 => Value::Whole(i8::from_be_bytes(self.array()?).into()),
            2 => Value::Whole(i16::from_be_bytes(self.array()?).into()),
            3 => Value::Whole(i32::from_be_bytes(self.array()?).into()),
            4 => Value::Whole(i64::from_be_bytes(self.array()?)),
            5 => self.take(4).map(|_| Value::Other)?,
            6 => self.take(8).map(|_| Value::Other)?,
            7 => Value::Bytes(self.numbers(1)?),
            8 => Value::Text(self.text()?),
            9 => self.list(levels)?,
            10 if levels > 0 => {
                let at = *self;
                self.skip_compound(levels - 1)?;
                Value::Compound(at)
            }
            11 => self.numbers(4).map(|_| Value::Other)?,
            12 => Value::Longs(self.numbers(8)?),
            10 => {
                return Err(fault(
                    begin,
                    format!("at most {MOST_LEVELS} levels"),
                    "more",
                ));
            }
            _ => {
                return Err(fault(
                    begin,
                    "kinds of values from 1 to 12",
                    kind.to_string(),
                ));
            }
        })
    }

    fn list(&mut self, levels: u32) -> Result<Value<'b>, Problem> {
        let begin = self.offset();
        let [kind] = self.array()?;
        let count = self.count()?;
        let at = *self;
        match kind {
            // Elements of a fixed size; of kind 0 there are none.
            0..=6 => {
                let size = [0, 1, 2, 4, 8, 4, 8][usize::from(kind)];
                self.take(count.saturating_mul(size))?;
            }
            _ if levels == 0 => {
                return Err(fault(
                    begin,
                    format!("at most {MOST_LEVELS} levels"),
                    "more",
                ));
            }
            _ => {
                for _ in 0..count {
                    self.value(kind, levels - 1)?;
                }
            }
        }
        Ok(Value::List { kind, count, at })
    }

    fn numbers(&mut self, size: usize) -> Result<&'b [u8], Problem> {
        let count = self.count()?;
        self.take(count.saturating_mul(size))
    }

    fn count(&mut self) -> Result<usize, Problem> {
        let begin = self.offset();
        let count = i32::from_be_bytes(self.array()?);
        usize::try_from(count).map_err(|_| fault(begin, "a number of elements", count.to_string()))
    }

    fn text(&mut self) -> Result<&'b [u8], Problem> {
        let length = u16::from_be_bytes(self.array()?);
        self.take(length.into())
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Problem> {
        let begin = self.offset();
        let short = |found| fault(begin, format!("{N} more bytes"), printable(found));
        let (first, rest) = self
            .rest
            .split_first_chunk()
            .ok_or_else(|| short(self.rest))?;
        self.rest = rest;
        Ok(*first)
    }

    fn take(&mut self, count: usize) -> Result<&'b [u8], Problem> {
        let left = self.rest.len();
        let parts = self.rest.split_at_checked(count);
        let expected = || {
            fault(
                self.offset(),
                format!("{count} more bytes"),
                left.to_string(),
            )
        };
        let (first, rest) = parts.ok_or_else(expected)?;
        self.rest = rest;
        Ok(first)
    }
}
