//! Stereolithography meshes, by the crate `stl_io`.
//!
//! Binary and ASCII are distinguished by the length: a file of 84 + 50 n bytes whose
//! header counts n triangles is binary, whatever it begins with. Normals in
//! the file are not used: they are often wrong, and say nothing that the
//! corners do not.

use std::io::Cursor;

use shiftvox::scene::is_binary_stl;

use super::{Fault, Place, Problem};
use crate::{Material, MeshBuilder};

/// Bytes before the first triangle of a binary file.
const HEADER: u64 = 84;
/// Bytes of a triangle of a binary file.
const TRIANGLE: u64 = 50;

/// Reads a file that is in memory.
pub(super) fn read(bytes: &[u8], builder: &mut MeshBuilder) -> Result<(), Problem> {
    builder.material(Material::default_color());
    let is_binary = is_binary_stl(bytes, bytes.len() as u64);
    if !is_binary && !bytes.starts_with(b"solid") {
        return Err(cut_binary(bytes).into());
    }
    let refused = |error: std::io::Error| ascii_fault(&error);
    if is_binary {
        // Read past what `stl_io` would take for the word "solid".
        let mut body = bytes.to_vec();
        body[..80].fill(0);
        let mut cursor = Cursor::new(body);
        take(
            stl_io::create_stl_reader(&mut cursor).map_err(refused)?,
            builder,
        )
    } else {
        let text = normalized(bytes);
        let mut cursor = Cursor::new(text.as_bytes());
        take(
            stl_io::create_stl_reader(&mut cursor).map_err(refused)?,
            builder,
        )
    }
}

/// Adds the triangles of a reader; equal corners become one position.
fn take(
    triangles: Box<dyn stl_io::TriangleIterator<Item = std::io::Result<stl_io::Triangle>> + '_>,
    builder: &mut MeshBuilder,
) -> Result<(), Problem> {
    let mut numbers = std::collections::HashMap::new();
    for (count, triangle) in triangles.enumerate() {
        let triangle = triangle.map_err(|error| {
            Fault::new(
                format!("triangle {}", count + 1),
                Place::Whole,
                "\"facet normal x y z\", \"outer loop\", three \"vertex x y z\", \"endloop\", \"endfacet\", \
                 and \"endsolid\" at the end",
                error.to_string(),
                "the file is cut short or damaged; export the mesh again",
            )
        })?;
        let corners = triangle.vertices.map(|vertex| {
            // 0 and -0 are one place.
            let position = vertex.0.map(|c: f32| c + 0.0);
            *numbers
                .entry(position.map(f32::to_bits))
                .or_insert_with(|| builder.position(position))
        });
        // In range: they were all added just now.
        let _ = builder.triangle(corners, None, 0);
    }
    Ok(())
}

/// The text in the form that `stl_io` requires: `solid ` at the beginning, and one `endsolid`.
fn normalized(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    let text = text.trim_start();
    let (first, rest) = text.split_once('\n').unwrap_or((text, ""));
    let name = first.trim_start_matches("solid").trim();
    // Words are small in the crate; some exporters write them large.
    format!("solid {name}\n{}", rest.to_ascii_lowercase())
}

fn ascii_fault(error: &std::io::Error) -> Problem {
    Fault::new(
        "file",
        Place::Whole,
        "an STL mesh, text or binary",
        error.to_string(),
        "export the mesh again",
    )
    .into()
}

fn cut_binary(bytes: &[u8]) -> Box<Fault> {
    let count = bytes
        .get(80..84)
        .and_then(|count| count.try_into().ok())
        .map(u32::from_le_bytes);
    match count {
        Some(count) => Fault::new(
            "header",
            Place::Byte(80),
            format!(
                "{} bytes in all for the {count} triangles that it counts",
                HEADER + TRIANGLE * u64::from(count)
            ),
            format!("{} bytes", bytes.len()),
            "the file is cut short or damaged; export the mesh again",
        ),
        None => Fault::new(
            "header",
            Place::Byte(0),
            format!("{HEADER} bytes"),
            format!("{} bytes", bytes.len()),
            "the file is cut short; export the mesh again",
        ),
    }
}
