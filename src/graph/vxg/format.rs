//! The layout of a `.vxg` file: `spec/graph.md`, "The .vxg file".
//!
//! A header of 512 bytes, then five sections, or six where voxels have opacities. All numbers are little-endian.

use crate::graph::MAX_DEPTH;
use crate::graph::file::{Format, section_after};

/// First eight bytes. As in PNG, they show a transfer that changes line ends or bit 7.
pub(crate) const MAGIC: [u8; 8] = *b"\x89VXG\r\n\x1a\n";
pub(super) const VERSION: u32 = 1;
pub(super) const VERSION_WITH_OPACITY: u32 = 2;
pub(super) const FORMAT: Format = Format {
    ending: ".vxg",
    magic: MAGIC,
    versions: &[VERSION, VERSION_WITH_OPACITY],
    header_bytes: HEADER_BYTES,
    signature: "the signature of a .vxg file",
    not_ours: "is this a .vxg file? Convert other formats with `convert`",
};
pub(super) const HEADER_BYTES: usize = 512;
pub(super) const SECTIONS: usize = 5;

/// Offsets in the header, in addition to those of every format.
pub(super) mod at {
    pub(in super::super) use crate::graph::file::at::{FILE_BYTES, VERSION};
    pub(in super::super) const DEPTH: usize = 24;
    pub(in super::super) const ROOT: usize = 28;
    pub(in super::super) const VOXELS: usize = 32;
    pub(in super::super) const ORIGIN_INDEX: usize = 40;
    pub(in super::super) const WORLD_ORIGIN: usize = 64;
    pub(in super::super) const VOXEL_SIZE: usize = 88;
    pub(in super::super) const LEVELS: usize = 96;
    pub(in super::super) const SECTION_COUNT: usize = 100;
    pub(in super::super) const MESH_UP: usize = 104;
    pub(in super::super) const SECTIONS: usize = 128;
    pub(in super::super) const LEVEL_START: usize = 288;
    /// Entry of the sixth section, beyond the level table.
    pub(in super::super) const OPACITY_SECTION: usize = 416;
    pub(in super::super) const MESH_LOW: usize = 448;
    pub(in super::super) const MESH_HIGH: usize = 472;
    pub(in super::super) const MESH_BEVELS: usize = 496;
}

/// Values of byte [`at::MESH_UP`]: no mesh, a mesh with +Z up, a mesh with +Y up.
pub(super) const NO_MESH: u8 = 0;
pub(super) const MESH_Z_UP: u8 = 1;
pub(super) const MESH_Y_UP: u8 = 2;

const SECTION_ENTRY_BYTES: usize = 32;
pub(super) const MAX_LEVEL_STARTS: usize = MAX_DEPTH as usize + 2;

/// The sections in the order of the file: name and tag, field of the graph, bytes per item. The last may be missing.
pub(super) const KINDS: [(&str, &str, u32); SECTIONS + 1] = [
    ("MASK", "mask", 1),
    ("FRST", "first", 4),
    ("LINK", "links", 4),
    ("COLR", "color", 3),
    ("NRML", "normal", 2),
    ("OPAC", "opacity", 3),
];

pub(super) const fn entry_at(i: usize) -> usize {
    if i < SECTIONS {
        at::SECTIONS + i * SECTION_ENTRY_BYTES
    } else {
        at::OPACITY_SECTION
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Section {
    pub(super) offset: u64,
    pub(super) bytes: u64,
    pub(super) checksum: u64,
}

impl Section {
    pub(super) fn place(&self) -> [u64; 2] {
        [self.offset, self.offset.saturating_add(self.bytes)]
    }
}

/// Offsets of sections of these lengths, and the length of the file. Only one layout is allowed.
pub(super) fn layout(bytes: impl IntoIterator<Item = u64>) -> (Vec<u64>, u64) {
    let mut end = HEADER_BYTES as u64;
    let place = |bytes| {
        let [begin, after] = section_after(end, bytes, 1);
        end = after;
        begin
    };
    let offsets = bytes.into_iter().map(place).collect();
    (offsets, end)
}
