//! The layout of a `.tvx` file (`spec/textured.md`), and writing it.
//!
//! A header, an entry for each grid, primitives, their textures and paints; then for each grid its voxels, lists and
//! sub-textures.

use std::io::{self, Write};

use bytemuck::{Pod, Zeroable};
use xxhash_rust::xxh3::xxh3_64;

use crate::texture::stored;
use crate::textured::record::{Primitive, Texel, VoxelRecord};
use crate::textured::{Element, GridData, TexturedData};
use shiftvox::graph::file::{self, Format, HEADER_BYTES, Stored, section_after, to_file};

pub(super) const FORMAT: Format = Format {
    ending: ".tvx",
    magic: *b"\x89TVX\r\n\x1a\n",
    versions: &[3],
    header_bytes: HEADER_BYTES,
    signature: "the signature of a .tvx file",
    not_ours: "is this a .tvx file? Make one of a mesh with `convert`",
};

/// Where [`Fields`] begin in the header.
pub(super) const FIELDS: usize = 24;

#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Fields {
    pub(super) primitives: u64,
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
    pub(super) grids: u32,
    pub(super) textures_bytes: u32,
    pub(super) paints_bytes: u32,
    pub(super) y_up: u8,
    pub(super) spare: [u8; 3],
    pub(super) bevels: [u8; 8],
    pub(super) primitives_checksum: u64,
    pub(super) grids_checksum: u64,
}

impl Stored for Fields {
    const NUMBERS: &'static [(usize, usize)] = &[(7, 8), (3, 4), (12, 1), (2, 8)];
}

impl Stored for GridEntry {
    const NUMBERS: &'static [(usize, usize)] = &[(4, 4), (8, 8)];
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct GridEntry {
    pub cells: u32,
    pub texels: u32,
    /// 0 is the cube, 1 the six sides.
    pub element: u32,
    pub spare: u32,
    pub voxels: u64,
    pub listed: u64,
    pub textures: u64,
    pub projected: u64,
    pub projected_afresh: u64,
    pub voxels_checksum: u64,
    pub lists_checksum: u64,
    pub textures_checksum: u64,
}

pub(super) const ENTRY_BYTES: usize = size_of::<GridEntry>();

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) entries: [u64; 2],
    pub(super) primitives: [u64; 2],
    pub(super) textures: [u64; 2],
    pub(super) paints: [u64; 2],
    /// Of each grid its voxels, lists and sub-textures.
    pub(super) grids: Vec<[[u64; 2]; 3]>,
}

impl Layout {
    /// Saturates.
    pub(super) fn of(header: &Fields, grids: &[GridEntry]) -> Self {
        let entries = section_after(HEADER_BYTES as u64, grids.len() as u64, ENTRY_BYTES);
        let primitives = section_after(entries[1], header.primitives, size_of::<Primitive>());
        let textures = section_after(primitives[1], header.textures_bytes.into(), 1);
        let paints = section_after(textures[1], header.paints_bytes.into(), 1);
        let mut end = paints[1];
        let places = grids.iter().map(|grid| {
            let face = u64::from(grid.texels).saturating_mul(u64::from(grid.texels));
            [
                (grid.voxels, size_of::<VoxelRecord>()),
                (grid.listed, size_of::<u32>()),
                (grid.textures.saturating_mul(face), size_of::<Texel>()),
            ]
            .map(|(count, item_bytes)| {
                let section = section_after(end, count, item_bytes);
                end = section[1];
                section
            })
        });
        Self {
            entries,
            primitives,
            textures,
            paints,
            grids: places.collect(),
        }
    }

    pub(super) fn end(&self) -> u64 {
        self.sections().fold(0, |_, [_, end]| end)
    }

    pub(super) fn sections(&self) -> impl Iterator<Item = [u64; 2]> + '_ {
        let of_grids = self.grids.iter().flatten().copied();
        let of_all = [self.entries, self.primitives, self.textures, self.paints];
        of_all.into_iter().chain(of_grids)
    }
}

pub fn write_to(data: &TexturedData, out: &mut dyn Write) -> io::Result<()> {
    let entries: Vec<GridEntry> = data.grids.iter().map(entry).collect();
    let textures = stored::to_bytes(&data.textures);
    let paints = data.paints.iter().flat_map(|paint| paint.to_bytes());
    let paints = stored::sealed(&paints.collect::<Vec<u8>>());
    let [textures_bytes, paints_bytes] = [&textures, &paints].map(|b| u32::try_from(b.len()));
    let too_large = |_| io::Error::other("textures of 4 GB or more do not fit into a .tvx file");
    let mut sections = vec![
        to_file(&entries),
        to_file(&data.primitives),
        textures.into(),
        paints.into(),
    ];
    for grid in &data.grids {
        sections.push(to_file(&grid.voxels));
        sections.push(to_file(&grid.lists));
        sections.push(to_file(&grid.textures));
    }
    let fields = Fields {
        primitives: data.primitives.len() as u64,
        low: data.low.to_array(),
        high: data.high.to_array(),
        grids: entries.len() as u32,
        textures_bytes: textures_bytes.map_err(too_large)?,
        paints_bytes: paints_bytes.map_err(too_large)?,
        y_up: u8::from(data.y_up),
        spare: [0; 3],
        bevels: data.bevels,
        primitives_checksum: xxh3_64(&to_file(&data.primitives)),
        grids_checksum: xxh3_64(&to_file(&entries)),
    };
    let layout = Layout::of(&fields, &entries);
    let header = FORMAT.header(FORMAT.versions[0], layout.end(), |put| {
        put(FIELDS, &to_file(&[fields]))
    });
    let sections = layout.sections().zip(sections.iter().map(|bytes| &**bytes));
    file::write(&header, sections, out)
}

pub fn encode(data: &TexturedData) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    write_to(data, &mut bytes)?;
    Ok(bytes)
}

fn entry(grid: &GridData) -> GridEntry {
    let face = u64::from(grid.texels) * u64::from(grid.texels);
    GridEntry {
        cells: grid.cells,
        texels: grid.texels,
        element: u32::from(grid.element == Element::Sides),
        spare: 0,
        voxels: grid.voxels.len() as u64,
        listed: grid.lists.len() as u64,
        textures: grid.textures.len() as u64 / face.max(1),
        projected: grid.projected,
        projected_afresh: grid.projected_afresh,
        voxels_checksum: xxh3_64(&to_file(&grid.voxels)),
        lists_checksum: xxh3_64(&to_file(&grid.lists)),
        textures_checksum: xxh3_64(&to_file(&grid.textures)),
    }
}
