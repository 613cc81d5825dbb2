//! Iterates over the chunks of a `.vox` file, and reads the fields of a chunk.
//!
//! A file is `VOX `, a version, and one chunk `MAIN`, whose children are read. A chunk is an id of 4 bytes, the sizes of
//! content and children, the content, and the children. Every size is compared with the bytes left before use.

use super::DAMAGED;
use crate::scene::fault::{Fault, printable};

const HEADER: usize = 12;

const TRUNCATED: &str = "the file is cut short or damaged; export or copy it again";

type Fallible<T> = Result<T, Box<Fault>>;

#[derive(Debug, Clone, Copy)]
pub(super) struct Chunk<'a> {
    pub id: [u8; 4],
    pub offset: usize,
    pub content: &'a [u8],
}

/// Checks the file's head. Returns the children of `MAIN`, which end after the first error, and the number of bytes after
/// them.
pub(super) fn chunks(bytes: &[u8]) -> Fallible<(impl Iterator<Item = Fallible<Chunk<'_>>>, usize)> {
    if bytes.len() < 8 || &bytes[..4] != b"VOX " {
        return Err(Fault::new(
            "file header",
            0,
            "\"VOX \" and a version (8 bytes)",
            printable(&bytes[..bytes.len().min(8)]),
            TRUNCATED,
        ));
    }
    let (main, content, children) = header(bytes, 8, bytes.len(), "the file")?;
    if &main != b"MAIN" {
        return Err(Fault::new(
            "first chunk",
            8,
            "the chunk \"MAIN\"",
            printable(&main),
            DAMAGED,
        ));
    }
    let mut offset = 8 + HEADER + content;
    let end = offset + children;
    let next = move || {
        if offset == end {
            return None;
        }
        let (id, content, children) = match header(bytes, offset, end, "MAIN") {
            Ok(header) => header,
            Err(fault) => {
                offset = end;
                return Some(Err(fault));
            }
        };
        let begin = offset + HEADER;
        let chunk = Chunk {
            id,
            offset,
            content: &bytes[begin..begin + content],
        };
        offset = begin + content + children;
        Some(Ok(chunk))
    };
    Ok((std::iter::from_fn(next), bytes.len() - end))
}

/// A chunk's id and its two sizes, which together end no later than `end`.
fn header(
    bytes: &[u8],
    offset: usize,
    end: usize,
    within: &str,
) -> Result<([u8; 4], usize, usize), Box<Fault>> {
    let left = end - offset;
    let Some(head) = bytes[offset..end].first_chunk::<HEADER>() else {
        return Err(Fault::new(
            "chunk header",
            offset as u64,
            format!("{HEADER} bytes of id and sizes"),
            format!("{left} bytes left in {within}"),
            TRUNCATED,
        ));
    };
    let id = [head[0], head[1], head[2], head[3]];
    let content = u32::from_le_bytes([head[4], head[5], head[6], head[7]]);
    let children = u32::from_le_bytes([head[8], head[9], head[10], head[11]]);
    let needed = u64::from(content) + u64::from(children);
    if needed > (left - HEADER) as u64 {
        return Err(Fault::new(
            format!("chunk {}", printable(&id)),
            offset as u64,
            format!("{content} bytes of content and {children} of children, as its header says"),
            format!("{} bytes left in {within}", left - HEADER),
            TRUNCATED,
        ));
    }
    Ok((id, content as usize, children as usize))
}

#[derive(Debug, Clone, Default)]
pub(super) struct Dict<'a> {
    entries: Vec<(&'a [u8], &'a [u8])>,
    pub offset: u64,
}

impl<'a> Dict<'a> {
    pub(super) fn get(&self, key: &str) -> Option<&'a [u8]> {
        let found = self
            .entries
            .iter()
            .rev()
            .find(|(k, _)| *k == key.as_bytes());
        found.map(|(_, value)| *value)
    }

    pub(super) fn is_set(&self, key: &str) -> bool {
        self.get(key)
            .is_some_and(|value| value.trim_ascii() == b"1")
    }

    /// The whole numbers of a value, exactly `N` of them, or `None` where the key is absent.
    pub(super) fn numbers<const N: usize>(
        &self,
        key: &str,
        part: &str,
        expected: &str,
    ) -> Result<Option<[i32; N]>, Box<Fault>> {
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        let mut words = value
            .split(u8::is_ascii_whitespace)
            .filter(|word| !word.is_empty());
        let mut numbers = [0; N];
        let mut good = true;
        for number in &mut numbers {
            let parsed = words
                .next()
                .and_then(|word| std::str::from_utf8(word).ok()?.parse().ok());
            match parsed {
                Some(parsed) => *number = parsed,
                None => good = false,
            }
        }
        if good && words.next().is_none() {
            return Ok(Some(numbers));
        }
        Err(Fault::new(
            format!("{part}, attribute {key}"),
            self.offset,
            expected,
            printable(value),
            DAMAGED,
        ))
    }
}

pub(super) struct Fields<'a> {
    part: String,
    content: &'a [u8],
    at: usize,
    base: usize,
}

impl<'a> Fields<'a> {
    pub(super) fn new(chunk: &Chunk<'a>) -> Self {
        Self {
            part: format!("chunk {}", chunk.id.escape_ascii()),
            content: chunk.content,
            at: 0,
            base: chunk.offset + HEADER,
        }
    }

    pub(super) fn part(&self) -> &str {
        &self.part
    }

    pub(super) fn offset(&self) -> u64 {
        (self.base + self.at) as u64
    }

    pub(super) fn rest(&self) -> &'a [u8] {
        &self.content[self.at..]
    }

    fn fault(&self, expected: impl Into<String>, found: impl Into<String>) -> Box<Fault> {
        Fault::new(self.part.clone(), self.offset(), expected, found, DAMAGED)
    }

    fn bytes(&mut self, count: u32, what: &str) -> Result<&'a [u8], Box<Fault>> {
        let rest = self.rest();
        match usize::try_from(count)
            .ok()
            .and_then(|count| rest.get(..count))
        {
            Some(bytes) => {
                self.at += bytes.len();
                Ok(bytes)
            }
            None => Err(self.fault(
                format!("{count} bytes of {what}"),
                format!("{} bytes left in the chunk", rest.len()),
            )),
        }
    }

    pub(super) fn u32(&mut self, what: &str) -> Result<u32, Box<Fault>> {
        let bytes = self.bytes(4, what)?;
        Ok(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
    }

    /// A number of items that take at least `least` bytes each.
    pub(super) fn count(&mut self, what: &str, least: usize) -> Result<u32, Box<Fault>> {
        let count = self.u32(what)?;
        let room = self.rest().len() / least;
        if count as usize > room {
            self.at -= 4;
            return Err(self.fault(
                format!("a number of {what} that fits the chunk, at most {room}"),
                count.to_string(),
            ));
        }
        Ok(count)
    }

    pub(super) fn dict(&mut self) -> Result<Dict<'a>, Box<Fault>> {
        let offset = self.offset();
        let count = self.count("attributes", 8)?;
        let mut entries = Vec::new();
        for _ in 0..count {
            let length = self.u32("the length of an attribute's name")?;
            let key = self.bytes(length, "an attribute's name")?;
            let length = self.u32("the length of an attribute's value")?;
            let value = self.bytes(length, "an attribute's value")?;
            entries.push((key, value));
        }
        Ok(Dict { entries, offset })
    }
}
