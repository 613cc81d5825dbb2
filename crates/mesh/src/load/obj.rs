//! Wavefront meshes; `mtl.rs` reads their material libraries.
//!
//! Supported: positions with their colours, normals, faces of any number of corners, and materials by name with their
//! textures. Lines, points and curves are skipped.

use std::collections::HashMap;
use std::path::Path;

use super::mtl::{self, Pictures};
use super::texture::{Parts, Textures};
use super::{Beside, Fault, Place, Problem, check_corners, polygon, text};
use crate::list::List;
use crate::texture::AlphaMode;
use crate::{ColorSpace, Material, MeshBuilder};

/// A corner without texture coordinate or normal, or a position that no triangle used yet.
const NONE: u32 = u32::MAX;

pub(super) fn read(
    bytes: &[u8],
    beside: &Beside<'_>,
    mtl_colors: ColorSpace,
    builder: &mut MeshBuilder,
) -> Result<(), Problem> {
    let text = text::decoded(bytes);
    let default = builder.material(Material::default_color());
    let folder = builder.folder();
    let mut file = File {
        positions: List::within(folder),
        texture_coordinates: List::within(folder),
        normals: List::within(folder),
        corners: List::within(folder),
        faces: List::within(folder),
        materials: vec![(default, Pictures::default())],
        ..File::default()
    };
    for (line, number) in text.split_inclusive('\n').zip(1..) {
        file.line(line, number, beside, mtl_colors, builder)?;
    }
    file.build(beside, builder)
}

#[derive(Default)]
struct File {
    /// Positions, and colours where they have any, as written.
    positions: List<([f64; 3], Option<[f32; 3]>)>,
    brightest: f64,
    /// Positions that have colours of ZBrush.
    painted: usize,
    texture_coordinates: List<[f64; 2]>,
    normals: List<[f64; 3]>,
    /// Numbers of position, texture coordinate and normal of each corner, from 0.
    corners: List<[u32; 3]>,
    faces: List<Face>,
    /// The builder's number and the pictures of each material. The first is that of faces without a material.
    materials: Vec<(u32, Pictures)>,
    by_name: HashMap<String, usize>,
    current: usize,
    libraries: usize,
    /// Lines, points, curves and surfaces.
    wires: u64,
}

#[derive(Clone, Copy)]
struct Face {
    /// The corners up to here, from the end of the face before.
    end: usize,
    material: usize,
    line: u64,
}

impl File {
    fn line(
        &mut self,
        line: &str,
        number: u64,
        beside: &Beside<'_>,
        mtl_colors: ColorSpace,
        builder: &mut MeshBuilder,
    ) -> Result<(), Problem> {
        let mut words = line.split_whitespace();
        let Some(keyword) = words.next() else {
            return Ok(());
        };
        let rest = || line.trim_start()[keyword.len()..].trim();
        // Behind numbers. Names may have such a mark.
        let mut words = words.take_while(|word| !word.starts_with('#'));
        let wrong = |part: &str, expected: &str| {
            let advice = "correct the line, or export the mesh again";
            let found = shown(line.trim_end_matches(['\n', '\r']));
            Fault::new(part, Place::Line(number), expected, found, advice)
        };
        match keyword {
            "v" => {
                let expected = "\"v x y z\", with or without a weight or a colour";
                let mut position =
                    numbers::<3>(&mut words).ok_or_else(|| wrong("vertex", expected))?;
                let more: Option<Vec<f64>> = words.map(|word| word.parse().ok()).collect();
                let mut color = None;
                match more.as_deref() {
                    Some([]) => {}
                    Some([0.0]) => Err(wrong("vertex", "a weight that is not 0"))?,
                    Some([weight]) => position = position.map(|c| c / weight),
                    Some(&[r, g, b]) => {
                        self.brightest = [r, g, b].into_iter().fold(self.brightest, f64::max);
                        color = Some([r, g, b].map(|c| c as f32));
                    }
                    _ => Err(wrong("vertex", "three numbers, or four, or six"))?,
                }
                self.positions.push((position, color));
            }
            // ZBrush: mask, red, green and blue of up to 64 positions, in two digits each.
            "#MRGB" => {
                for digits in rest().as_bytes().as_chunks::<8>().0 {
                    let digits = std::str::from_utf8(digits).unwrap_or_default();
                    let color = u32::from_str_radix(digits, 16).unwrap_or(u32::MAX);
                    let [_, color @ ..] = color.to_be_bytes();
                    if let Some((_, of)) = self.positions.get_mut(self.painted) {
                        *of = Some(color.map(|c| f32::from(c) / 255.0));
                    }
                    self.painted += 1;
                }
            }
            "vt" => {
                let wrong = || wrong("texture coordinate", "\"vt u v\"");
                let given = numbers(&mut words).ok_or_else(wrong)?;
                self.texture_coordinates.push(given);
            }
            "vn" => {
                let wrong = || wrong("normal", "\"vn x y z\"");
                self.normals.push(numbers(&mut words).ok_or_else(wrong)?);
            }
            "f" | "fo" => {
                let begin = self.corners.len();
                for word in words {
                    let corner = self.corner(word, number)?.ok_or_else(|| {
                        wrong("face", "\"f\" and corners such as 1, 1/2, 1//3 or 1/2/3")
                    })?;
                    self.corners.push(corner);
                }
                let corners = &self.corners[begin..];
                let place = Place::Line(number);
                check_corners(corners.len(), place)?;
                let mut forms = corners.iter().map(|corner| corner.map(|part| part == NONE));
                let first = forms.next();
                let is_whole = corners.len() > 2 && forms.all(|form| Some(form) == first);
                if !line.ends_with('\n') && !is_whole {
                    let expected =
                        "three or more corners of one form in the last line, which has no end";
                    let advice = "the file is cut short; export the mesh again";
                    return Err(Fault::new("face", place, expected, shown(line), advice).into());
                }
                self.faces.push(Face {
                    end: self.corners.len(),
                    material: self.current,
                    line: number,
                });
            }
            "usemtl" if rest().is_empty() => Err(wrong("usemtl", "a material's name"))?,
            "usemtl" => self.current = self.by_name.get(rest()).copied().unwrap_or(0),
            "l" | "p" | "curv" | "curv2" | "surf" => self.wires += 1,
            "mtllib" => self.library(rest(), beside, mtl_colors, builder),
            _ => {}
        }
        Ok(())
    }

    /// Reads a corner. A negative number counts back from the last element so far. `None` if it has another form.
    fn corner(&self, word: &str, line: u64) -> Result<Option<[u32; 3]>, Problem> {
        let mut parts = word.split('/');
        let mut corner = [NONE; 3];
        for (number, count) in corner.iter_mut().zip(self.counts()) {
            let Some(part) = parts.next().filter(|part| !part.is_empty()) else {
                continue;
            };
            let Ok(given) = part.parse::<i64>() else {
                return Ok(None);
            };
            let from_zero = given.checked_add(if given < 0 { count as i64 } else { -1 });
            let found = from_zero.and_then(|n| u32::try_from(n).ok());
            let found = found.filter(|&n| n != NONE);
            *number = found.ok_or_else(|| out_of_range(given, count, line))?;
        }
        let is_corner = corner[0] != NONE && parts.next().is_none();
        Ok(is_corner.then_some(corner))
    }

    fn counts(&self) -> [usize; 3] {
        let (uvs, normals) = (&self.texture_coordinates, &self.normals);
        [self.positions.len(), uvs.len(), normals.len()]
    }

    fn library(
        &mut self,
        name: &str,
        beside: &Beside<'_>,
        mtl_colors: ColorSpace,
        builder: &mut MeshBuilder,
    ) {
        self.libraries += 1;
        let library = match beside(name) {
            Ok(bytes) => mtl::read(&bytes, mtl_colors),
            Err(_) if name.contains(char::is_whitespace) => {
                for name in name.split_whitespace() {
                    self.library(name, beside, mtl_colors, builder);
                }
                return;
            }
            Err(error) => {
                return builder.warn(format!(
                    "the material library {name} cannot be read ({error}); its materials got the default colour"
                ));
            }
        };
        for warning in &library.warnings {
            builder.warn(format!("{name}: {warning}"));
        }
        let folder = Path::new(name).parent().unwrap_or(Path::new(""));
        let path = |name: String| folder.join(name).to_string_lossy().into_owned();
        for (material, pictures) in library.materials {
            let pictures = Pictures {
                color: pictures.color.map(path),
                opacity: pictures.opacity.map(path),
                place: pictures.place,
            };
            self.by_name
                .insert(material.name.clone(), self.materials.len());
            self.materials.push((builder.material(material), pictures));
        }
    }

    /// Passes the triangles of all faces to the builder, and the positions in the order of their first use.
    fn build(self, beside: &Beside<'_>, builder: &mut MeshBuilder) -> Result<(), Problem> {
        let mut numbers = List::within(builder.folder());
        numbers.pad(self.positions.len(), NONE);
        if !builder.has_room() {
            // Lists lack items, which the caller reports.
            return Ok(());
        }
        let mut textures = Textures::default();
        let (mut without, mut without_uvs) = (0, 0);
        let mut begin = 0;
        let mut is_textured: Vec<Option<bool>> = vec![None; self.materials.len()];
        let mut white = None;
        // A little more than 1 is a rounding error, or very bright.
        let is_in_bytes = self.brightest >= 2.0;
        if is_in_bytes {
            builder
                .warn("the colours of vertices are taken as 0 to 255, because some are 2 or more");
        }
        let scale = if is_in_bytes { 1.0 } else { 255.0 };
        let in_bytes = |color: [f32; 3]| color.map(|c| (c * scale + 0.5) as u8);
        for face in self.faces.iter() {
            let corners = &self.corners[begin..face.end];
            begin = face.end;
            for corner in corners {
                for (&number, count) in corner.iter().zip(self.counts()) {
                    if number != NONE && number as usize >= count {
                        return Err(out_of_range(i64::from(number) + 1, count, face.line));
                    }
                }
            }
            let (material, pictures) = &self.materials[face.material];
            let mut material = *material;
            // Pictures of materials that no face has are not read.
            let is_textured = *is_textured[face.material].get_or_insert_with(|| {
                let parts = Parts {
                    color: pictures.color.as_deref(),
                    opacity: pictures.opacity.as_deref(),
                    mode: AlphaMode::Blend,
                    wrap: [pictures.place.wrap; 2],
                };
                let texture = textures.get(parts, beside);
                let texture = texture.map(|texture| builder.set_texture(material, texture));
                texture.is_some()
            });
            let is_colored = |corner: &[u32; 3]| self.positions[corner[0] as usize].1.is_some();
            let is_plain = face.material == 0 && !corners.iter().all(is_colored);
            if face.material == 0 && !is_plain {
                material =
                    *white.get_or_insert_with(|| builder.material(Material::vertex_colors()));
            }
            let at = |corner: usize| self.positions[corners[corner][0] as usize].0.into();
            for triangle in polygon::triangles(corners.len(), &at) {
                let triangle = triangle.map(|corner| corners[corner]);
                let positions = triangle.map(|[position, ..]| {
                    let number = &mut numbers[position as usize];
                    if *number == NONE {
                        let (position, color) = self.positions[position as usize];
                        *number = match color {
                            Some(color) => builder.colored_position(position, in_bytes(color)),
                            None => builder.position(position),
                        };
                    }
                    *number
                });
                let normals = all(triangle, 2, &self.normals);
                let normals = normals.map(|normals| normals.map(|n| n.map(|c| c as f32)));
                let places = all(triangle, 1, &self.texture_coordinates).filter(|_| is_textured);
                let mtl::Place { scale, offset, .. } = pictures.place;
                let moved =
                    |[u, v]: [f64; 2]| [u * scale[0] + offset[0], 1.0 - (v * scale[1] + offset[1])];
                let places = places.map(|places| places.map(moved));
                without_uvs += usize::from(is_textured && places.is_none());
                without += usize::from(is_plain);
                // In range: the builder gave the numbers.
                let _ = builder.textured_triangle(positions, normals, material, places);
            }
        }
        textures.tell(builder);
        if without_uvs > 0 {
            builder.warn(format!(
                "{without_uvs} triangles have a texture, but no texture coordinates"
            ));
        }
        if self.wires > 0 {
            builder.warn(format!(
                "{} lines, points and curves (l, p, curv, surf) were passed over",
                self.wires
            ));
        }
        if without > 0 && self.libraries > 0 {
            builder.warn(format!(
                "{without} triangles have no material that was found; they got the default colour"
            ));
        }
        Ok(())
    }
}

fn all<T: Copy>(corners: [[u32; 3]; 3], part: usize, list: &[T]) -> Option<[T; 3]> {
    let of = |corner: [u32; 3]| list.get(corner[part] as usize).copied();
    let [a, b, c] = corners.map(of);
    Some([a?, b?, c?])
}

fn numbers<'t, const N: usize>(words: &mut impl Iterator<Item = &'t str>) -> Option<[f64; N]> {
    let mut numbers = [0.0; N];
    for number in &mut numbers {
        *number = words.next()?.parse().ok()?;
    }
    Some(numbers)
}

fn out_of_range(index: i64, count: usize, line: u64) -> Problem {
    Fault::new(
        "face",
        Place::Line(line),
        format!("a corner from 1 to {count}, counted up to there"),
        index.to_string(),
        "the file is cut short or damaged; export the mesh again",
    )
    .into()
}

fn shown(line: &str) -> String {
    let begin: String = line.chars().take(40).collect();
    let more = if begin.len() < line.len() { "..." } else { "" };
    format!("{:?}", begin + more)
}
