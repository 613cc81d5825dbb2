//! PLY meshes.
//!
//! Read: `x y z`, `nx ny nz`, `red green blue` of vertices (with `r`, `g`, `b` and `diffuse_*`), `vertex_indices` or
//! `vertex_index` of faces and of `tristrips`, `red green blue` of faces. Textures as MeshLab writes them: comments
//! `TextureFile`, `texcoord` and `texnumber` of faces, `texture_u texture_v` of vertices (with `s t` and `u v`).
//! Everything else is skipped.

use std::collections::HashMap;

use shiftvox::scene::numbers::{Number, Scalar};
use shiftvox::scene::ply::{Element, PlyFile, Row};

use super::texture::{Parts, Textures};
use super::{Beside, Fault, Place, Problem, check_corners, polygon};
use crate::list::List;
use crate::texture::{AlphaMode, Wrap};
use crate::{Material, MeshBuilder};

/// Of each vertex, or nothing.
struct Vertices {
    normals: List<[f32; 3]>,
    /// Upwards in the picture, as in the file.
    uvs: List<[f64; 2]>,
}

pub(super) fn read(
    mut bytes: &[u8],
    beside: &Beside<'_>,
    builder: &mut MeshBuilder,
) -> Result<(), Problem> {
    let mut file = PlyFile::open(&mut bytes)?;
    let elements = file.header.elements.clone();
    let Some(vertices) = file.header.element("vertex") else {
        let advice = "export the mesh with its vertices";
        return Err(Fault::new("header", 0, "an element \"vertex\"", "none", advice).into());
    };
    let positions = vertices.positions(file.offset())?;
    let normals_at = vertices.normals();
    let uvs_at = vertices.texture_coordinates();
    let default = builder.material(Material::default_color());
    let white = builder.material(Material::vertex_colors());
    let has_uvs = uvs_at.is_some() || elements.iter().any(|e| e.list(&["texcoord"]).is_some());
    let mut textured = textured(&file.header.textures, beside, builder);
    if !has_uvs && !textured.is_empty() {
        builder.warn("the texture was passed over: the file has no texture coordinates");
        textured.clear();
    }
    let is_textured = textured.iter().any(Option::is_some);
    // Scanners write the same colours twice.
    if is_textured && elements.iter().any(|element| element.colors().is_some()) {
        builder.warn("colours were passed over: the file has a texture");
    }
    let colors = vertices.colors().filter(|_| !is_textured);
    let material = if colors.is_some() { white } else { default };
    let mut kept = Vertices {
        normals: List::within(builder.folder()),
        uvs: List::within(builder.folder()),
    };
    let (mut without, mut has_opacities) = (0, false);
    // Materials of faces with colours.
    let mut of_color: HashMap<[u8; 3], u32> = HashMap::new();
    // A second element of this name has other properties.
    let mut is_first = true;
    for element in &elements {
        let corners = element.list(&["vertex_indices", "vertex_index"]);
        let opacity = element.scalar(&["alpha"]);
        let is_clear = |row: &Row<'_>, at: usize| {
            let full = match element.properties[at].scalar {
                Scalar::F32 | Scalar::F64 => 1.0,
                Scalar::U16 => 65535.0,
                _ => 255.0,
            };
            row.values[at].real() < full
        };
        match (&element.name[..], corners) {
            (b"vertex", _) if std::mem::take(&mut is_first) => {
                file.rows(element, [None; 2], |row| {
                    has_opacities |= opacity.is_some_and(|at| is_clear(&row, at));
                    let position = positions.map(|k| row.values[k].real());
                    match colors {
                        None => builder.position(position),
                        Some(at) => {
                            let color = color("vertex", &row, element, at)?;
                            builder.colored_position(position, color)
                        }
                    };
                    let real = |k: usize| row.values[k].real();
                    if let Some(at) = normals_at {
                        kept.normals.push(at.map(|k| real(k) as f32));
                    }
                    if let Some(at) = uvs_at.filter(|_| is_textured) {
                        kept.uvs.push(at.map(real));
                    }
                    Ok(())
                })?;
            }
            (b"face", Some(corners)) => {
                let face_colors = element
                    .colors()
                    .filter(|_| colors.is_none() && !is_textured);
                if element.colors().is_some() && colors.is_some() {
                    builder.warn("colours of faces were passed over: the vertices have colours");
                }
                let uvs = element.list(&["texcoord"]).filter(|_| is_textured);
                let number = element.scalar(&["texnumber"]);
                file.rows(element, [Some(corners), uvs], |row| {
                    check_corners(row.lists[0].len(), Place::Byte(row.offset))?;
                    has_opacities |= opacity.is_some_and(|at| is_clear(&row, at));
                    let mut material = material;
                    if let Some(at) = face_colors {
                        let color = color("face", &row, element, at)?;
                        let name = "face colours";
                        let new = || builder.material(Material::of_srgb(name, color));
                        material = *of_color.entry(color).or_insert_with(new);
                    }
                    let number = number.map_or(Some(0), |k| row.values[k].whole());
                    let number = number.and_then(|number| usize::try_from(number).ok());
                    if let Some(&Some(textured)) = number.and_then(|n| textured.get(n)) {
                        let is_mapped =
                            !kept.uvs.is_empty() || row.lists[1].len() == 2 * row.lists[0].len();
                        without += u64::from(!is_mapped);
                        material = if is_mapped { textured } else { material };
                    }
                    add_face(&row, &kept, material, builder)
                })?;
            }
            (b"tristrips", Some(corners)) => file.rows(element, [Some(corners), None], |row| {
                let material = textured.first().copied().flatten().unwrap_or(material);
                add_strips(&row, &kept, material, builder)
            })?,
            _ => {
                if element.name == b"material" {
                    builder.warn("materials were passed over");
                }
                file.skip(element)?;
            }
        }
    }
    if let Some(unread) = file.unread()? {
        builder.warn(unread);
    }
    if has_opacities {
        builder.warn("opacities of vertices or faces were passed over");
    }
    if without > 0 {
        builder.warn(format!(
            "{without} faces have a texture, but no texture coordinates"
        ));
    }
    Ok(())
}

/// A material for each picture that can be read.
fn textured(names: &[String], beside: &Beside<'_>, builder: &mut MeshBuilder) -> Vec<Option<u32>> {
    let mut textures = Textures::default();
    let material = |name: &String| {
        let parts = Parts {
            color: Some(name),
            opacity: None,
            mode: AlphaMode::Blend,
            wrap: [Wrap::Repeat; 2],
        };
        let texture = textures.get(parts, beside)?;
        let material = builder.material(Material::of_srgb(name, [255; 3]));
        builder.set_texture(material, texture);
        Some(material)
    };
    let materials = names.iter().map(material).collect();
    textures.tell(builder);
    materials
}

fn color(kind: &str, row: &Row<'_>, of: &Element, at: [usize; 3]) -> Result<[u8; 3], Problem> {
    let mut color = [0; 3];
    for (channel, at) in color.iter_mut().zip(at) {
        let value = match row.values[at] {
            Number::Whole(n) if of.properties[at].scalar == Scalar::U16 => Number::Whole(n >> 8),
            value => value,
        };
        *channel = value.channel().ok_or_else(|| {
            let part = format!("{kind} {}", row.number);
            let expected =
                "colours from 0 to 255, declared as uchar, or from 0 to 1 as real numbers";
            let advice = "export the colours as uchar";
            Fault::new(part, row.offset, expected, value.to_string(), advice)
        })?;
    }
    Ok(color)
}

fn fault(kind: &str, row: &Row<'_>, expected: String, found: Number) -> Problem {
    let part = format!("{kind} {}", row.number);
    let advice =
        "the file is damaged, or its faces come before its vertices; export the mesh again";
    Fault::new(part, row.offset, expected, found.to_string(), advice).into()
}

fn add_face(
    row: &Row<'_>,
    vertices: &Vertices,
    material: u32,
    builder: &mut MeshBuilder,
) -> Result<(), Problem> {
    let corners = corners("face", row, row.lists[0], builder)?;
    let uvs = row.lists[1].as_chunks::<2>().0;
    for triangle in polygon::triangles(corners.len(), &|corner| builder.at(corners[corner])) {
        let uvs = (uvs.len() == corners.len())
            .then(|| triangle.map(|corner| uvs[corner].map(Number::real)));
        let triangle = triangle.map(|corner| corners[corner]);
        add_triangle(triangle, uvs, vertices, material, builder);
    }
    Ok(())
}

/// Each corner after the second of a strip makes a triangle, whose sides alternate. A corner of -1 ends a strip.
fn add_strips(
    row: &Row<'_>,
    vertices: &Vertices,
    material: u32,
    builder: &mut MeshBuilder,
) -> Result<(), Problem> {
    for strip in row.lists[0].split(|corner| *corner == Number::Whole(-1)) {
        let corners = corners("tristrips", row, strip, builder)?;
        for (n, window) in corners.windows(3).enumerate() {
            let (a, b, c) = (window[0], window[1], window[2]);
            // Equal corners only lead to the next part of a strip.
            if a != b && b != c && a != c {
                let triangle = if n % 2 == 0 { [a, b, c] } else { [b, a, c] };
                add_triangle(triangle, None, vertices, material, builder);
            }
        }
    }
    Ok(())
}

fn corners(
    kind: &str,
    row: &Row<'_>,
    numbers: &[Number],
    builder: &MeshBuilder,
) -> Result<Vec<u32>, Problem> {
    let positions = builder.positions() as i64;
    let corner = |number: &Number| {
        let corner = number.whole().filter(|n| (0..positions).contains(n));
        corner.map(|corner| corner as u32).ok_or_else(|| {
            let expected = format!("corners from 0 to {}", positions - 1);
            fault(kind, row, expected, *number)
        })
    };
    numbers.iter().map(corner).collect()
}

fn add_triangle(
    triangle: [u32; 3],
    uvs: Option<[[f64; 2]; 3]>,
    vertices: &Vertices,
    material: u32,
    builder: &mut MeshBuilder,
) {
    let Vertices {
        normals,
        uvs: of_vertices,
    } = vertices;
    let normal = |i: u32| normals.get(i as usize).copied().unwrap_or_default();
    let given = (!normals.is_empty()).then(|| triangle.map(normal));
    let uv = |i: u32| of_vertices.get(i as usize).copied().unwrap_or_default();
    let uvs = uvs.or_else(|| (!of_vertices.is_empty()).then(|| triangle.map(uv)));
    let places = uvs.map(|uvs| uvs.map(|[u, v]| [u, 1.0 - v]));
    let _ = builder.textured_triangle(triangle, given, material, places);
}
