//! PLY meshes.
//!
//! Read: `x y z`, `nx ny nz`, `red green blue` of vertices (with `r`, `g`, `b` and `diffuse_*`), `vertex_indices` or
//! `vertex_index` of faces and of `tristrips`, `red green blue` of faces. Everything else is skipped.

use std::collections::HashMap;

use shiftvox::scene::numbers::{Number, Scalar};
use shiftvox::scene::ply::{PlyFile, Row};

use super::{Fault, Place, Problem, check_corners, polygon};
use crate::{Material, MeshBuilder};

pub(super) fn read(mut bytes: &[u8], builder: &mut MeshBuilder) -> Result<(), Problem> {
    let mut file = PlyFile::open(&mut bytes)?;
    let elements = file.header.elements.clone();
    let Some(vertices) = file.header.element("vertex") else {
        let advice = "export the mesh with its vertices";
        return Err(Fault::new("header", 0, "an element \"vertex\"", "none", advice).into());
    };
    let positions = vertices.positions(file.offset())?;
    let (colors, normals_at) = (vertices.colors(), vertices.normals());
    let is_wide = colors.map(|at| at.map(|k| vertices.properties[k].scalar == Scalar::U16));
    let default = builder.material(Material::default_color());
    let white = builder.material(Material::vertex_colors());
    let material = if colors.is_some() { white } else { default };
    let mut normals: Vec<[f32; 3]> = Vec::new();
    // Materials of faces with colours.
    let mut of_color: HashMap<[u8; 3], u32> = HashMap::new();
    // A second element of this name has other properties.
    let mut is_first = true;
    for element in &elements {
        let corners = element.list(&["vertex_indices", "vertex_index"]);
        match (&element.name[..], corners) {
            (b"vertex", _) if std::mem::take(&mut is_first) => file.rows(element, None, |row| {
                let position = positions.map(|k| row.values[k].real());
                match colors.zip(is_wide) {
                    None => builder.position(position),
                    Some((at, is_wide)) => {
                        let mut color = [0; 3];
                        for k in 0..3 {
                            color[k] = channel("vertex", &row, at[k], is_wide[k])?;
                        }
                        builder.colored_position(position, color)
                    }
                };
                normals.extend(normals_at.map(|at| at.map(|k| row.values[k].real() as f32)));
                Ok(())
            })?,
            (b"face", Some(corners)) => {
                let face_colors = element.colors().filter(|_| colors.is_none());
                if element.colors().is_some() && colors.is_some() {
                    builder.warn("colours of faces were passed over: the vertices have colours");
                }
                file.rows(element, Some(corners), |row| {
                    check_corners(row.list.len(), Place::Byte(row.offset))?;
                    let mut material = material;
                    if let Some(at) = face_colors {
                        let mut color = [0; 3];
                        for k in 0..3 {
                            let is_wide = element.properties[at[k]].scalar == Scalar::U16;
                            color[k] = channel("face", &row, at[k], is_wide)?;
                        }
                        let name = "face colours";
                        let new = || builder.material(Material::of_srgb(name, color));
                        material = *of_color.entry(color).or_insert_with(new);
                    }
                    add_face(&row, &normals, material, builder)
                })?;
            }
            (b"tristrips", Some(corners)) => file.rows(element, Some(corners), |row| {
                add_strips(&row, &normals, material, builder)
            })?,
            _ => file.skip(element)?,
        }
    }
    Ok(())
}

fn channel(kind: &str, row: &Row<'_>, at: usize, is_wide: bool) -> Result<u8, Problem> {
    let value = match row.values[at] {
        Number::Whole(n) if is_wide => Number::Whole(n >> 8),
        value => value,
    };
    value.channel().ok_or_else(|| {
        let expected = "colours from 0 to 255, or from 0 to 1 as real numbers";
        fault(kind, row, expected.to_owned(), value)
    })
}

fn fault(kind: &str, row: &Row<'_>, expected: String, found: Number) -> Problem {
    let part = format!("{kind} {}", row.number);
    let advice =
        "the file is damaged, or its faces come before its vertices; export the mesh again";
    Fault::new(part, row.offset, expected, found.to_string(), advice).into()
}

fn add_face(
    row: &Row<'_>,
    normals: &[[f32; 3]],
    material: u32,
    builder: &mut MeshBuilder,
) -> Result<(), Problem> {
    let corners = corners("face", row, row.list, builder)?;
    for triangle in polygon::triangles(corners.len(), &|corner| builder.at(corners[corner])) {
        let triangle = triangle.map(|corner| corners[corner]);
        add_triangle(triangle, normals, material, builder);
    }
    Ok(())
}

/// Each corner after the second of a strip makes a triangle, whose sides alternate. A corner of -1 ends a strip.
fn add_strips(
    row: &Row<'_>,
    normals: &[[f32; 3]],
    material: u32,
    builder: &mut MeshBuilder,
) -> Result<(), Problem> {
    for strip in row.list.split(|corner| *corner == Number::Whole(-1)) {
        let corners = corners("tristrips", row, strip, builder)?;
        for (n, window) in corners.windows(3).enumerate() {
            let (a, b, c) = (window[0], window[1], window[2]);
            // Equal corners only lead to the next part of a strip.
            if a != b && b != c && a != c {
                let triangle = if n % 2 == 0 { [a, b, c] } else { [b, a, c] };
                add_triangle(triangle, normals, material, builder);
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
    normals: &[[f32; 3]],
    material: u32,
    builder: &mut MeshBuilder,
) {
    let normal = |i: u32| normals.get(i as usize).copied().unwrap_or_default();
    let given = (!normals.is_empty()).then(|| triangle.map(normal));
    let _ = builder.triangle(triangle, given, material);
}
