//! Writing a `.far` file.

use std::io::{self, Write};

use xxhash_rust::xxh3::xxh3_64;

use super::format::{HEADER_BYTES, MAGIC, VERSION, at, layout};
use crate::far::FarData;
use crate::far::blend::Blend;
use crate::far::record::{Node, triangle_bytes};

/// Writes far voxels: to a temporary file, say, that then gets its name
/// ([`crate::picture::store::write_with`]).
///
/// # Errors
/// What the writer says; a machine that stores the highest byte first.
pub fn write_to(data: &FarData, out: &mut dyn Write) -> io::Result<()> {
    if cfg!(target_endian = "big") {
        return Err(io::Error::other(
            ".far files are not written on machines of this byte order",
        ));
    }
    let places = layout(
        data.nodes.len() as u64,
        data.voxels.len() as u64,
        data.triangles.len() as u64,
    );
    let nodes: &[u8] = bytemuck::cast_slice::<Node, u8>(&data.nodes);
    out.write_all(&header(data, nodes, places.triangles[1]))?;
    let mut written = HEADER_BYTES as u64;
    let sections = [
        (places.nodes, nodes),
        (places.voxels, &data.voxels[..]),
        (places.triangles, triangle_bytes(&data.triangles)),
    ];
    for ([begin, end], bytes) in sections {
        // Less than the alignment.
        out.write_all(&[0; 64][..(begin - written) as usize])?;
        out.write_all(bytes)?;
        written = end;
    }
    Ok(())
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
    let mut header = [0u8; HEADER_BYTES];
    let mut put = |offset: usize, bytes: &[u8]| {
        header[offset..offset + bytes.len()].copy_from_slice(bytes);
    };
    put(0, &MAGIC);
    put(at::VERSION, &VERSION.to_le_bytes());
    put(at::HEADER_BYTES, &(HEADER_BYTES as u32).to_le_bytes());
    put(at::FILE_BYTES, &file_bytes.to_le_bytes());
    put(at::NODES, &(data.nodes.len() as u64).to_le_bytes());
    put(at::VOXEL_BYTES, &(data.voxels.len() as u64).to_le_bytes());
    put(at::TRIANGLES, &(data.triangles.len() as u64).to_le_bytes());
    for (k, centre) in data.centre.iter().enumerate() {
        put(at::CENTRE + 8 * k, &centre.to_le_bytes());
    }
    put(at::DISTANCE, &data.distance_voxels.to_le_bytes());
    put(at::LEAF, &data.leaf_triangles.to_le_bytes());
    put(at::GRID, &data.grid.to_le_bytes());
    put(at::OPACITY_BLEND, &[blend_byte(data.opacity_blend)]);
    put(at::SHADER_BLEND, &[blend_byte(data.shader_blend)]);
    put(at::Y_UP, &[u8::from(data.y_up)]);
    put(at::NODES_CHECKSUM, &xxh3_64(nodes).to_le_bytes());
    let checksum = xxh3_64(&header[..at::CHECKSUM]);
    header[at::CHECKSUM..].copy_from_slice(&checksum.to_le_bytes());
    header
}
