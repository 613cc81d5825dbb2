//! Wavefront meshes, by the crate `tobj`; material libraries by `mtl.rs`.
//!
//! Read: positions with their colours, normals, faces of any number of corners
//! (cut into a fan from the first, so they should be convex), materials by
//! name with their textures. Lines, points, curves are passed over.

use std::cell::{Cell, RefCell};
use std::io::{self, BufRead, Read};
use std::path::Path;

use tobj::LoadError;

use super::texture::Textures;
use super::{Beside, Fault, LoadOptions, MOST_CORNERS, Place, Problem, check_corners, mtl, text};
use crate::{Material, MeshBuilder};

/// Reads a file that is in memory.
pub(super) fn read(
    bytes: &[u8],
    beside: &dyn Beside,
    options: &LoadOptions,
    builder: &mut MeshBuilder,
) -> Result<(), Problem> {
    let text = text::decoded(bytes);
    refuse_cut_face(&text)?;
    refuse_far_back(&text)?;
    refuse_huge_faces(&text)?;
    let line = Cell::new(0);
    let mut reader = Counted {
        rest: text.as_bytes(),
        lines: &line,
    };
    let libraries = RefCell::new(Libraries::default());
    let how = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..tobj::LoadOptions::default()
    };
    let loaded = tobj::load_obj_buf(&mut reader, &how, |path| {
        libraries.borrow_mut().load(path, beside, options)
    });
    let (models, _) = loaded.map_err(|error| understand(error, line.get(), &text))?;
    let libraries = libraries.into_inner();
    let default = builder.material(Material::default_color());
    let first = default + 1;
    for material in libraries.materials {
        builder.material(material);
    }
    for warning in libraries.warnings {
        builder.warn(warning);
    }
    let mut without = 0;
    let mut textures = Textures::default();
    for model in &models {
        let mesh = &model.mesh;
        let base = builder.positions() as u32;
        let has_colors = mesh.vertex_color.len() == mesh.positions.len();
        for (number, position) in mesh.positions.as_chunks::<3>().0.iter().enumerate() {
            if has_colors && !mesh.vertex_color.is_empty() {
                let at = 3 * number;
                let color = [0, 1, 2].map(|k| (mesh.vertex_color[at + k] * 255.0 + 0.5) as u8);
                builder.colored_position(*position, color);
            } else {
                builder.position(*position);
            }
        }
        let material = mesh.material_id.map(|id| first + id as u32);
        let texture = mesh
            .material_id
            .and_then(|id| libraries.textures.get(id)?.as_ref())
            .and_then(|name| textures.get(name, || beside.read(name)));
        let uvs = mesh.texcoords.as_chunks::<2>().0;
        let uv_indices = mesh.texcoord_indices.as_chunks::<3>().0;
        let has_normals = mesh.normal_indices.len() == mesh.indices.len();
        let normals = mesh.normals.as_chunks::<3>().0;
        let normal_indices = mesh.normal_indices.as_chunks::<3>().0;
        for (number, corners) in mesh.indices.as_chunks::<3>().0.iter().enumerate() {
            let given = (has_normals && !normals.is_empty())
                .then(|| normal_indices.get(number))
                .flatten()
                .map(|at| at.map(|i| normals.get(i as usize).copied().unwrap_or_default()))
                .map(|normals| normals.map(|normal| normal.map(|c| c as f32)));
            let tint = texture.as_ref().and_then(|texture| {
                let at = uv_indices.get(number)?;
                let corner = |i: u32| uvs.get(i as usize).copied();
                texture.mean(
                    [corner(at[0])?, corner(at[1])?, corner(at[2])?].map(|[u, v]| [u, 1.0 - v]),
                )
            });
            without += usize::from(material.is_none());
            builder
                .textured_triangle(
                    corners.map(|i| base.saturating_add(i)),
                    given,
                    material.unwrap_or(default),
                    tint,
                )
                .map_err(|bad| out_of_range(i64::from(bad.index), bad.positions, 0))?;
        }
    }
    textures.tell(builder);
    if without > 0 && first as usize + 1 > 1 && libraries.named > 0 {
        builder.warn(format!(
            "{without} triangles have no material that was found; they got the default colour"
        ));
    }
    Ok(())
}

/// Material libraries that a file named.
#[derive(Debug, Default)]
struct Libraries {
    materials: Vec<Material>,
    /// By material, the picture that its colour is multiplied by, as the mesh's folder has it.
    textures: Vec<Option<String>>,
    warnings: Vec<String>,
    named: usize,
}

impl Libraries {
    /// Loads one for `tobj`, which needs the numbers of names.
    fn load(
        &mut self,
        path: &Path,
        beside: &dyn Beside,
        options: &LoadOptions,
    ) -> tobj::MTLLoadResult {
        self.named += 1;
        let name = path.to_string_lossy();
        let library = match beside.read(&name) {
            Ok(bytes) => mtl::read(&bytes, options),
            Err(error) => {
                self.warnings.push(format!(
                    "the material library {name} cannot be read ({error}); its materials got the default colour"
                ));
                return Err(LoadError::OpenFileFailed);
            }
        };
        // Names of pictures are relative to the library.
        let folder = path.parent().unwrap_or(Path::new(""));
        let beside_library = |name: String| folder.join(name).to_string_lossy().into_owned();
        let textures = library.textures.into_iter();
        self.textures
            .extend(textures.map(|name| name.map(beside_library)));
        if let Some(line) = library.odd_line {
            self.warnings.push(format!(
                "{name}: line {line} is not understood and was passed over"
            ));
        }
        let named = |material: &Material| tobj::Material {
            name: material.name.clone(),
            ..tobj::Material::default()
        };
        let for_tobj = library.materials.iter().map(named).collect();
        let numbers = library.materials.iter().enumerate();
        let numbers = numbers
            .map(|(number, m)| (m.name.clone(), number))
            .collect();
        self.materials.extend(library.materials);
        Ok((for_tobj, numbers))
    }
}

/// Refuses a file whose last line has no end and is part of a face only. `tobj` would read
/// it as a face of other corners, or leave it out.
fn refuse_cut_face(text: &str) -> Result<(), Problem> {
    let (before, last) = text.rsplit_once('\n').unwrap_or(("", text));
    let mut words = last.split_whitespace();
    if words.next() != Some("f") {
        return Ok(());
    }
    // The parts that a corner has: position, texture coordinate, normal.
    let parts = |corner: &str| corner.split('/').map(str::is_empty).collect::<Vec<bool>>();
    let corners: Vec<Vec<bool>> = words.map(parts).collect();
    let is_whole = corners.len() >= 3 && corners.iter().all(|parts| *parts == corners[0]);
    if is_whole {
        return Ok(());
    }
    let line = before.lines().count() as u64 + 1;
    Err(Fault::new(
        "face",
        Place::Line(line),
        "three or more corners of one form in the last line, which has no end",
        shown(last),
        "the file is cut short; export the mesh again",
    )
    .into())
}

/// Refuses faces of so many corners that their fan would be slivers without end.
fn refuse_huge_faces(text: &str) -> Result<(), Problem> {
    for (number, line) in text.lines().enumerate() {
        // A corner takes two letters.
        if line.len() / 2 > MOST_CORNERS && line.trim_start().starts_with("f ") {
            check_corners(
                line.split_whitespace().count() - 1,
                Place::Line(number as u64 + 1),
            )?;
        }
    }
    Ok(())
}

/// An error of `tobj`, with its place and a remedy.
fn understand(error: LoadError, line: u64, text: &str) -> Problem {
    let (part, expected) = match error {
        LoadError::PositionParseError => (
            "vertex",
            "\"v x y z\", with or without a weight or a colour",
        ),
        LoadError::ColorParseError => ("vertex", "three numbers, or four, or six"),
        LoadError::ScalingByZeroError => ("vertex", "a weight that is not 0"),
        LoadError::NormalParseError => ("normal", "\"vn x y z\""),
        LoadError::TexcoordParseError => ("texture coordinate", "\"vt u v\""),
        LoadError::FaceParseError => ("face", "\"f\" and corners such as 1, 1/2, 1//3 or 1/2/3"),
        LoadError::MaterialParseError => ("usemtl", "a material's name"),
        LoadError::FaceColorOutOfBounds => {
            return Fault::new(
                "vertices",
                Place::Whole,
                "a colour for every vertex of a face or for none",
                "some with and some without",
                "export the mesh again with colours for all vertices, or for none",
            )
            .into();
        }
        LoadError::FaceVertexOutOfBounds
        | LoadError::FaceNormalOutOfBounds
        | LoadError::FaceTexCoordOutOfBounds
        | LoadError::InvalidPolygon => return bad_face(error, line, text),
        _ => ("file", "Wavefront text"),
    };
    let found = text.lines().nth(line.saturating_sub(1) as usize);
    Fault::new(
        part,
        Place::Line(line),
        expected,
        shown(found.unwrap_or_default()),
        "correct the line, or export the mesh again",
    )
    .into()
}

/// Looks for the face of which `tobj`, at the end of its group, says that it is wrong.
fn bad_face(error: LoadError, line: u64, text: &str) -> Problem {
    let which = match error {
        LoadError::FaceNormalOutOfBounds => 2,
        LoadError::FaceTexCoordOutOfBounds => 1,
        _ => 0,
    };
    // Definitions below the face do not count, as in `tobj`.
    let is_bad =
        |part, index: i64, count| part == which && (index == 0 || index > count || index < -count);
    if let Some(corner) = find_corner(text, |_| true, is_bad) {
        return corner;
    }
    Fault::new(
        "face",
        Place::Line(line),
        "corners that exist",
        error.to_string(),
        "export the mesh again",
    )
    .into()
}

/// Refuses a corner that counts back beyond the first: `tobj` would compute
/// with a negative number that it takes for a large one.
fn refuse_far_back(text: &str) -> Result<(), Problem> {
    let is_bad = |_, index: i64, count: i64| index < -count;
    find_corner(text, |line| line.contains('-'), is_bad).map_or(Ok(()), Err)
}

/// The first corner that `is_bad`, of faces and lines that are `of_interest`. Its arguments are the part (0 position, 1
/// texture coordinate, 2 normal), the index, and the number defined so far.
fn find_corner(
    text: &str,
    of_interest: impl Fn(&str) -> bool,
    is_bad: impl Fn(usize, i64, i64) -> bool,
) -> Option<Problem> {
    let mut counts = [0i64; 3];
    for (number, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => counts[0] += 1,
            Some("vt") => counts[1] += 1,
            Some("vn") => counts[2] += 1,
            Some("f" | "l") if of_interest(line) => {
                for word in words {
                    for (part, (index, count)) in word.split('/').zip(counts).enumerate() {
                        let Ok(index) = index.parse::<i64>() else {
                            continue;
                        };
                        if is_bad(part, index, count) {
                            return Some(out_of_range(index, count as usize, number as u64 + 1));
                        }
                    }
                }
            }
            _ => {}
        }
    }
    None
}

fn out_of_range(index: i64, positions: usize, line: u64) -> Problem {
    let place = if line == 0 {
        Place::Whole
    } else {
        Place::Line(line)
    };
    Fault::new(
        "face",
        place,
        format!("a corner from 1 to {positions}, counted up to there"),
        index.to_string(),
        "the file is cut short or damaged; export the mesh again",
    )
    .into()
}

/// At most 40 characters of a line, quoted.
fn shown(line: &str) -> String {
    let begin: String = line.chars().take(40).collect();
    let more = if line.chars().nth(40).is_some() {
        "..."
    } else {
        ""
    };
    format!("{:?}", format!("{begin}{more}"))
}

/// Counts the lines that were read.
struct Counted<'a> {
    rest: &'a [u8],
    lines: &'a Cell<u64>,
}

impl Read for Counted<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.rest.len().min(into.len());
        into[..count].copy_from_slice(&self.rest[..count]);
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Counted<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        Ok(self.rest)
    }

    fn consume(&mut self, count: usize) {
        let (used, rest) = self.rest.split_at(count.min(self.rest.len()));
        let ends = used.iter().filter(|byte| **byte == b'\n').count() as u64;
        let last = u64::from(rest.is_empty() && used.last().is_some_and(|byte| *byte != b'\n'));
        self.lines.set(self.lines.get() + ends + last);
        self.rest = rest;
    }
}
