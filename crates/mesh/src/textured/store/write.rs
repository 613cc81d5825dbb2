//! Writing a `.tvx` file.

use std::io::{self, Write};

use bytemuck::cast_slice;
use xxhash_rust::xxh3::xxh3_64;

use super::format::{FORMAT, GridEntry, Layout, at};
use crate::textured::{Element, GridData, TexturedData};
use shiftvox::graph::file::{self, HEADER_BYTES};

/// Writes textured voxels: to a temporary file, say, that then gets its name
/// ([`shiftvox::whole::write_with`]).
///
/// # Errors
/// The writer's byte order; a machine that stores the highest byte first.
pub fn write_to(data: &TexturedData, out: &mut dyn Write) -> io::Result<()> {
    let entries: Vec<GridEntry> = data.grids.iter().map(entry).collect();
    let layout = Layout::of(data.primitives.len() as u64, &entries);
    let mut sections: Vec<&[u8]> = vec![cast_slice(&entries), cast_slice(&data.primitives)];
    for grid in &data.grids {
        let parts: [&[u8]; 3] = [
            cast_slice(&grid.voxels),
            cast_slice(&grid.lists),
            cast_slice(&grid.textures),
        ];
        sections.extend(parts);
    }
    let header = header(data, &entries, &layout);
    file::write(&FORMAT, &header, layout.sections().zip(sections), out)
}

/// The bytes of a whole file.
///
/// # Errors
/// As [`write_to`].
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
        element: element_number(grid.element),
        spare: 0,
        voxels: grid.voxels.len() as u64,
        listed: grid.lists.len() as u64,
        textures: grid.textures.len() as u64 / face.max(1),
        projected: grid.projected,
        projected_afresh: grid.projected_afresh,
        voxels_checksum: xxh3_64(cast_slice(&grid.voxels)),
        lists_checksum: xxh3_64(cast_slice(&grid.lists)),
        textures_checksum: xxh3_64(cast_slice(&grid.textures)),
    }
}

pub(super) fn element_number(element: Element) -> u32 {
    match element {
        Element::Cube => 0,
        Element::Sides => 1,
    }
}

fn header(data: &TexturedData, entries: &[GridEntry], layout: &Layout) -> [u8; HEADER_BYTES] {
    FORMAT.header(layout.end(), |put| {
        put(
            at::PRIMITIVES,
            &(data.primitives.len() as u64).to_le_bytes(),
        );
        for k in 0..3 {
            put(at::LOW + 8 * k, &data.low[k].to_le_bytes());
            put(at::HIGH + 8 * k, &data.high[k].to_le_bytes());
        }
        // At most 16.
        put(at::GRIDS, &(entries.len() as u32).to_le_bytes());
        put(at::Y_UP, &[u8::from(data.y_up)]);
        put(at::BEVELS, &data.bevels);
        let primitives = xxh3_64(cast_slice(&data.primitives));
        put(at::PRIMITIVES_CHECKSUM, &primitives.to_le_bytes());
        let grids = xxh3_64(cast_slice(entries));
        put(at::GRIDS_CHECKSUM, &grids.to_le_bytes());
    })
}
