//! The header of a PLY file: its format, elements and properties.

use std::io::BufRead;

use super::source::Source;
use super::{Encoding, Scalar};
use crate::scene::fault::{Fault, Problem, printable};

const MAX_LINE: usize = 1 << 12;

const BROKEN: &str = "the header is damaged or not PLY 1.0; export the file again";

#[derive(Debug, Clone)]
pub struct Property {
    pub name: Vec<u8>,
    pub scalar: Scalar,
    /// Type of the number of numbers, where it is a list.
    pub(super) list: Option<Scalar>,
}

#[derive(Debug, Clone)]
pub struct Element {
    pub name: Vec<u8>,
    pub count: u64,
    pub properties: Vec<Property>,
}

#[derive(Debug)]
pub struct Header {
    pub(super) encoding: Encoding,
    pub elements: Vec<Element>,
    /// Names of pictures in comments, as MeshLab writes them.
    pub textures: Vec<String>,
}

impl Header {
    pub fn element(&self, name: &str) -> Option<&Element> {
        let mut elements = self.elements.iter();
        elements.find(|element| element.name == name.as_bytes())
    }
}

impl Element {
    pub fn scalar(&self, names: &[&str]) -> Option<usize> {
        self.position(|p| p.list.is_none() && names.iter().any(|n| p.name == n.as_bytes()))
    }

    pub fn list(&self, names: &[&str]) -> Option<usize> {
        self.position(|p| p.list.is_some() && names.iter().any(|n| p.name == n.as_bytes()))
    }

    fn position(&self, is_meant: impl Fn(&Property) -> bool) -> Option<usize> {
        self.properties.iter().position(is_meant)
    }

    pub fn positions(&self, offset: u64) -> Result<[usize; 3], Box<Fault>> {
        self.triple([&["x"], &["y"], &["z"]]).ok_or_else(|| {
            Fault::new(
                "header, element vertex",
                offset,
                "the properties x, y and z",
                "not all of them",
                "export the file with the positions of its vertices",
            )
        })
    }

    pub fn normals(&self) -> Option<[usize; 3]> {
        self.triple([&["nx"], &["ny"], &["nz"]])
    }

    pub fn colors(&self) -> Option<[usize; 3]> {
        self.triple([
            &["red", "r", "diffuse_red"],
            &["green", "g", "diffuse_green"],
            &["blue", "b", "diffuse_blue"],
        ])
    }

    pub fn texture_coordinates(&self) -> Option<[usize; 2]> {
        let u = self.scalar(&["texture_u", "s", "u"])?;
        Some([u, self.scalar(&["texture_v", "t", "v"])?])
    }

    fn triple(&self, names: [&[&str]; 3]) -> Option<[usize; 3]> {
        let [a, b, c] = names.map(|names| self.scalar(names));
        Some([a?, b?, c?])
    }
}

pub(super) fn read<R: BufRead>(source: &mut Source<'_, R>) -> Result<Header, Problem> {
    let mut line = Vec::new();
    let mut encoding = None;
    let (mut elements, mut textures): (Vec<Element>, Vec<String>) = Default::default();
    let mut first = true;
    loop {
        let offset = source.offset;
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
            [b"comment", b"TextureFile", _, ..] => {
                let line = String::from_utf8_lossy(&line);
                let name = line.split_once("TextureFile").unwrap_or_default().1;
                textures.push(name.trim().to_owned());
            }
            [b"comment" | b"obj_info", ..] | [] => {}
            [b"end_header"] => break,
            [b"format", format, b"1.0"] => {
                encoding = Some(match format {
                    b"ascii" => Encoding::Ascii,
                    b"binary_little_endian" => Encoding::Binary { big_endian: false },
                    b"binary_big_endian" => Encoding::Binary { big_endian: true },
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
            source.offset,
            "a line \"format ... 1.0\" in the header",
            "none",
        )
    })?;
    Ok(Header {
        encoding,
        elements,
        textures,
    })
}

fn property(words: &[&[u8]]) -> Option<Property> {
    let (scalar, list, name) = match words {
        [_, b"list", count, scalar, name] => {
            let count = Scalar::from_ply(count).filter(|count| count.is_integer())?;
            (scalar, Some(count), name)
        }
        [_, scalar, name] => (scalar, None, name),
        _ => return None,
    };
    Some(Property {
        name: name.to_vec(),
        scalar: Scalar::from_ply(scalar)?,
        list,
    })
}

fn fault(offset: u64, expected: &str, found: impl Into<String>) -> Box<Fault> {
    Fault::new("header", offset, expected, found, BROKEN)
}
