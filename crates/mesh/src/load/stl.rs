//! Stereolithography meshes.
//!
//! Binary and ASCII are distinguished by the length: a file of 84 + 50 n bytes whose header counts n triangles is
//! binary, whatever it begins with. Normals in the file are not used: they are often wrong, and follow from the corners.

use std::collections::HashMap;

use shiftvox::scene::{is_binary_stl, is_text_stl};

use super::{Fault, Place, Problem};
use crate::{Material, MeshBuilder};

const HEADER: usize = 84;
const TRIANGLE: usize = 50;

type Corners = [[f32; 3]; 3];

pub(super) fn read(bytes: &[u8], builder: &mut MeshBuilder) -> Result<(), Problem> {
    builder.material(Material::default_color());
    let mut numbers = HashMap::new();
    // In files, equal positions take less than a table of them would take in memory.
    let is_joined = builder.folder().is_none();
    let mut add = |corners: Corners| {
        let corners = corners.map(|corner| {
            // 0 and -0 are one place.
            let position = corner.map(|c| c + 0.0);
            if !is_joined {
                return builder.position(position);
            }
            *numbers
                .entry(position.map(f32::to_bits))
                .or_insert_with(|| builder.position(position))
        });
        let _ = builder.triangle(corners, None, 0);
    };
    if is_binary_stl(bytes, bytes.len() as u64) {
        let triangles = bytes[HEADER..].as_chunks::<TRIANGLE>().0;
        for triangle in triangles {
            // The normal comes first.
            let coordinates = triangle[12..48].as_chunks::<4>().0;
            let coordinate = |k: usize| f32::from_le_bytes(coordinates[k]);
            add([0, 3, 6].map(|i| [i, i + 1, i + 2].map(coordinate)));
        }
        // Programs do not agree on what these two bytes are.
        if triangles.iter().any(|triangle| triangle[48..] != [0, 0]) {
            builder.warn("attributes of triangles, which may be colours, were passed over");
        }
        return Ok(());
    }
    // Headers of binary files may begin as texts do, which have no zeros.
    if !is_text_stl(bytes) || bytes.iter().take(HEADER + TRIANGLE).any(|&byte| byte == 0) {
        return Err(cut_binary(bytes).into());
    }
    // Not as text in whole, which might be a copy.
    let mut lines = bytes.trim_ascii_start().split(|&byte| byte == b'\n');
    lines.next();
    // The names of solids are not read, nor are comments.
    let lines = lines.map(|line| match words(line).next() {
        Some(word) if is(word, "solid") || is(word, "endsolid") || word[0] == b'#' => word,
        _ => line,
    });
    let mut words = lines.flat_map(words);
    for number in 1u64.. {
        match facet(&mut words) {
            Ok(Some(corners)) => add(corners),
            Ok(None) => break,
            Err(found) => {
                return Err(Fault::new(
                    format!("triangle {number}"),
                    Place::Whole,
                    "\"facet normal x y z\", \"outer loop\", three \"vertex x y z\", \"endloop\", \"endfacet\", \
                     and \"endsolid\" at the end",
                    found.map_or("the end of the file".to_owned(), |word| {
                        format!("{:?}", String::from_utf8_lossy(word))
                    }),
                    "the file is cut short or damaged; export the mesh again",
                )
                .into());
            }
        }
    }
    Ok(())
}

fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    let words = line.split(u8::is_ascii_whitespace);
    words.filter(|word| !word.is_empty())
}

fn is(word: &[u8], expected: &str) -> bool {
    word.eq_ignore_ascii_case(expected.as_bytes())
}

/// The words of a facet. `#` is a number, and `*`, of the normal, anything: some programs write `-nan(ind)`.
const FACET: &str =
    "facet normal * * * outer loop vertex # # # vertex # # # vertex # # # endloop endfacet";

/// The corners of the next facet, or `None` at the end of the last solid. An error is the word that is wrong.
fn facet<'t>(
    words: &mut impl Iterator<Item = &'t [u8]>,
) -> Result<Option<Corners>, Option<&'t [u8]>> {
    let mut numbers = Vec::with_capacity(9);
    for (place, expected) in FACET.split(' ').enumerate() {
        let mut word = words.next();
        while let Some(end) = word.filter(|_| place == 0) {
            if is(end, "endsolid") {
                // Some programs write facets between solids.
                word = words.find(|word| is(word, "solid") || is(word, expected));
                if word.is_none() {
                    return Ok(None);
                }
            } else if is(end, "solid") {
                word = words.next();
            } else {
                break;
            }
        }
        match word {
            Some(word) if expected == "#" => {
                let number = std::str::from_utf8(word).ok();
                let number = number.and_then(|number| number.parse::<f32>().ok());
                numbers.push(number.ok_or(Some(word))?);
            }
            Some(word) if is(word, expected) || expected == "*" => {}
            other => return Err(other),
        }
    }
    Ok(numbers.as_chunks::<3>().0.try_into().ok())
}

fn cut_binary(bytes: &[u8]) -> Box<Fault> {
    let count = bytes
        .get(80..HEADER)
        .and_then(|count| count.try_into().ok());
    let (place, expected) = match count.map(u32::from_le_bytes) {
        Some(count) => {
            let all = HEADER as u64 + TRIANGLE as u64 * u64::from(count);
            let expected = format!("{all} bytes in all for the {count} triangles that it counts");
            (80, expected)
        }
        None => (0, format!("{HEADER} bytes")),
    };
    let found = format!("{} bytes", bytes.len());
    let advice = "the file is cut short or damaged; export the mesh again";
    Fault::new("header", Place::Byte(place), expected, found, advice)
}
