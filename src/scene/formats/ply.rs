//! PLY clouds whose positions are voxel indices: one voxel per vertex.

use glam::DVec3;

use crate::graph::KnownNormals;
use crate::scene::emit::Emitter;
use crate::scene::fault::{Fault, Problem};
use crate::scene::input::Input;
use crate::scene::numbers::Number;
use crate::scene::ply::PlyFile;
use crate::scene::{DEFAULT_COLOR, ReadOptions, SceneInfo};

pub(super) fn read(
    input: &mut Input<'_>,
    _: &ReadOptions,
    emitter: &mut Emitter<'_>,
) -> Result<SceneInfo, Problem> {
    let mut file = PlyFile::open(&mut input.reader)?;
    let Some(vertices) = file.header.element("vertex").cloned() else {
        let advice = "this PLY holds no points; a cloud of voxel indices has an element vertex";
        return Err(Fault::new("header", 0, "an element \"vertex\"", "none", advice).into());
    };
    let positions = vertices.positions(file.offset())?;
    let (colors, normals) = (vertices.colors(), vertices.normals());
    let before = file.header.elements.clone();
    for element in before.iter().take_while(|e| e.name != b"vertex") {
        file.skip(element)?;
    }
    let mut known = KnownNormals::default();
    file.rows(&vertices, None, |row| {
        let part = |names: [&str; 3], k: usize| {
            format!("vertex {}, property {}", row.number, names[k])
        };
        let mut index = [0; 3];
        for axis in 0..3 {
            let value = row.values[positions[axis]];
            index[axis] = value.whole().ok_or_else(|| {
                let (part, advice) = (part(["x", "y", "z"], axis), "only clouds whose positions are voxel \
                    indices can be read; divide the positions by the voxel's size and round them down first");
                Fault::new(part, row.offset, "a whole number, the voxel's index", value.to_string(), advice)
            })?;
        }
        let mut color = DEFAULT_COLOR;
        for (k, at) in colors.into_iter().flatten().enumerate() {
            let value = row.values[at];
            color[k] = value.channel().ok_or_else(|| {
                let part = part(["red", "green", "blue"], k);
                let expected = "a whole number from 0 to 255, or a real one from 0 to 1";
                Fault::new(part, row.offset, expected, value.to_string(), "export the colours as uchar")
            })?;
        }
        let normal = normals.map(|at| DVec3::from_array(at.map(|k| Number::real(row.values[k]))));
        // A normal of length zero says that there is none.
        let normal = normal.map(|normal| known.encode(normal)).filter(|normal| !normal.is_none());
        emitter.voxel(index, color, normal, || (format!("vertex {}", row.number), row.offset))
    })?;
    Ok(SceneInfo {
        models: 1,
        instances: 1,
        stored_voxels: vertices.count,
        has_colors: colors.is_some(),
        has_normals: normals.is_some(),
        ..SceneInfo::default()
    })
}
