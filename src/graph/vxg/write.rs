//! Writing a `.vxg` file.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::Path;

use xxhash_rust::xxh3::{Xxh3, xxh3_64};

use super::error::VxgError;
use super::format::{
    HEADER_BYTES, KINDS, MAGIC, MESH_Y_UP, MESH_Z_UP, SECTIONS, Section, VERSION,
    VERSION_WITH_OPACITY, at, entry_at, layout,
};
use crate::graph::{Graph, PackedNormal};
use crate::whole::{self, WholeError};

/// Writes a graph to a file.
///
/// It is written under a temporary name beside `path` and renamed when
/// complete, so a failed run leaves nothing half-written. Its folder is made
/// if there is none.
///
/// # Errors
/// When the graph breaks an invariant, when `path` exists and `overwrite` is
/// false, or when the system refuses.
pub fn write(graph: &Graph, path: &Path, overwrite: bool) -> Result<(), VxgError> {
    graph.validate()?;
    replace(path, overwrite, |file| {
        let mut out = BufWriter::with_capacity(1 << 16, file);
        write_unchecked(graph, &mut out).and_then(|()| out.flush())
    })
}

/// Fails where a file stands that may not be replaced.
pub(in crate::graph) fn check_free(path: &Path, overwrite: bool) -> Result<(), VxgError> {
    whole::check_free(path, overwrite).map_err(refused)
}

fn refused(error: WholeError) -> VxgError {
    let io = |file, source| VxgError::Io {
        file,
        doing: "write it",
        source,
    };
    match error {
        WholeError::Exists(path) => VxgError::Exists(path),
        WholeError::NoFolder(path) => io(path, io::ErrorKind::NotFound.into()),
        WholeError::Io { path, source } => io(path, source),
    }
}

/// Fills a temporary file beside `path` and gives it that name.
fn replace(
    path: &Path,
    overwrite: bool,
    fill: impl FnOnce(&mut File) -> io::Result<()>,
) -> Result<(), VxgError> {
    whole::write_with(path, overwrite, fill).map_err(refused)
}

/// Writes a file whose arrays are handed over piece by piece, because they are
/// nowhere as a whole. `outline` is the graph without its arrays; `lengths`
/// are the bytes of the sections. `hand_on` is called for each section in
/// turn and puts its bytes, little-endian. Gives the bytes of the file.
pub(in crate::graph) fn write_pieces(
    outline: &Graph,
    lengths: [u64; SECTIONS],
    path: &Path,
    overwrite: bool,
    mut hand_on: impl FnMut(usize, &mut dyn FnMut(&[u8]) -> io::Result<()>) -> io::Result<()>,
) -> Result<u64, VxgError> {
    let (offsets, file_bytes) = layout(lengths);
    replace(path, overwrite, |file| {
        let mut out = BufWriter::with_capacity(1 << 16, file);
        // The header comes last: it holds the checksums.
        out.write_all(&[0; HEADER_BYTES])?;
        let mut written = HEADER_BYTES as u64;
        let mut table = [Section::default(); SECTIONS];
        for (i, section) in table.iter_mut().enumerate() {
            // Less than the alignment.
            out.write_all(&[0; 64][..(offsets[i] - written) as usize])?;
            let mut checksum = Xxh3::new();
            let mut bytes = 0;
            hand_on(i, &mut |piece| {
                checksum.update(piece);
                bytes += piece.len() as u64;
                out.write_all(piece)
            })?;
            if bytes != lengths[i] {
                return Err(io::Error::other("a section's length was foretold wrongly"));
            }
            *section = Section {
                offset: offsets[i],
                bytes,
                checksum: checksum.digest(),
            };
            written = offsets[i] + bytes;
        }
        out.seek(SeekFrom::Start(0))?;
        out.write_all(&header(outline, &table, file_bytes))?;
        out.flush()
    })?;
    Ok(file_bytes)
}

/// Writes a graph to anything that takes bytes.
///
/// # Errors
/// When the graph breaks an invariant, or the writer fails (the file is then
/// named `(output)`).
pub fn write_to(graph: &Graph, out: &mut impl Write) -> Result<(), VxgError> {
    graph.validate()?;
    write_unchecked(graph, out).map_err(|source| VxgError::Io {
        file: "(output)".into(),
        doing: "write",
        source,
    })
}

fn write_unchecked(graph: &Graph, out: &mut impl Write) -> io::Result<()> {
    let mut contents = sections(graph).to_vec();
    if !graph.opacity.is_empty() {
        // Three bytes each, whatever the machine's byte order.
        contents.push(Cow::Borrowed(bytemuck::cast_slice(&graph.opacity)));
    }
    let (offsets, file_bytes) = layout(contents.iter().map(|section| section.len() as u64));
    let section = |(bytes, offset): (&Cow<'_, [u8]>, u64)| Section {
        offset,
        bytes: bytes.len() as u64,
        checksum: xxh3_64(bytes),
    };
    let table: Vec<Section> = contents.iter().zip(offsets).map(section).collect();
    out.write_all(&header(graph, &table, file_bytes))?;
    let mut written = HEADER_BYTES as u64;
    for (section, bytes) in table.iter().zip(&contents) {
        // Less than the alignment.
        let padding = (section.offset - written) as usize;
        out.write_all(&[0; 64][..padding])?;
        out.write_all(bytes)?;
        written = section.offset + section.bytes;
    }
    Ok(())
}

/// The bytes of each section: the arrays themselves, except where the
/// machine's byte order is the other one.
fn sections(graph: &Graph) -> [Cow<'_, [u8]>; SECTIONS] {
    if cfg!(target_endian = "little") {
        return [
            Cow::Borrowed(&graph.mask),
            Cow::Borrowed(bytemuck::cast_slice::<u32, u8>(&graph.first)),
            Cow::Borrowed(bytemuck::cast_slice::<u32, u8>(&graph.links)),
            Cow::Borrowed(graph.color.as_flattened()),
            Cow::Borrowed(bytemuck::cast_slice::<PackedNormal, u8>(&graph.normal)),
        ];
    }
    [
        Cow::Borrowed(&graph.mask),
        Cow::Owned(graph.first.iter().flat_map(|f| f.to_le_bytes()).collect()),
        Cow::Owned(graph.links.iter().flat_map(|l| l.to_le_bytes()).collect()),
        Cow::Borrowed(graph.color.as_flattened()),
        Cow::Owned(
            graph
                .normal
                .iter()
                .flat_map(|n| n.0.to_le_bytes())
                .collect(),
        ),
    ]
}

fn header(graph: &Graph, table: &[Section], file_bytes: u64) -> [u8; HEADER_BYTES] {
    let mut header = [0u8; HEADER_BYTES];
    let mut put = |offset: usize, bytes: &[u8]| {
        header[offset..offset + bytes.len()].copy_from_slice(bytes);
    };
    put(0, &MAGIC);
    let version = match table.len() {
        SECTIONS => VERSION,
        _ => VERSION_WITH_OPACITY,
    };
    put(at::VERSION, &version.to_le_bytes());
    put(at::HEADER_BYTES, &(HEADER_BYTES as u32).to_le_bytes());
    put(at::FILE_BYTES, &file_bytes.to_le_bytes());
    put(at::DEPTH, &graph.depth.to_le_bytes());
    put(at::ROOT, &graph.root.to_le_bytes());
    put(at::VOXELS, &graph.voxels.to_le_bytes());
    for axis in 0..3 {
        let origin_index = graph.placement.origin_index[axis].to_le_bytes();
        put(at::ORIGIN_INDEX + 8 * axis, &origin_index);
        let world_origin = graph.placement.world_origin[axis].to_le_bytes();
        put(at::WORLD_ORIGIN + 8 * axis, &world_origin);
    }
    put(at::VOXEL_SIZE, &graph.placement.voxel_size.to_le_bytes());
    put(at::LEVELS, &(graph.level_start.len() as u32).to_le_bytes());
    put(at::SECTION_COUNT, &(table.len() as u32).to_le_bytes());
    for (i, (kind, section)) in KINDS.iter().zip(table).enumerate() {
        let entry = entry_at(i);
        put(entry, &kind.tag);
        put(entry + 4, &kind.item_bytes.to_le_bytes());
        put(entry + 8, &section.offset.to_le_bytes());
        put(entry + 16, &section.bytes.to_le_bytes());
        put(entry + 24, &section.checksum.to_le_bytes());
    }
    for (i, start) in graph.level_start.iter().enumerate() {
        put(at::LEVEL_START + 4 * i, &start.to_le_bytes());
    }
    if let Some(mesh) = &graph.placement.mesh {
        put(
            at::MESH_UP,
            &[[MESH_Z_UP, MESH_Y_UP][usize::from(mesh.y_up)]],
        );
        for axis in 0..3 {
            put(at::MESH_LOW + 8 * axis, &mesh.low[axis].to_le_bytes());
            put(at::MESH_HIGH + 8 * axis, &mesh.high[axis].to_le_bytes());
        }
        put(at::MESH_BEVELS, &mesh.bevels);
    }
    let checksum = xxh3_64(&header[..at::CHECKSUM]);
    header[at::CHECKSUM..].copy_from_slice(&checksum.to_le_bytes());
    header
}
