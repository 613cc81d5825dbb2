//! The layout of a `.far` file (`spec/far.md`), and writing it.
//!
//! A header of 128 bytes, then nodes and their data, each aligned to 64 bytes with zeros between. All numbers are
//! little-endian.

use std::io::{self, Write};

use xxhash_rust::xxh3::xxh3_64;

use crate::far::FarData;
use crate::far::record::{NODE_BYTES, Node};
use shiftvox::graph::file::{self, Format, HEADER_BYTES, section_after};

/// How files begin.
pub(super) const FORMAT: Format = Format {
    ending: ".far",
    // As in PNG, they show a transfer that changes line ends or bit 7.
    magic: *b"\x89FAR\r\n\x1a\n",
    version: 6,
    signature: "the signature of a .far file",
    not_ours: "is this a .far file? Make one of a mesh with `convert`",
};

/// Offsets in the header, beside those of every header.
pub(super) mod at {
    pub(in super::super) const NODES: usize = 24;
    pub(in super::super) const DATA_BYTES: usize = 32;
    pub(in super::super) const TRIANGLES: usize = 40;
    pub(in super::super) const CENTRE: usize = 48;
    pub(in super::super) const DISTANCE: usize = 72;
    pub(in super::super) const LEAF: usize = 80;
    pub(in super::super) const GRID: usize = 84;
    pub(in super::super) const BLENDS: usize = 88;
    pub(in super::super) const Y_UP: usize = 90;
    pub(in super::super) const SPARE: std::ops::Range<usize> = 91..96;
    pub(in super::super) const NODES_CHECKSUM: usize = 96;
    pub(in super::super) const BEVELS: usize = 104;
    pub(in super::super) const MORE_SPARE: std::ops::Range<usize> = 112..120;
}

/// Opacities are blended by cosines, normals and materials by their squares.
pub(super) const BLENDS: [u8; 2] = [1, 0];

/// Begin and end of the sections of nodes and data, bytes, of so many nodes and bytes of data. Saturates.
pub(super) fn layout(nodes: u64, data_bytes: u64) -> [[u64; 2]; 2] {
    let nodes = section_after(HEADER_BYTES as u64, nodes, NODE_BYTES);
    [nodes, section_after(nodes[1], data_bytes, 1)]
}

/// Writes far voxels.
///
/// # Errors
/// Errors of `out`; a machine that stores the highest byte first.
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
    let nodes: &[u8] = bytemuck::cast_slice::<Node, u8>(&data.nodes);
    let [node_place, [begin, end]] = layout(data.nodes.len() as u64, data_bytes);
    let settings = &data.settings;
    let header = FORMAT.header(end, |put| {
        put(at::NODES, &(data.nodes.len() as u64).to_le_bytes());
        put(at::DATA_BYTES, &data_bytes.to_le_bytes());
        put(at::TRIANGLES, &data.triangles().to_le_bytes());
        let centre = settings.centre.to_array();
        put(at::CENTRE, bytemuck::bytes_of(&centre));
        put(at::DISTANCE, &settings.distance_voxels.to_le_bytes());
        put(at::LEAF, &settings.leaf_triangles.to_le_bytes());
        put(at::GRID, &settings.grid.to_le_bytes());
        put(at::BLENDS, &BLENDS);
        put(at::Y_UP, &[u8::from(settings.y_up)]);
        put(at::BEVELS, &settings.bevels);
        put(at::NODES_CHECKSUM, &xxh3_64(nodes).to_le_bytes());
    });
    // The zeros before the data are written before an empty section.
    let sections = [(node_place, nodes), ([begin; 2], &[][..])];
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
