//! glTF 2.0, by a small reader of our own over `serde_json`.
//!
//! Supported: nodes of the default scene with their transforms. Triangles, strips and fans with positions, normals,
//! first vertex colours and indices. Base colours of materials with their textures. Buffers may be in the file, in a
//! `data:` address or in a file of the same folder. Not supported: other textures, skins, morph targets and animations,
//! which are skipped with a warning. Sparse accessors and compressed meshes are refused.

mod accessor;
mod document;
mod picture;
mod scene;

use std::collections::HashMap;

use base64::Engine as _;
use base64::engine::general_purpose::{STANDARD, STANDARD_NO_PAD};

use super::{Beside, Fault, Place, Problem};
use crate::MeshBuilder;
use document::Document;

const BROKEN: &str = "the file is damaged or cut short; export the mesh again";

const JSON: u32 = 0x4e4f_534a;
const BIN: u32 = 0x004e_4942;

pub(super) fn read_json(
    bytes: &[u8],
    beside: &dyn Beside,
    builder: &mut MeshBuilder,
) -> Result<(), Problem> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    read_document(bytes, 0, None, beside, builder)
}

pub(super) fn read_binary(
    bytes: &[u8],
    beside: &dyn Beside,
    builder: &mut MeshBuilder,
) -> Result<(), Problem> {
    let wrong = |part: &str, offset: usize, expected: String, found: String| -> Problem {
        Fault::new(part, Place::Byte(offset as u64), expected, found, BROKEN).into()
    };
    let word = |offset: usize| -> Option<u32> {
        let word = bytes.get(offset..offset.checked_add(4)?)?;
        Some(u32::from_le_bytes(word.try_into().ok()?))
    };
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        let found = bytes.len().to_string();
        return Err(wrong("header", 0, "12 bytes".into(), found));
    };
    if version != 2 {
        return Err(wrong("header", 4, "version 2".into(), version.to_string()));
    }
    if u64::from(length) > bytes.len() as u64 {
        let expected = format!("{length} bytes in all, as it says");
        return Err(wrong("header", 8, expected, bytes.len().to_string()));
    }
    let bytes = &bytes[..length as usize];
    let mut at = 12usize;
    let (mut json, mut binary) = (None, None);
    while let (Some(size), Some(kind)) = (word(at), word(at + 4)) {
        let begin = at + 8;
        let end = begin.saturating_add(size as usize);
        let Some(content) = bytes.get(begin..end) else {
            let expected = format!("{size} bytes of content");
            let found = bytes.len().saturating_sub(begin).to_string();
            return Err(wrong("chunk", at, expected, found));
        };
        match kind {
            JSON if json.is_none() => json = Some((content, begin)),
            BIN if binary.is_none() => binary = Some(content),
            _ => {}
        }
        at = end;
    }
    let Some((json, offset)) = json else {
        return Err(wrong("file", 12, "a JSON chunk".into(), "none".into()));
    };
    read_document(json, offset as u64, binary, beside, builder)
}

fn read_document(
    json: &[u8],
    offset: u64,
    binary: Option<&[u8]>,
    beside: &dyn Beside,
    builder: &mut MeshBuilder,
) -> Result<(), Problem> {
    let document: Document = serde_json::from_slice(json).map_err(|error| {
        let place = match offset {
            0 => Place::Line(error.line() as u64),
            _ => Place::Byte(offset),
        };
        Fault::new("JSON", place, "glTF 2.0", error.to_string(), BROKEN)
    })?;
    document.check()?;
    let buffers = Buffers::read(&document, binary, beside)?;
    scene::Reader::new(&document, &buffers, beside, json.len()).read(builder)
}

/// The bytes of all buffers. One address is read once.
struct Buffers {
    distinct: Vec<Vec<u8>>,
    /// By number.
    of: Vec<usize>,
}

impl Buffers {
    fn read(
        document: &Document,
        binary: Option<&[u8]>,
        beside: &dyn Beside,
    ) -> Result<Self, Problem> {
        let (mut distinct, mut of) = (Vec::new(), Vec::new());
        let mut known: HashMap<Option<&str>, usize> = HashMap::new();
        for (number, buffer) in document.buffers.iter().enumerate() {
            let uri = buffer.uri.as_deref();
            let at = match known.get(&uri) {
                Some(&at) if uri.is_some() => at,
                _ => {
                    let bytes = match (uri, binary) {
                        (None, Some(binary)) if number == 0 => binary.to_vec(),
                        (None, _) => {
                            return Err(broken("buffer", number, "content", "none"));
                        }
                        (Some(uri), _) => fetch(uri, number, beside)?,
                    };
                    distinct.push(bytes);
                    known.insert(uri, distinct.len() - 1);
                    distinct.len() - 1
                }
            };
            let bytes = distinct[at].len() as u64;
            if bytes < buffer.byte_length {
                let expected = format!("{} bytes", buffer.byte_length);
                return Err(broken("buffer", number, &expected, &bytes.to_string()));
            }
            of.push(at);
        }
        Ok(Self { distinct, of })
    }

    fn get(&self, number: usize) -> Option<&[u8]> {
        self.of.get(number).map(|&at| &self.distinct[at][..])
    }

    /// Bytes of all, each once.
    fn len(&self) -> usize {
        self.distinct.iter().map(Vec::len).sum()
    }
}

/// The bytes of a `data:` address, where it is one in base64.
fn decoded(data: &str) -> Option<Vec<u8>> {
    let (_, text) = data.split_once(";base64,")?;
    let text = text.trim_end_matches('=');
    let decoded = STANDARD_NO_PAD.decode(text);
    decoded.or_else(|_| STANDARD.decode(text)).ok()
}

fn fetch(uri: &str, number: usize, beside: &dyn Beside) -> Result<Vec<u8>, Problem> {
    if let Some(data) = uri.strip_prefix("data:") {
        return decoded(data)
            .ok_or_else(|| broken("buffer", number, "data in base64", "other data"));
    }
    let name = unescaped(uri);
    beside.read(&name).map_err(|error| {
        fault_of(
            "buffer",
            number,
            &format!("the file {name:?} beside the mesh"),
            &error.to_string(),
            "put it into the same folder, or export as .glb",
        )
    })
}

/// An address with its `%20`s resolved.
fn unescaped(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, after @ ..] = rest {
        let hex = after.get(..2).and_then(|h| std::str::from_utf8(h).ok());
        match hex.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(byte) if *first == b'%' => {
                bytes.push(byte);
                rest = &after[2..];
            }
            _ => {
                bytes.push(*first);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// A fault at a numbered part of a document that is damaged.
fn broken(part: &str, number: usize, expected: &str, found: &str) -> Problem {
    fault_of(part, number, expected, found, BROKEN)
}

fn fault_of(part: &str, number: usize, expected: &str, found: &str, advice: &str) -> Problem {
    let part = format!("{part} {number}");
    Fault::new(part, Place::Whole, expected, found, advice).into()
}
