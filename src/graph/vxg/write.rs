//! Writing a `.vxg` file.

use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::Path;

use xxhash_rust::xxh3::Xxh3;

use super::VxgError;
use super::format::{
    FORMAT, HEADER_BYTES, KINDS, MESH_Y_UP, MESH_Z_UP, SECTIONS, Section, VERSION,
    VERSION_WITH_OPACITY, at, entry_at, layout,
};
use crate::graph::Graph;
use crate::graph::file::{ALIGNMENT, to_file};
use crate::whole;

/// Writes a graph to a file that appears when complete. Missing folders are created. Fails when the graph breaks an
/// invariant, when `path` exists and `overwrite` is false, or when the system refuses.
pub fn write(graph: &Graph, path: &Path, overwrite: bool) -> Result<(), VxgError> {
    graph.validate()?;
    let fill = |file: &mut File| {
        let mut out = BufWriter::with_capacity(1 << 16, file);
        write_unchecked(graph, &mut out).and_then(|()| out.flush())
    };
    Ok(whole::write_with(path, overwrite, fill)?)
}

/// Writes a file whose arrays do not exist as a whole, and returns its length in bytes. `lengths` are the bytes of the
/// sections, which `hand_on` puts one by one.
pub(in crate::graph) fn write_pieces(
    outline: &Graph,
    lengths: [u64; SECTIONS],
    path: &Path,
    overwrite: bool,
    hand_on: impl FnMut(usize, Put<'_>) -> io::Result<()>,
) -> Result<u64, VxgError> {
    let (_, file_bytes) = layout(lengths);
    let fill = |file: &mut File| {
        let mut out = BufWriter::with_capacity(1 << 16, file);
        // The header comes last: it holds the checksums.
        out.write_all(&[0; HEADER_BYTES])?;
        let table = put_sections(&lengths, &mut out, hand_on)?;
        out.seek(SeekFrom::Start(0))?;
        out.write_all(&header(outline, &table, file_bytes))?;
        out.flush()
    };
    whole::write_with(path, overwrite, fill)?;
    Ok(file_bytes)
}

type Put<'p> = &'p mut dyn FnMut(&[u8]) -> io::Result<()>;

fn put_sections(
    lengths: &[u64],
    out: &mut dyn Write,
    mut hand_on: impl FnMut(usize, Put<'_>) -> io::Result<()>,
) -> io::Result<Vec<Section>> {
    let (offsets, _) = layout(lengths.iter().copied());
    let mut written = HEADER_BYTES as u64;
    let mut table = Vec::new();
    for (i, (&length, offset)) in lengths.iter().zip(offsets).enumerate() {
        out.write_all(&[0; ALIGNMENT as usize][..(offset - written) as usize])?;
        let mut checksum = Xxh3::new();
        let mut bytes = 0;
        hand_on(i, &mut |piece| {
            checksum.update(piece);
            bytes += piece.len() as u64;
            out.write_all(piece)
        })?;
        if bytes != length {
            return Err(io::Error::other("a section's length was foretold wrongly"));
        }
        let checksum = checksum.digest();
        table.push(Section {
            offset,
            bytes,
            checksum,
        });
        written = offset + bytes;
    }
    Ok(table)
}

/// Writes a graph to anything that takes bytes. Errors name the file `(output)`.
pub fn write_to(graph: &Graph, out: &mut impl Write) -> Result<(), VxgError> {
    let file = Path::new("(output)");
    graph.validate()?;
    write_unchecked(graph, out).map_err(|source| VxgError::Io {
        file: file.into(),
        doing: "write",
        source,
    })
}

fn write_unchecked(graph: &Graph, out: &mut impl Write) -> io::Result<()> {
    let mut contents = vec![
        to_file(&graph.mask),
        to_file(&graph.first),
        to_file(&graph.links),
        to_file(&graph.color),
        to_file(&graph.normal),
    ];
    if !graph.opacity.is_empty() {
        contents.push(to_file(&graph.opacity));
    }
    let lengths: Vec<u64> = contents.iter().map(|bytes| bytes.len() as u64).collect();
    let (_, file_bytes) = layout(lengths.iter().copied());
    // Once for the checksums, which come before the sections.
    let table = put_sections(&lengths, &mut io::sink(), |i, put| put(&contents[i]))?;
    out.write_all(&header(graph, &table, file_bytes))?;
    put_sections(&lengths, out, |i, put| put(&contents[i]))?;
    Ok(())
}

fn header(graph: &Graph, table: &[Section], file_bytes: u64) -> Vec<u8> {
    let version = match table.len() {
        SECTIONS => VERSION,
        _ => VERSION_WITH_OPACITY,
    };
    FORMAT.header(version, file_bytes, |put| {
        put(at::DEPTH, &graph.depth.to_le_bytes());
        put(at::ROOT, &graph.root.to_le_bytes());
        put(at::VOXELS, &graph.voxels.to_le_bytes());
        let placement = &graph.placement;
        let origin_index = placement.origin_index.map(i64::to_le_bytes);
        let world_origin = placement.world_origin.map(f64::to_le_bytes);
        put(at::ORIGIN_INDEX, origin_index.as_flattened());
        put(at::WORLD_ORIGIN, world_origin.as_flattened());
        put(at::VOXEL_SIZE, &placement.voxel_size.to_le_bytes());
        put(at::LEVELS, &(graph.level_start.len() as u32).to_le_bytes());
        put(at::SECTION_COUNT, &(table.len() as u32).to_le_bytes());
        for (i, ((name, _, item_bytes), section)) in KINDS.iter().zip(table).enumerate() {
            let entry = entry_at(i);
            put(entry, name.as_bytes());
            put(entry + 4, &item_bytes.to_le_bytes());
            put(entry + 8, &section.offset.to_le_bytes());
            put(entry + 16, &section.bytes.to_le_bytes());
            put(entry + 24, &section.checksum.to_le_bytes());
        }
        for (i, start) in graph.level_start.iter().enumerate() {
            put(at::LEVEL_START + 4 * i, &start.to_le_bytes());
        }
        if let Some(mesh) = &placement.mesh {
            let up = if mesh.y_up { MESH_Y_UP } else { MESH_Z_UP };
            put(at::MESH_UP, &[up]);
            put(at::MESH_LOW, mesh.low.map(f64::to_le_bytes).as_flattened());
            put(
                at::MESH_HIGH,
                mesh.high.map(f64::to_le_bytes).as_flattened(),
            );
            put(at::MESH_BEVELS, &mesh.bevels);
        }
    })
}
