//! PLY clouds: one voxel per vertex.

use glam::DVec3;

use super::cloud::Cloud;
use crate::graph::KnownNormals;
use crate::scene::DEFAULT_COLOR;
use crate::scene::emit::Emitter;
use crate::scene::fault::{Fault, Problem};
use crate::scene::input::Input;
use crate::scene::numbers::Number;
use crate::scene::ply::PlyFile;

pub(super) fn read(input: &mut Input<'_>, emitter: &mut Emitter<'_>) -> Result<(), Problem> {
    let mut file = PlyFile::open(&mut input.reader)?;
    let Some(vertices) = file.header.element("vertex").cloned() else {
        let advice = "this PLY holds no points; a cloud has an element vertex";
        return Err(Fault::new("header", 0, "an element \"vertex\"", "none", advice).into());
    };
    let positions = vertices.positions(file.offset())?;
    let (colors, normals) = (vertices.colors(), vertices.normals());
    let before = file.header.elements.clone();
    for element in before.iter().take_while(|e| e.name != b"vertex") {
        file.skip(element)?;
    }
    let mut known = KnownNormals::default();
    let mut cloud = Cloud::new(emitter.options);
    file.rows(&vertices, [None; 2], |row| {
        let part =
            |names: [&str; 3], k: usize| format!("vertex {}, property {}", row.number, names[k]);
        let mut color = DEFAULT_COLOR;
        for (k, at) in colors.into_iter().flatten().enumerate() {
            let value = row.values[at];
            color[k] = value.channel().ok_or_else(|| {
                let part = part(["red", "green", "blue"], k);
                let expected = "a whole number from 0 to 255, or a real one from 0 to 1";
                Fault::new(
                    part,
                    row.offset,
                    expected,
                    value.to_string(),
                    "export the colours as uchar",
                )
            })?;
        }
        let normal = normals.map(|at| DVec3::from_array(at.map(|k| Number::real(row.values[k]))));
        // A normal of length zero says that there is none.
        let normal = normal
            .map(|normal| known.encode(normal))
            .filter(|normal| !normal.is_none());
        let place = |axis: Option<usize>| match axis {
            Some(axis) => (part(["x", "y", "z"], axis), row.offset),
            None => (format!("vertex {}", row.number), row.offset),
        };
        cloud.point(
            positions.map(|at| row.values[at]),
            color,
            normal,
            place,
            emitter,
        )
    })?;
    if before.last().is_some_and(|last| last.name == b"vertex") {
        let unread = file.unread()?.map(str::to_owned);
        emitter.info.warnings.extend(unread);
    }
    cloud.finish(&mut emitter.info)
}
