//! PLY meshes, by the crate `ply-rs-bw`, one element at a time.
//!
//! Read: `x y z`, `nx ny nz`, `red green blue` of vertices (with `r`, `g`, `b`
//! and `diffuse_*`), `vertex_indices` or `vertex_index` of faces (cut into a
//! fan). Everything else is passed over. The header's counts are not believed:
//! an element takes at least a byte, so more of them than bytes are a lie.

use std::io::{Cursor, Read as _};

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Property, PropertyAccess, PropertyAccessResult};

use super::{LoadOptions, check_corners};
use crate::error::{MeshError, MeshFault, Place};
use crate::{Material, MeshBuilder};

/// One vertex or face, with what matters of it.
#[derive(Debug, Default)]
struct Element {
    position: [f64; 3],
    normal: [f32; 3],
    color: [u8; 3],
    corners: Vec<i64>,
}

impl PropertyAccess for Element {
    fn new() -> Self {
        Self {
            color: [255; 3],
            ..Self::default()
        }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let number = property.to_f32_lossy();
        match name {
            "x" | "y" | "z" | "nx" | "ny" | "nz" => {
                let Some(number) = number else {
                    return PropertyAccessResult::UnsupportedType;
                };
                // A double keeps all of its digits.
                let exact = match property {
                    Property::Double(exact) => exact,
                    Property::Int(whole) => f64::from(whole),
                    Property::UInt(whole) => f64::from(whole),
                    _ => f64::from(number),
                };
                match name.as_bytes() {
                    [b'n', axis] => self.normal[usize::from(axis - b'x')] = number,
                    [axis, ..] => self.position[usize::from(axis - b'x')] = exact,
                    [] => return PropertyAccessResult::Ignored,
                }
            }
            "red" | "r" | "diffuse_red" => return self.colored(0, &property),
            "green" | "g" | "diffuse_green" => return self.colored(1, &property),
            "blue" | "b" | "diffuse_blue" => return self.colored(2, &property),
            "vertex_indices" | "vertex_index" => match corners(property) {
                Some(corners) => self.corners = corners,
                None => return PropertyAccessResult::UnsupportedType,
            },
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

impl Element {
    fn colored(&mut self, channel: usize, property: &Property) -> PropertyAccessResult {
        let byte = match property {
            // As the rest of the program reads them: 16 bits are the full range.
            Property::UShort(value) => Some((value >> 8) as u8),
            other => other.to_u8_color_lossy(),
        };
        match byte {
            Some(byte) => {
                self.color[channel] = byte;
                PropertyAccessResult::Set
            }
            None => PropertyAccessResult::UnsupportedType,
        }
    }
}

fn corners(property: Property) -> Option<Vec<i64>> {
    fn wide<T: Into<i64>>(list: Vec<T>) -> Vec<i64> {
        list.into_iter().map(Into::into).collect()
    }
    Some(match property {
        Property::ListChar(list) => wide(list),
        Property::ListUChar(list) => wide(list),
        Property::ListShort(list) => wide(list),
        Property::ListUShort(list) => wide(list),
        Property::ListInt(list) => wide(list),
        Property::ListUInt(list) => wide(list),
        _ => return None,
    })
}

/// Reads a file that is in memory.
pub(super) fn read(
    bytes: &[u8],
    options: &LoadOptions,
    builder: &mut MeshBuilder,
) -> Result<(), MeshError> {
    let parser = Parser::<Element>::new();
    let mut reader = Reader::new(Cursor::new(bytes));
    let header = parser.read_header(&mut reader).map_err(|error| {
        MeshFault::new(
            "header",
            error
                .line()
                .map_or(Place::Whole, |line| Place::Line(line as u64)),
            "a PLY 1.0 header",
            error.to_string(),
            "the header is damaged; export the mesh again",
        )
    })?;
    let begin = reader.into_inner().position().min(bytes.len() as u64);
    let mut body = Body {
        rest: &bytes[begin as usize..],
        length: bytes.len(),
        encoding: header.encoding,
        parser,
    };
    builder.material(Material::of_srgb("no material", options.default_color));
    let white = builder.material(Material::of_srgb("vertex colours", [255; 3]));
    let vertices = header.elements.get("vertex");
    let has = |names: &[&str]| {
        vertices.is_some_and(|def| names.iter().any(|n| def.properties.contains_key(*n)))
    };
    if !["x", "y", "z"].iter().all(|axis| has(&[*axis])) {
        return Err(MeshFault::new(
            "header",
            Place::Byte(0),
            "an element \"vertex\" with the properties x, y and z",
            "not all of them",
            "export the mesh with its vertices",
        )
        .into());
    }
    let has_color = has(&["red", "r", "diffuse_red"]);
    let has_normal = ["nx", "ny", "nz"].iter().all(|axis| has(&[*axis]));
    let material = if has_color { white } else { 0 };
    let mut normals: Vec<[f32; 3]> = Vec::new();
    for (name, def) in &header.elements {
        body.check_count(name, def)?;
        for number in 0..def.count {
            let begin = body.offset();
            let element = body.element(name, def, number)?;
            match name.as_str() {
                "vertex" => {
                    if has_color {
                        builder.colored_position(element.position, element.color);
                    } else {
                        builder.position(element.position);
                    }
                    if has_normal {
                        normals.push(element.normal);
                    }
                }
                "face" => {
                    check_corners(element.corners.len(), Place::Byte(begin))?;
                    add_face(&element.corners, &normals, material, builder)
                        .map_err(|index| bad_corner(number, begin, index, builder.positions()))?;
                }
                _ => {}
            }
        }
    }
    Ok(())
}

/// Adds a polygon as a fan; the corner that does not exist, if one does not.
fn add_face(
    corners: &[i64],
    normals: &[[f32; 3]],
    material: u32,
    builder: &mut MeshBuilder,
) -> Result<(), i64> {
    let positions = builder.positions() as i64;
    if let Some(&bad) = corners.iter().find(|i| !(0..positions).contains(*i)) {
        return Err(bad);
    }
    let [first, rest @ ..] = corners else {
        return Ok(());
    };
    for pair in rest.windows(2) {
        // Below 2^32: positions are numbered so.
        let triangle = [*first, pair[0], pair[1]].map(|i| i as u32);
        let given = (!normals.is_empty())
            .then(|| triangle.map(|i| normals.get(i as usize).copied().unwrap_or_default()));
        let _ = builder.triangle(triangle, given, material);
    }
    Ok(())
}

fn bad_corner(face: usize, offset: u64, index: i64, positions: usize) -> MeshError {
    MeshFault::new(
        format!("face {face}"),
        Place::Byte(offset),
        format!("corners from 0 to {}", positions as i64 - 1),
        index.to_string(),
        "the file is damaged, or its faces come before its vertices; export the mesh again",
    )
    .into()
}

/// What follows the header.
struct Body<'a> {
    rest: &'a [u8],
    length: usize,
    encoding: Encoding,
    parser: Parser<Element>,
}

impl Body<'_> {
    fn offset(&self) -> u64 {
        (self.length - self.rest.len()) as u64
    }

    /// Refuses a count that the file cannot hold, so that it is not counted up to.
    fn check_count(&self, name: &str, def: &ElementDef) -> Result<(), MeshError> {
        if def.count <= self.rest.len() && (def.count == 0 || !def.properties.is_empty()) {
            return Ok(());
        }
        Err(MeshFault::new(
            format!("element {name}"),
            Place::Byte(self.offset()),
            format!("{} of them, each of at least a byte", def.count),
            format!(
                "{} bytes and {} properties",
                self.rest.len(),
                def.properties.len()
            ),
            "the file is cut short or its header is wrong; export the mesh again",
        )
        .into())
    }

    /// Reads the next element.
    fn element(
        &mut self,
        name: &str,
        def: &ElementDef,
        number: usize,
    ) -> Result<Element, MeshError> {
        let begin = self.offset();
        let read = match self.encoding {
            Encoding::Ascii => {
                let line = self.line();
                self.parser.read_ascii_element(&line, def)
            }
            Encoding::BinaryLittleEndian => {
                self.parser.read_little_endian_element(&mut self.rest, def)
            }
            Encoding::BinaryBigEndian => self.parser.read_big_endian_element(&mut self.rest, def),
        };
        read.map_err(|error| {
            MeshFault::new(
                format!("{name} {number}"),
                Place::Byte(begin),
                "an element as the header describes it",
                error.to_string().trim().to_owned(),
                "the file is cut short or damaged; export the mesh again",
            )
            .into()
        })
    }

    /// The next line that is not blank, with its end; empty at the end of the file.
    fn line(&mut self) -> String {
        loop {
            let end = self.rest.iter().position(|byte| *byte == b'\n');
            let length = end.map_or(self.rest.len(), |end| end + 1);
            let mut line = Vec::new();
            // Reading from memory does not fail.
            let _ = (&mut self.rest).take(length as u64).read_to_end(&mut line);
            if length == 0 || !line.trim_ascii().is_empty() {
                return String::from_utf8_lossy(&line).into_owned();
            }
        }
    }
}
