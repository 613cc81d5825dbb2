//! The layout of a `.far` file: `spec/far.md`.
//!
//! A header of 128 bytes, then nodes and their data, each aligned to 64
//! bytes with zeros between. All numbers are little-endian.

use crate::far::record::NODE_BYTES;
use shiftvox::graph::file::{Format, HEADER_BYTES, section_after};

/// How files begin.
pub(super) const FORMAT: Format = Format {
    ending: ".far",
    // As in PNG, they show a transfer that changes line ends or bit 7.
    magic: *b"\x89FAR\r\n\x1a\n",
    version: 6,
    signature: "the signature of a .far file",
    not_ours: "is this a .far file? Make one of a mesh with `convert`",
};

/// Where things are in the header, beside what every header has.
pub(super) mod at {
    pub(in super::super) const NODES: usize = 24;
    pub(in super::super) const DATA_BYTES: usize = 32;
    pub(in super::super) const TRIANGLES: usize = 40;
    pub(in super::super) const CENTRE: usize = 48;
    pub(in super::super) const DISTANCE: usize = 72;
    pub(in super::super) const LEAF: usize = 80;
    pub(in super::super) const GRID: usize = 84;
    pub(in super::super) const OPACITY_BLEND: usize = 88;
    pub(in super::super) const SHADER_BLEND: usize = 89;
    pub(in super::super) const Y_UP: usize = 90;
    pub(in super::super) const SPARE: std::ops::Range<usize> = 91..96;
    pub(in super::super) const NODES_CHECKSUM: usize = 96;
    pub(in super::super) const BEVELS: usize = 104;
    pub(in super::super) const MORE_SPARE: std::ops::Range<usize> = 112..120;
}

/// Where the sections lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) nodes: [u64; 2],
    pub(super) data: [u64; 2],
}

/// Begin and end of each section, in bytes, for so many nodes and bytes of data. There is only one
/// layout. Saturates.
pub(super) fn layout(nodes: u64, data_bytes: u64) -> Layout {
    let nodes = section_after(HEADER_BYTES as u64, nodes, NODE_BYTES);
    let data = section_after(nodes[1], data_bytes, 1);
    Layout { nodes, data }
}
