//! Writing a `.far` file.

use std::io::{self, Write};

use xxhash_rust::xxh3::xxh3_64;

use super::format::{FORMAT, at, layout};
use crate::far::FarData;
use crate::far::blend::Blend;
use crate::far::record::Node;
use crate::graph::file::{self, HEADER_BYTES};

/// Writes far voxels: to a temporary file, say, that then gets its name
/// ([`crate::whole::write_with`]).
///
/// # Errors
/// The writer's byte order; a machine that stores the highest byte first.
pub fn write_to(data: &FarData, out: &mut dyn Write) -> io::Result<()> {
    let places = layout(data.nodes.len() as u64, data.packed.len() as u64);
    let nodes: &[u8] = bytemuck::cast_slice::<Node, u8>(&data.nodes);
    let header = header(data, nodes, places.data[1]);
    let sections = [(places.nodes, nodes), (places.data, &data.packed[..])];
    file::write(&FORMAT, &header, sections.into_iter(), out)
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

fn header(data: &FarData, nodes: &[u8], file_bytes: u64) -> [u8; HEADER_BYTES] {
    FORMAT.header(file_bytes, |put| {
        put(at::NODES, &(data.nodes.len() as u64).to_le_bytes());
        put(at::DATA_BYTES, &(data.packed.len() as u64).to_le_bytes());
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
