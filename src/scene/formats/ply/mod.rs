//! PLY clouds whose positions are voxel indices: one voxel a vertex.
//!
//! Read as a stream, element by element: memory depends neither on the file nor on the counts in its header. The crate
//! `ply-rs-bw` holds whole elements in memory, so only the tests use it, for comparison.

mod header;
mod numbers;
mod source;
mod write;

use std::io::BufRead;

use glam::DVec3;

use crate::graph::PackedNormal;
use crate::scene::emit::Emitter;
use crate::scene::fault::{Fault, Problem, printable};
use crate::scene::input::Input;
use crate::scene::{ReadOptions, SceneInfo};
use header::{Element, Property};
use numbers::{Encoding, Scalar};
use source::{Number, Source, decode, parse_number};
pub use write::write_ply;

/// Longest line of an ASCII body, bytes.
const MAX_LINE: usize = 1 << 20;

const CUT: &str = "the file is cut short; export or copy it again";

/// The use of a vertex property.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Role {
    Position(usize),
    Color(usize),
    Normal(usize),
}

/// The used numbers of one vertex.
#[derive(Debug, Clone, Copy)]
struct Vertex {
    position: [Number; 3],
    color: [Number; 3],
    normal: [Number; 3],
}

impl Vertex {
    fn put(&mut self, role: Role, number: Number) {
        match role {
            Role::Position(axis) => self.position[axis] = number,
            Role::Color(channel) => self.color[channel] = number,
            Role::Normal(axis) => self.normal[axis] = number,
        }
    }
}

/// The meaning of the vertex element's properties.
struct Layout<'h> {
    properties: &'h [Property],
    /// The use of each property; `None` if it is skipped.
    roles: Vec<Option<Role>>,
    /// The used properties, with type and first byte in a binary vertex.
    wanted: Vec<(Role, Scalar, usize)>,
    /// Bytes of a binary vertex; `None` if it contains lists, so that sizes differ.
    stride: Option<usize>,
    has_color: bool,
    has_normal: bool,
}

/// Whether the header of a PLY file declares faces, so that it is a mesh. `false` for a damaged header, whose fault
/// [`read`] reports.
pub(in crate::scene) fn has_faces<R: BufRead>(reader: &mut R) -> bool {
    header::read(&mut Source::new(reader)).is_ok_and(|header| header.has_faces())
}

/// Passes on the voxels of a PLY cloud.
pub(super) fn read(
    input: &mut Input<'_>,
    options: &ReadOptions,
    emitter: &mut Emitter<'_>,
) -> Result<SceneInfo, Problem> {
    let mut source = Source::new(&mut input.reader);
    let header = header::read(&mut source)?;
    let is_named = |element: &&Element, name: &[u8]| element.name == name;
    let Some(vertices) = header.elements.iter().find(|e| is_named(e, b"vertex")) else {
        return Err(Fault::new(
            "header",
            0,
            "an element \"vertex\"",
            "none",
            "this PLY holds no points; a cloud of voxel indices has an element vertex",
        )
        .into());
    };
    let layout = understand(vertices, source.offset())?;
    let mut line = Vec::new();
    for element in header.elements.iter().take_while(|e| e.name != b"vertex") {
        skip(&mut source, element, header.encoding, &mut line)?;
    }
    let info = SceneInfo {
        models: 1,
        instances: 1,
        stored_voxels: vertices.count,
        has_colors: layout.has_color,
        has_normals: layout.has_normal,
        ..SceneInfo::default()
    };
    for number in 0..vertices.count {
        let begin = source.offset();
        let zero = [Number::Whole(0); 3];
        let mut vertex = Vertex {
            position: zero,
            color: zero,
            normal: zero,
        };
        match header.encoding {
            Encoding::Ascii => read_line(&mut source, &layout, number, &mut line, &mut vertex)?,
            encoding => read_binary(
                &mut source,
                &layout,
                number,
                encoding,
                &mut line,
                &mut vertex,
            )?,
        }
        hand_on(&vertex, &layout, (number, begin), options, emitter)?;
    }
    Ok(info)
}

/// Finds the used properties of the vertices.
fn understand(vertices: &Element, offset: u64) -> Result<Layout<'_>, Box<Fault>> {
    let role = |name: &[u8]| {
        Some(match name {
            b"x" => Role::Position(0),
            b"y" => Role::Position(1),
            b"z" => Role::Position(2),
            b"red" | b"r" | b"diffuse_red" => Role::Color(0),
            b"green" | b"g" | b"diffuse_green" => Role::Color(1),
            b"blue" | b"b" | b"diffuse_blue" => Role::Color(2),
            b"nx" => Role::Normal(0),
            b"ny" => Role::Normal(1),
            b"nz" => Role::Normal(2),
            _ => return None,
        })
    };
    let roles: Vec<Option<Role>> = vertices
        .properties
        .iter()
        .map(|p| {
            if p.list.is_none() {
                role(&p.name)
            } else {
                None
            }
        })
        .collect();
    let mut wanted = Vec::new();
    let mut stride = 0;
    for (property, role) in vertices.properties.iter().zip(&roles) {
        wanted.extend(role.map(|role| (role, property.scalar, stride)));
        stride += property.scalar.size();
    }
    let has_lists = vertices.properties.iter().any(|p| p.list.is_some());
    let has = |kind: fn(usize) -> Role| (0..3).all(|i| roles.contains(&Some(kind(i))));
    if !has(Role::Position) {
        return Err(Fault::new(
            "header, element vertex",
            offset,
            "the properties x, y and z",
            "not all of them",
            "export the cloud with the voxels' indices as x, y and z",
        ));
    }
    Ok(Layout {
        properties: &vertices.properties,
        wanted,
        stride: (!has_lists).then_some(stride),
        has_color: has(Role::Color),
        has_normal: has(Role::Normal),
        roles,
    })
}

/// Skips an element that comes before the vertices.
fn skip<R: BufRead>(
    source: &mut Source<'_, R>,
    element: &Element,
    encoding: Encoding,
    line: &mut Vec<u8>,
) -> Result<(), Problem> {
    let part = || format!("element {}", element.name.escape_ascii());
    let cut = |offset| Fault::new(part(), offset, "more of them", "the end of the file", CUT);
    if encoding == Encoding::Ascii {
        for _ in 0..element.count {
            if !source.line(line, MAX_LINE, &part())? {
                return Err(cut(source.offset()).into());
            }
        }
        return Ok(());
    }
    if element.properties.iter().all(|p| p.list.is_none()) {
        let stride: u64 = element
            .properties
            .iter()
            .map(|p| p.scalar.size() as u64)
            .sum();
        if !source.skip(element.count.saturating_mul(stride))? {
            return Err(cut(source.offset()).into());
        }
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            if skip_or_read(source, property, encoding, &part)?.is_none() {
                return Err(cut(source.offset()).into());
            }
        }
    }
    Ok(())
}

/// Reads a binary number, or skips a list and returns 0; `None` if the file ends first.
fn skip_or_read<R: BufRead>(
    source: &mut Source<'_, R>,
    property: &Property,
    encoding: Encoding,
    part: &dyn Fn() -> String,
) -> Result<Option<Number>, Problem> {
    let Some(count) = property.list else {
        return source.number(property.scalar, encoding);
    };
    let offset = source.offset();
    let Some(count) = source.number(count, encoding)? else {
        return Ok(None);
    };
    let Some(count) = count.whole().and_then(|count| u64::try_from(count).ok()) else {
        return Err(Fault::new(
            part(),
            offset,
            "a list's length that is not negative",
            count.to_string(),
            "the file is damaged; export it again",
        )
        .into());
    };
    let bytes = count.saturating_mul(property.scalar.size() as u64);
    Ok(source.skip(bytes)?.then_some(Number::Whole(0)))
}

fn vertex_part(number: u64) -> String {
    format!("vertex {number}")
}

fn cut_at(number: u64, offset: u64) -> Box<Fault> {
    Fault::new(
        vertex_part(number),
        offset,
        "as many vertices as the header says",
        "the end of the file",
        CUT,
    )
}

/// Reads one vertex of a binary body.
fn read_binary<R: BufRead>(
    source: &mut Source<'_, R>,
    layout: &Layout<'_>,
    number: u64,
    encoding: Encoding,
    scratch: &mut Vec<u8>,
    vertex: &mut Vertex,
) -> Result<(), Problem> {
    if let Some(stride) = layout.stride {
        let put_all = |bytes: &[u8]| {
            for &(role, scalar, at) in &layout.wanted {
                vertex.put(
                    role,
                    decode(scalar, encoding, bytes.get(at..).unwrap_or(&[])),
                );
            }
        };
        return match source.bytes(stride, scratch, put_all)? {
            Some(()) => Ok(()),
            None => Err(cut_at(number, source.offset()).into()),
        };
    }
    for (property, role) in layout.properties.iter().zip(&layout.roles) {
        let part = || vertex_part(number);
        let Some(value) = skip_or_read(source, property, encoding, &part)? else {
            return Err(cut_at(number, source.offset()).into());
        };
        if let Some(role) = role {
            vertex.put(*role, value);
        }
    }
    Ok(())
}

/// Reads one vertex of an ASCII body: one line that is not blank.
fn read_line<R: BufRead>(
    source: &mut Source<'_, R>,
    layout: &Layout<'_>,
    number: u64,
    line: &mut Vec<u8>,
    vertex: &mut Vertex,
) -> Result<(), Problem> {
    let begin = loop {
        let begin = source.offset();
        if !source.line(line, MAX_LINE, "body")? {
            return Err(cut_at(number, begin).into());
        }
        if !line.trim_ascii().is_empty() {
            break begin;
        }
    };
    let mut words = line
        .split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty());
    let mut next = |property: &Property| {
        let word = words.next();
        word.and_then(parse_number).ok_or_else(|| {
            Fault::new(
                vertex_part(number),
                begin,
                format!("a number for property {}", property.name.escape_ascii()),
                word.map_or("the end of the line".to_owned(), printable),
                "every vertex needs a line with a number for every property of the header",
            )
        })
    };
    for (property, role) in layout.properties.iter().zip(&layout.roles) {
        let value = next(property)?;
        if property.list.is_some() {
            // A list's length that is no whole number ends the line early, and that is an error.
            for _ in 0..value.whole().unwrap_or(i64::MAX) {
                next(property)?;
            }
        } else if let Some(role) = role {
            vertex.put(*role, value);
        }
    }
    if let Some(word) = words.next() {
        return Err(Fault::new(
            vertex_part(number),
            begin,
            format!(
                "one number for each of {} properties",
                layout.properties.len()
            ),
            format!("{} after them", printable(word)),
            "every vertex needs a line of its own",
        )
        .into());
    }
    Ok(())
}

/// Turns a vertex into a voxel.
#[inline]
fn hand_on(
    vertex: &Vertex,
    layout: &Layout<'_>,
    (number, offset): (u64, u64),
    options: &ReadOptions,
    emitter: &mut Emitter<'_>,
) -> Result<(), Problem> {
    let mut index = [0; 3];
    for axis in 0..3 {
        let value = vertex.position[axis];
        let Some(whole) = value.whole() else {
            return Err(not_an_index(number, axis, offset, value).into());
        };
        index[axis] = whole;
    }
    let mut color = options.default_color;
    if layout.has_color {
        for channel in 0..3 {
            let value = vertex.color[channel];
            let Some(byte) = to_channel(value) else {
                return Err(not_a_channel(number, channel, offset, value).into());
            };
            color[channel] = byte;
        }
    }
    // A normal of length zero says that there is none.
    let normal = layout
        .has_normal
        .then(|| PackedNormal::encode(DVec3::from_array(vertex.normal.map(Number::real))))
        .filter(|normal| !normal.is_none());
    emitter.voxel(index, color, normal, || (vertex_part(number), offset))
}

#[cold]
fn not_an_index(number: u64, axis: usize, offset: u64, value: Number) -> Box<Fault> {
    Fault::new(
        format!("vertex {number}, property {}", ["x", "y", "z"][axis]),
        offset,
        "a whole number, the voxel's index",
        value.to_string(),
        "only clouds whose positions are voxel indices can be read; divide the positions by the voxel's size and round them down first",
    )
}

#[cold]
fn not_a_channel(number: u64, channel: usize, offset: u64, value: Number) -> Box<Fault> {
    Fault::new(
        format!(
            "vertex {number}, property {}",
            ["red", "green", "blue"][channel]
        ),
        offset,
        "a whole number from 0 to 255, or a real one from 0 to 1",
        value.to_string(),
        "export the colours as uchar",
    )
}

/// A colour channel as a byte. A real number is a share of 1, rounded to nearest.
fn to_channel(value: Number) -> Option<u8> {
    match value {
        Number::Whole(n) => u8::try_from(n).ok(),
        // From 0.5 to 255.5 after scaling, so the cast truncates within a byte.
        Number::Real(x) if (0.0..=1.0).contains(&x) => Some((x * 255.0 + 0.5) as u8),
        Number::Real(_) => None,
    }
}
