//! Writing a `.tvx` file.

use std::io::{self, Write};

use bytemuck::{bytes_of, cast_slice};
use xxhash_rust::xxh3::xxh3_64;

use super::format::{FIELDS, FORMAT, Fields, GridEntry, Layout};
use crate::textured::{Element, GridData, TexturedData};
use shiftvox::graph::file;

pub fn write_to(data: &TexturedData, out: &mut dyn Write) -> io::Result<()> {
    let entries: Vec<GridEntry> = data.grids.iter().map(entry).collect();
    let layout = Layout::of(data.primitives.len() as u64, &entries);
    let mut sections: Vec<&[u8]> = vec![cast_slice(&entries), cast_slice(&data.primitives)];
    for grid in &data.grids {
        sections.push(cast_slice(&grid.voxels));
        sections.push(cast_slice(&grid.lists));
        sections.push(cast_slice(&grid.textures));
    }
    let fields = Fields {
        primitives: data.primitives.len() as u64,
        low: data.low.to_array(),
        high: data.high.to_array(),
        grids: entries.len() as u32,
        y_up: u8::from(data.y_up),
        spare: [0; 11],
        bevels: data.bevels,
        primitives_checksum: xxh3_64(cast_slice(&data.primitives)),
        grids_checksum: xxh3_64(cast_slice(&entries)),
    };
    let header = FORMAT.header(FORMAT.versions[0], layout.end(), |put| {
        put(FIELDS, bytes_of(&fields))
    });
    file::write(&FORMAT, &header, layout.sections().zip(sections), out)
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
        voxels_checksum: xxh3_64(cast_slice(&grid.voxels)),
        lists_checksum: xxh3_64(cast_slice(&grid.lists)),
        textures_checksum: xxh3_64(cast_slice(&grid.textures)),
    }
}
