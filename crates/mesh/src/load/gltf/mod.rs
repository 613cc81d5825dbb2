//! glTF 2.0, by a small reader of our own over `serde_json`.
//!
//! Supported: nodes of the default scene with their transforms. Triangles, strips and fans with positions, normals,
//! first vertex colours and indices, also sparse ones, and instances. Base colours of materials with their textures. Buffers may be in the file, in a
//! `data:` address or in a file of the same folder. Not supported: other textures, skins, morph targets and animations,
//! which are skipped with a warning. Compressed meshes are refused.

mod accessor;
mod document;
mod picture;
mod scene;

use std::borrow::Cow;
use std::collections::HashMap;
use std::rc::Rc;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD_NO_PAD;

use super::{Beside, Fault, Place, Problem};
use crate::MeshBuilder;
use document::Document;

const BROKEN: &str = "the file is damaged or cut short; export the mesh again";

const EXPORT: &str = "export as glTF 2.0";

const JSON: usize = 0x4e4f_534a;
const BIN: usize = 0x004e_4942;

pub(super) fn read_json(
    bytes: &[u8],
    beside: &Beside<'_>,
    builder: &mut MeshBuilder,
) -> Result<(), Problem> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    read_document(bytes, 0, None, beside, builder)
}

pub(super) fn read_binary(
    bytes: &[u8],
    beside: &Beside<'_>,
    builder: &mut MeshBuilder,
) -> Result<(), Problem> {
    let wrong = |part: &str, offset: usize, expected: &str, found: usize| -> Problem {
        let (place, found) = (Place::Byte(offset as u64), found.to_string());
        Fault::new(part, place, expected, found, BROKEN).into()
    };
    let word = |offset: usize| -> Option<usize> {
        let word = bytes.get(offset..offset.checked_add(4)?)?;
        Some(u32::from_le_bytes(word.try_into().ok()?) as usize)
    };
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(wrong("header", 0, "12 bytes", bytes.len()));
    };
    if version != 2 {
        let (place, found) = (Place::Byte(4), version.to_string());
        return Err(Fault::new("header", place, "version 2", found, EXPORT).into());
    }
    let Some(bytes) = bytes.get(..length) else {
        let expected = format!("{length} bytes in all, as it says");
        return Err(wrong("header", 8, &expected, bytes.len()));
    };
    let mut at = 12;
    let (mut json, mut binary) = (None, None);
    while let (Some(size), Some(kind)) = (word(at), word(at + 4)) {
        let begin = at + 8;
        let end = begin.saturating_add(size);
        let Some(content) = bytes.get(begin..end) else {
            let found = bytes.len().saturating_sub(begin);
            let expected = format!("{size} bytes of content");
            return Err(wrong("chunk", at, &expected, found));
        };
        match kind {
            JSON if json.is_none() => {
                // Some programs fill up with zeros in place of spaces.
                let end = content.iter().rposition(|&byte| byte != 0);
                json = Some((&content[..end.map_or(0, |last| last + 1)], begin));
            }
            BIN if binary.is_none() => binary = Some(content),
            _ => {}
        }
        at = end;
    }
    let (json, offset) = json.ok_or_else(|| wrong("file", 12, "a JSON chunk", 0))?;
    read_document(json, offset as u64, binary, beside, builder)
}

fn read_document(
    json: &[u8],
    offset: u64,
    binary: Option<&[u8]>,
    beside: &Beside<'_>,
    builder: &mut MeshBuilder,
) -> Result<(), Problem> {
    let document: Document = serde_json::from_slice(json).map_err(|error| {
        let place = match offset {
            0 => Place::Line(error.line() as u64),
            _ => Place::Byte(offset),
        };
        // In version 1 lists are objects.
        let document: serde_json::Value = serde_json::from_slice(json).unwrap_or_default();
        let version = document["asset"]["version"].as_str().unwrap_or("2");
        let advice = if version.starts_with('1') {
            EXPORT
        } else {
            BROKEN
        };
        Fault::new("JSON", place, "glTF 2.0", error.to_string(), advice)
    })?;
    document.check()?;
    let buffers = Buffers::read(&document, binary, beside)?;
    scene::Reader::new(&document, &buffers, beside, json.len()).read(builder)
}

struct Buffers<'f> {
    by_number: Vec<Rc<Cow<'f, [u8]>>>,
    bytes: usize,
}

impl<'f> Buffers<'f> {
    fn read(
        document: &Document,
        binary: Option<&'f [u8]>,
        beside: &Beside<'_>,
    ) -> Result<Self, Problem> {
        let (mut by_number, mut total) = (Vec::new(), 0);
        let mut known: HashMap<&str, Rc<Cow<'f, [u8]>>> = HashMap::new();
        for (number, buffer) in document.buffers.iter().enumerate() {
            let uri = buffer.uri.as_deref().unwrap_or_default();
            let bytes = match (known.get(uri), &buffer.uri, binary) {
                (Some(bytes), ..) => bytes.clone(),
                (None, None, Some(binary)) if number == 0 => {
                    total += binary.len();
                    Rc::new(binary.into())
                }
                (None, None, _) => return Err(document.no_data("buffer", number, "content")),
                (None, Some(_), _) => {
                    let bytes = fetch(uri, number, beside)?;
                    total += bytes.len();
                    known.entry(uri).or_insert(Rc::new(bytes.into())).clone()
                }
            };
            if (bytes.len() as u64) < buffer.byte_length {
                let expected = format!("{} bytes", buffer.byte_length);
                let found = bytes.len().to_string();
                return Err(broken("buffer", number, &expected, &found));
            }
            by_number.push(bytes);
        }
        Ok(Self {
            by_number,
            bytes: total,
        })
    }
}

fn decoded(uri: &str) -> Option<Vec<u8>> {
    let (_, text) = uri.strip_prefix("data:")?.split_once(";base64,")?;
    let text = text.trim_end_matches('=');
    STANDARD_NO_PAD.decode(text).ok()
}

fn fetch(uri: &str, number: usize, beside: &Beside<'_>) -> Result<Vec<u8>, Problem> {
    if uri.starts_with("data:") {
        let other = || broken("buffer", number, "data in base64", "other data");
        return decoded(uri).ok_or_else(other);
    }
    let name = unescaped(uri);
    beside(&name).map_err(|error| {
        let expected = format!("the file {name:?} beside the mesh");
        let advice = "put it into the same folder, or export as .glb";
        fault_of("buffer", number, &expected, &error.to_string(), advice)
    })
}

fn unescaped(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, after @ ..] = rest {
        let hex = after.get(..2).filter(|_| *first == b'%');
        let hex = hex.and_then(|hex| std::str::from_utf8(hex).ok());
        let byte = hex.and_then(|hex| u8::from_str_radix(hex, 16).ok());
        bytes.push(byte.unwrap_or(*first));
        rest = if byte.is_some() { &after[2..] } else { after };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

fn broken(part: &str, number: usize, expected: &str, found: &str) -> Problem {
    fault_of(part, number, expected, found, BROKEN)
}

fn fault_of(part: &str, number: usize, expected: &str, found: &str, advice: &str) -> Problem {
    let part = format!("{part} {number}");
    Fault::new(part, Place::Whole, expected, found, advice).into()
}
