//! The layout of a `.far` file: `spec/far.md`.
//!
//! A header of 128 bytes, then nodes, voxels and triangles, each aligned to 64
//! bytes with zeros between. All numbers are little-endian.

use crate::far::record::{NODE_BYTES, TRIANGLE_BYTES};

/// First eight bytes. As in PNG, they show a transfer that changes line ends or bit 7.
pub(super) const MAGIC: [u8; 8] = *b"\x89FAR\r\n\x1a\n";
/// Version of the layout.
pub(super) const VERSION: u32 = 2;
/// Bytes of the header.
pub(super) const HEADER_BYTES: usize = 128;
/// Sections begin at multiples of this.
const ALIGNMENT: u64 = 64;

/// Where things are in the header.
pub(super) mod at {
    pub(in super::super) const VERSION: usize = 8;
    pub(in super::super) const HEADER_BYTES: usize = 12;
    pub(in super::super) const FILE_BYTES: usize = 16;
    pub(in super::super) const NODES: usize = 24;
    pub(in super::super) const VOXEL_BYTES: usize = 32;
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
    pub(in super::super) const MORE_SPARE: std::ops::Range<usize> = 104..120;
    pub(in super::super) const CHECKSUM: usize = 120;
}

/// Where the sections lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) nodes: [u64; 2],
    pub(super) voxels: [u64; 2],
    pub(super) triangles: [u64; 2],
}

/// Begin and end of each section, in bytes, for so many nodes, bytes of voxels
/// and triangles. There is only one layout. Saturates.
pub(super) fn layout(nodes: u64, voxel_bytes: u64, triangles: u64) -> Layout {
    let align = |at: u64| at.div_ceil(ALIGNMENT).saturating_mul(ALIGNMENT);
    let after = |at: u64, bytes: u64| [align(at), align(at).saturating_add(bytes)];
    let nodes = after(HEADER_BYTES as u64, nodes.saturating_mul(NODE_BYTES as u64));
    let voxels = after(nodes[1], voxel_bytes);
    let triangles = after(voxels[1], triangles.saturating_mul(TRIANGLE_BYTES as u64));
    Layout {
        nodes,
        voxels,
        triangles,
    }
}
