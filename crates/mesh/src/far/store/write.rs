//! Writing a `.far` file.

use std::io::{self, Write};

use xxhash_rust::xxh3::xxh3_64;

use super::format::{FORMAT, at, layout};
use crate::far::FarData;
use crate::far::blend::Blend;
use crate::far::record::Node;
use shiftvox::graph::file::{self, HEADER_BYTES};

/// Writes far voxels: to a temporary file, say, that then gets its name
/// ([`shiftvox::whole::write_with`]).
///
/// # Errors
/// The writer's byte order; a machine that stores the highest byte first.
pub fn write_to(data: &FarData, out: &mut dyn Write) -> io::Result<()> {
    write_parts(data, data.packed.len() as u64, out, |out| {
        out.write_all(&data.packed)
    })
}

/// As [`write_to`], with the nodes' data from elsewhere: `copy` writes so many bytes of it.
pub(in crate::far) fn write_parts(
    data: &FarData,
    data_bytes: u64,
    out: &mut dyn Write,
    copy: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let places = layout(data.nodes.len() as u64, data_bytes);
    let nodes: &[u8] = bytemuck::cast_slice::<Node, u8>(&data.nodes);
    let header = header(data, nodes, places.data);
    // What lies between the sections is written before the empty one.
    let before_data = [places.data[0]; 2];
    let sections = [(places.nodes, nodes), (before_data, &[][..])];
    file::write(&FORMAT, &header, sections.into_iter(), out)?;
    copy(out)
}

/// The bytes of a whole file.
///
/// # Errors
/// As [`write_to`].
pub fn encode(data: &FarData) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    write_to(data, &mut bytes)?;
    Ok(bytes)
}

pub(super) fn blend_byte(blend: Blend) -> u8 {
    match blend {
        Blend::Squares => 0,
        Blend::Cosines => 1,
    }
}

fn header(data: &FarData, nodes: &[u8], [begin, end]: [u64; 2]) -> [u8; HEADER_BYTES] {
    FORMAT.header(end, |put| {
        put(at::NODES, &(data.nodes.len() as u64).to_le_bytes());
        put(at::DATA_BYTES, &(end - begin).to_le_bytes());
        put(at::TRIANGLES, &data.triangles().to_le_bytes());
        for (k, centre) in data.centre.iter().enumerate() {
            put(at::CENTRE + 8 * k, &centre.to_le_bytes());
        }
        put(at::DISTANCE, &data.distance_voxels.to_le_bytes());
        put(at::LEAF, &data.leaf_triangles.to_le_bytes());
        put(at::GRID, &data.grid.to_le_bytes());
        put(at::OPACITY_BLEND, &[blend_byte(data.opacity_blend)]);
        put(at::SHADER_BLEND, &[blend_byte(data.shader_blend)]);
        put(at::Y_UP, &[u8::from(data.y_up)]);
        put(at::BEVELS, &data.bevels);
        put(at::NODES_CHECKSUM, &xxh3_64(nodes).to_le_bytes());
    })
}
