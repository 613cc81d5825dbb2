//! The layout of a `.vxg` file: `spec/graph.md`, "The .vxg file".
//!
//! A header of 512 bytes, then five sections, or six where voxels have opacities, each aligned to 64 bytes with
//! zeros between. All numbers are little-endian.

use crate::graph::MAX_DEPTH;

/// First eight bytes. As in PNG, they show a transfer that changes line ends or bit 7.
pub(crate) const MAGIC: [u8; 8] = *b"\x89VXG\r\n\x1a\n";
/// Version of the layout with five sections.
pub(super) const VERSION: u32 = 1;
/// Version of the layout with opacities as a sixth section.
pub(super) const VERSION_WITH_OPACITY: u32 = 2;
/// Bytes of the header.
pub(super) const HEADER_BYTES: usize = 512;
/// Sections begin at multiples of this.
pub(super) const ALIGNMENT: u64 = 64;
/// Sections that every file has.
pub(super) const SECTIONS: usize = 5;
/// Sections of a file with opacities.
pub(super) const MOST_SECTIONS: usize = SECTIONS + 1;

/// Where things are in the header.
pub(super) mod at {
    pub(in super::super) const VERSION: usize = 8;
    pub(in super::super) const HEADER_BYTES: usize = 12;
    pub(in super::super) const FILE_BYTES: usize = 16;
    pub(in super::super) const DEPTH: usize = 24;
    pub(in super::super) const ROOT: usize = 28;
    pub(in super::super) const VOXELS: usize = 32;
    pub(in super::super) const ORIGIN_INDEX: usize = 40;
    pub(in super::super) const WORLD_ORIGIN: usize = 64;
    pub(in super::super) const VOXEL_SIZE: usize = 88;
    pub(in super::super) const LEVELS: usize = 96;
    pub(in super::super) const SECTION_COUNT: usize = 100;
    /// Of voxels made of a mesh: which axis is up.
    pub(in super::super) const MESH_UP: usize = 104;
    pub(in super::super) const SECTIONS: usize = 128;
    pub(in super::super) const LEVEL_START: usize = 288;
    /// Entry of the sixth section, beyond the level table.
    pub(in super::super) const OPACITY_SECTION: usize = 416;
    /// Its box: lowest and highest corner, and its bevels.
    pub(in super::super) const MESH_LOW: usize = 448;
    pub(in super::super) const MESH_HIGH: usize = 472;
    pub(in super::super) const MESH_BEVELS: usize = 496;
    pub(in super::super) const CHECKSUM: usize = 504;
}

/// Values of byte [`at::MESH_UP`]: voxels that were not made of a mesh, of a mesh with +Z up, and with +Y up.
pub(super) const NO_MESH: u8 = 0;
pub(super) const MESH_Z_UP: u8 = 1;
pub(super) const MESH_Y_UP: u8 = 2;

/// Bytes of an entry of the section table.
pub(super) const SECTION_ENTRY_BYTES: usize = 32;
/// Most entries of the level table.
pub(super) const MAX_LEVEL_STARTS: usize = MAX_DEPTH as usize + 2;

/// A kind of section.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Kind {
    /// Four letters, as stored.
    pub(super) tag: [u8; 4],
    /// The same for a message.
    pub(super) name: &'static str,
    /// The field of the graph that it holds.
    pub(super) array: &'static str,
    /// Bytes of an item.
    pub(super) item_bytes: u32,
}

/// The sections, in the order in which they are stored; the last may be missing.
pub(super) const KINDS: [Kind; MOST_SECTIONS] = [
    Kind {
        tag: *b"MASK",
        name: "MASK",
        array: "mask",
        item_bytes: 1,
    },
    Kind {
        tag: *b"FRST",
        name: "FRST",
        array: "first",
        item_bytes: 4,
    },
    Kind {
        tag: *b"LINK",
        name: "LINK",
        array: "links",
        item_bytes: 4,
    },
    Kind {
        tag: *b"COLR",
        name: "COLR",
        array: "color",
        item_bytes: 3,
    },
    Kind {
        tag: *b"NRML",
        name: "NRML",
        array: "normal",
        item_bytes: 2,
    },
    Kind {
        tag: *b"OPAC",
        name: "OPAC",
        array: "opacity",
        item_bytes: 3,
    },
];

/// Where the header has the entry of section `i` of [`KINDS`].
pub(super) const fn entry_at(i: usize) -> usize {
    if i < SECTIONS {
        at::SECTIONS + i * SECTION_ENTRY_BYTES
    } else {
        at::OPACITY_SECTION
    }
}

/// Where a section lies, and its checksum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Section {
    /// Bytes from the beginning of the file.
    pub(super) offset: u64,
    /// Bytes, without the padding that follows.
    pub(super) bytes: u64,
    /// xxh3-64 of those bytes.
    pub(super) checksum: u64,
}

/// The least multiple of the alignment that is not below; saturates.
pub(super) fn align(offset: u64) -> u64 {
    offset.div_ceil(ALIGNMENT).saturating_mul(ALIGNMENT)
}

/// Where sections of these lengths lie, and the length of the file. There is
/// only one layout, so that a file has no room for anything unexplained.
pub(super) fn layout(bytes: impl IntoIterator<Item = u64>) -> (Vec<u64>, u64) {
    let mut end = HEADER_BYTES as u64;
    let offsets = bytes
        .into_iter()
        .map(|bytes| {
            let offset = align(end);
            end = offset.saturating_add(bytes);
            offset
        })
        .collect();
    (offsets, end)
}
