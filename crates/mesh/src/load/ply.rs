//! PLY meshes.
//!
//! Read: `x y z`, `nx ny nz`, `red green blue` of vertices (with `r`, `g`, `b` and `diffuse_*`), `vertex_indices` or
//! `vertex_index` of faces (cut into a fan). Everything else is skipped.

use shiftvox::scene::numbers::{Number, Scalar};
use shiftvox::scene::ply::{PlyFile, Row};

use super::{Fault, Place, Problem, check_corners};
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
    let white = builder.material(Material::of_srgb("vertex colours", [255; 3]));
    let material = if colors.is_some() { white } else { default };
    let mut normals: Vec<[f32; 3]> = Vec::new();
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
                            color[k] = channel(&row, at[k], is_wide[k])?;
                        }
                        builder.colored_position(position, color)
                    }
                };
                normals.extend(normals_at.map(|at| at.map(|k| row.values[k].real() as f32)));
                Ok(())
            })?,
            (b"face", Some(corners)) => file.rows(element, Some(corners), |row| {
                check_corners(row.list.len(), Place::Byte(row.offset))?;
                add_face(&row, &normals, material, builder)
            })?,
            _ => file.skip(element)?,
        }
    }
    Ok(())
}

fn channel(row: &Row<'_>, at: usize, is_wide: bool) -> Result<u8, Problem> {
    let value = match row.values[at] {
        Number::Whole(n) if is_wide => Number::Whole(n >> 8),
        value => value,
    };
    value.channel().ok_or_else(|| {
        let expected = "colours from 0 to 255, or from 0 to 1 as real numbers";
        fault("vertex", row, expected.to_owned(), value)
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
    let positions = builder.positions() as i64;
    let mut corners = Vec::with_capacity(row.list.len());
    for number in row.list {
        let corner = number
            .whole()
            .filter(|corner| (0..positions).contains(corner));
        let corner = corner.ok_or_else(|| {
            let expected = format!("corners from 0 to {}", positions - 1);
            fault("face", row, expected, *number)
        })?;
        corners.push(corner as u32);
    }
    let [first, rest @ ..] = &corners[..] else {
        return Ok(());
    };
    for pair in rest.windows(2) {
        let triangle = [*first, pair[0], pair[1]];
        let normal = |i: u32| normals.get(i as usize).copied().unwrap_or_default();
        let given = (!normals.is_empty()).then(|| triangle.map(normal));
        let _ = builder.triangle(triangle, given, material);
    }
    Ok(())
}
