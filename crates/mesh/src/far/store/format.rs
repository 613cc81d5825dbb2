//! The layout of a `.far` file (`spec/far.md`), and writing it.

use std::io::{self, Write};

use bytemuck::{Pod, Zeroable};
use xxhash_rust::xxh3::xxh3_64;

use crate::far::FarData;
use crate::far::record::NODE_BYTES;
use crate::texture::stored;
use shiftvox::graph::file::{self, Format, HEADER_BYTES, Stored, section_after};

pub(in crate::far) const VERSION: u32 = 8;

pub(super) const FORMAT: Format = Format {
    ending: ".far",
    magic: *b"\x89FAR\r\n\x1a\n",
    versions: &[VERSION],
    header_bytes: HEADER_BYTES,
    signature: "the signature of a .far file",
    not_ours: "is this a .far file? Make one of a mesh with `convert`",
};

pub(super) const FIELDS: usize = 24;

#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Fields {
    pub(super) nodes: u64,
    pub(super) data_bytes: u64,
    pub(super) triangles: u64,
    pub(super) centre: [f64; 3],
    pub(super) distance_voxels: f64,
    pub(super) leaf_triangles: u32,
    pub(super) grid: u32,
    pub(super) blends: [u8; 2],
    pub(super) y_up: u8,
    pub(super) spare: [u8; 5],
    pub(super) nodes_checksum: u64,
    pub(super) bevels: [u8; 8],
    pub(super) textures_bytes: u64,
}

impl Stored for Fields {
    const NUMBERS: &'static [(usize, usize)] = &[(7, 8), (2, 4), (8, 1), (1, 8), (8, 1), (1, 8)];
}

/// Opacities are blended by cosines, normals and materials by their squares.
pub(super) const BLENDS: [u8; 2] = [1, 0];

/// The hierarchy, textures and data.
pub(super) fn layout(nodes: u64, textures_bytes: u64, data_bytes: u64) -> [[u64; 2]; 3] {
    let nodes = section_after(HEADER_BYTES as u64, nodes, NODE_BYTES);
    let textures = section_after(nodes[1], textures_bytes, 1);
    [nodes, textures, section_after(textures[1], data_bytes, 1)]
}

/// Writes a file whose data `copy` writes.
pub(in crate::far) fn write_parts(
    data: &FarData,
    data_bytes: u64,
    out: &mut dyn Write,
    copy: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let nodes = file::to_file(&data.nodes);
    let textures = stored::to_bytes(&data.textures);
    let textures_bytes = textures.len() as u64;
    let [node_place, texture_place, [begin, end]] =
        layout(data.nodes.len() as u64, textures_bytes, data_bytes);
    let settings = &data.settings;
    let fields = Fields {
        nodes: data.nodes.len() as u64,
        data_bytes,
        textures_bytes,
        triangles: data.triangles(),
        centre: settings.centre.to_array(),
        distance_voxels: settings.distance_voxels,
        leaf_triangles: settings.leaf_triangles,
        grid: settings.grid,
        blends: BLENDS,
        y_up: u8::from(settings.y_up),
        nodes_checksum: xxh3_64(&nodes),
        bevels: settings.bevels,
        ..Zeroable::zeroed()
    };
    let header = FORMAT.header(FORMAT.versions[0], end, |put| {
        put(FIELDS, &file::to_file(&[fields]))
    });
    // The zeros before the data are written before an empty section.
    let sections = [
        (node_place, &nodes[..]),
        (texture_place, &textures[..]),
        ([begin; 2], &[][..]),
    ];
    file::write(&header, sections.into_iter(), out)?;
    copy(out)
}

/// The bytes of a whole file.
pub fn encode(data: &FarData) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    write_parts(data, data.packed.len() as u64, &mut bytes, |out| {
        out.write_all(&data.packed)
    })?;
    Ok(bytes)
}
