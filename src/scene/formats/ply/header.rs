//! The header of a PLY file: its format, elements and properties.

use super::numbers::{Encoding, Scalar};
use super::source::Source;
use crate::scene::fault::{Fault, Problem, printable};
use std::io::BufRead;

/// Longest line of a header, bytes.
const MAX_LINE: usize = 1 << 12;

const BROKEN: &str = "the header is damaged or not PLY 1.0; export the cloud again";

/// One property of an element.
#[derive(Debug, Clone)]
pub(super) struct Property {
    /// Its name.
    pub name: Vec<u8>,
    /// Type of its numbers.
    pub scalar: Scalar,
    /// Type of the number of numbers, where it is a list.
    pub list: Option<Scalar>,
}

/// One kind of element.
#[derive(Debug, Clone)]
pub(super) struct Element {
    /// Its name.
    pub name: Vec<u8>,
    /// The stated number of them.
    pub count: u64,
    /// Their properties.
    pub properties: Vec<Property>,
}

/// A whole header.
#[derive(Debug)]
pub(super) struct Header {
    /// Encoding of the body.
    pub encoding: Encoding,
    /// The elements in the order of the body.
    pub elements: Vec<Element>,
}

impl Header {
    /// Whether there are faces.
    pub(super) fn has_faces(&self) -> bool {
        let faces = |element: &Element| element.name == b"face" && element.count > 0;
        self.elements.iter().any(faces)
    }
}

/// Reads a header up to and with `end_header`.
pub(super) fn read<R: BufRead>(source: &mut Source<'_, R>) -> Result<Header, Problem> {
    let mut line = Vec::new();
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut first = true;
    loop {
        let offset = source.offset();
        if !source.line(&mut line, MAX_LINE, "header")? {
            return Err(fault(offset, "the line \"end_header\"", "the end of the file").into());
        }
        let words: Vec<&[u8]> = line
            .split(u8::is_ascii_whitespace)
            .filter(|word| !word.is_empty())
            .collect();
        let wrong = |expected: &str| fault(offset, expected, printable(&line));
        if first {
            if words != [b"ply"] {
                return Err(wrong("the line \"ply\"").into());
            }
            first = false;
            continue;
        }
        match words[..] {
            [b"comment" | b"obj_info", ..] | [] => {}
            [b"end_header"] => break,
            [b"format", format, b"1.0"] => {
                encoding = Some(match format {
                    b"ascii" => Encoding::Ascii,
                    b"binary_little_endian" => Encoding::Little,
                    b"binary_big_endian" => Encoding::Big,
                    _ => {
                        return Err(wrong(
                            "format ascii, binary_little_endian or binary_big_endian",
                        )
                        .into());
                    }
                });
            }
            [b"element", name, count] => elements.push(Element {
                name: name.to_vec(),
                count: std::str::from_utf8(count)
                    .ok()
                    .and_then(|count| count.parse().ok())
                    .ok_or_else(|| wrong("\"element NAME COUNT\" with a whole number"))?,
                properties: Vec::new(),
            }),
            [b"property", ..] => {
                let property = property(&words).ok_or_else(|| {
                    wrong("\"property TYPE NAME\" or \"property list TYPE TYPE NAME\", types char to double")
                })?;
                let element = elements
                    .last_mut()
                    .ok_or_else(|| wrong("a line \"element\" before the first property"))?;
                element.properties.push(property);
            }
            _ => {
                return Err(wrong("format, element, property, comment or end_header").into());
            }
        }
    }
    let encoding = encoding.ok_or_else(|| {
        fault(
            source.offset(),
            "a line \"format ... 1.0\" in the header",
            "none",
        )
    })?;
    Ok(Header { encoding, elements })
}

fn property(words: &[&[u8]]) -> Option<Property> {
    let (scalar, list, name) = match words {
        [_, b"list", count, scalar, name] => {
            let count = Scalar::from_name(count).filter(|count| count.is_integer())?;
            (scalar, Some(count), name)
        }
        [_, scalar, name] => (scalar, None, name),
        _ => return None,
    };
    Some(Property {
        name: name.to_vec(),
        scalar: Scalar::from_name(scalar)?,
        list,
    })
}

fn fault(offset: u64, expected: &str, found: impl Into<String>) -> Box<Fault> {
    Fault::new("header", offset, expected, found, BROKEN)
}
