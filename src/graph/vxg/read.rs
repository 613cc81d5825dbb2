//! Reading a `.vxg` file: lazily, or all of it.

use std::path::Path;
use std::sync::Arc;

use memmap2::Mmap;
use xxhash_rust::xxh3::xxh3_64;

use super::error::{DAMAGED, NEWER, NOT_OURS, VxgError};
use super::format::{
    HEADER_BYTES, KINDS, MAGIC, MAX_LEVEL_STARTS, MESH_Y_UP, MOST_SECTIONS, NO_MESH, SECTIONS,
    Section, VERSION, VERSION_WITH_OPACITY, at, entry_at, layout,
};
use crate::graph::file::{self, Refused};
use crate::graph::map::{Access, advise};
use crate::graph::{Graph, Invalid, MeshBox, Opacity, PackedNormal, Placement, Store};

/// Opens a file: maps it, and checks the header and that all sections are there.
///
/// No section is read. A graph from a damaged file may look wrong, but walking
/// it never panics: see [`super`].
///
/// # Errors
/// When the file cannot be read, is something else, is truncated, or its header is damaged.
pub fn open(path: &Path) -> Result<Graph, VxgError> {
    Ok(open_with_header(path)?.0)
}

/// Opens a file and checks all of it: checksums, padding and every index.
///
/// # Errors
/// As [`open`], and when any byte is not as it was written.
pub fn verify(path: &Path) -> Result<Graph, VxgError> {
    let (graph, header, bytes) = open_with_header(path)?;
    bytes.advise(Access::Whole);
    verify_sections(&graph, &header, &bytes, path)?;
    bytes.advise(Access::Scattered);
    Ok(graph)
}

/// A graph from the bytes of a whole file, checked like [`verify`]; it owns
/// its arrays. The file is named `(memory)` in errors.
///
/// # Errors
/// As [`verify`].
pub fn from_bytes(bytes: &[u8]) -> Result<Graph, VxgError> {
    let path = Path::new("(memory)");
    let header = Header::read(bytes, bytes.len() as u64, path)?;
    let graph = header.graph_owned(bytes, path)?;
    verify_sections(&graph, &header, bytes, path)?;
    Ok(graph)
}

/// The bytes of a file, mapped or read.
enum Bytes {
    Mapped(Arc<Mmap>),
    Read(Vec<u8>),
}

impl Bytes {
    /// Tells the system how a mapped file is going to be read.
    fn advise(&self, access: Access) {
        if let Self::Mapped(map) = self {
            advise(map, access);
        }
    }
}

impl std::ops::Deref for Bytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Self::Mapped(map) => map,
            Self::Read(bytes) => bytes,
        }
    }
}

fn open_with_header(path: &Path) -> Result<(Graph, Header, Bytes), VxgError> {
    let refused = |doing, source| VxgError::Io {
        file: path.to_owned(),
        doing,
        source,
    };
    let told = |Refused { doing, source }| refused(doing, source);
    let opened = file::open(path, HEADER_BYTES).map_err(told)?;
    let header = Header::read(&opened.beginning, opened.bytes, path)?;
    if cfg!(target_endian = "little") {
        let map = opened.map().map_err(told)?;
        advise(&map, Access::Scattered);
        let graph = header.graph_mapped(&map, path)?;
        return Ok((graph, header, Bytes::Mapped(map)));
    }
    let bytes = std::fs::read(path).map_err(|source| refused("read it", source))?;
    let graph = header.graph_owned(&bytes, path)?;
    Ok((graph, header, Bytes::Read(bytes)))
}

/// The header, decoded and checked.
struct Header {
    depth: u32,
    root: u32,
    voxels: u64,
    placement: Placement,
    level_start: Vec<u32>,
    /// All that there are: with or without opacities.
    sections: Vec<Section>,
    file_bytes: u64,
}

/// `N` bytes of the header; the caller names a place inside it.
fn field<const N: usize>(header: &[u8; HEADER_BYTES], offset: usize) -> [u8; N] {
    std::array::from_fn(|i| header[offset + i])
}

fn u32_at(header: &[u8; HEADER_BYTES], offset: usize) -> u32 {
    u32::from_le_bytes(field(header, offset))
}

fn u64_at(header: &[u8; HEADER_BYTES], offset: usize) -> u64 {
    u64::from_le_bytes(field(header, offset))
}

/// Reports damage at a place of a file.
struct Reporter<'p>(&'p Path);

impl Reporter<'_> {
    fn error(
        &self,
        (section, offset): (&'static str, u64),
        expected: String,
        advice: &'static str,
    ) -> VxgError {
        VxgError::Malformed {
            file: self.0.to_owned(),
            section,
            offset,
            expected,
            advice,
        }
    }

    fn check(
        &self,
        holds: bool,
        offset: usize,
        advice: &'static str,
        expected: impl FnOnce() -> String,
    ) -> Result<(), VxgError> {
        if holds {
            return Ok(());
        }
        Err(self.error(("header", offset as u64), expected(), advice))
    }
}

impl Header {
    /// Reads a header from the beginning of a file of `file_bytes`.
    fn read(beginning: &[u8], file_bytes: u64, path: &Path) -> Result<Self, VxgError> {
        let report = Reporter(path);
        let magic = beginning.get(..MAGIC.len());
        report.check(magic == Some(&MAGIC), 0, NOT_OURS, || {
            "the signature of a .vxg file".to_owned()
        })?;
        let Some(header) = beginning.first_chunk::<HEADER_BYTES>() else {
            let expected = format!("a header of {HEADER_BYTES} bytes, not {}", beginning.len());
            return Err(report.error(("header", beginning.len() as u64), expected, DAMAGED));
        };
        let version = u32_at(header, at::VERSION);
        let stored = u64_at(header, at::CHECKSUM);
        let actual = xxh3_64(&header[..at::CHECKSUM]);
        let sound = stored == actual;
        // A sound header of another version is no damage.
        let known = version == VERSION || version == VERSION_WITH_OPACITY;
        report.check(known || !sound, at::VERSION, NEWER, || {
            format!("version {VERSION} or {VERSION_WITH_OPACITY}, not {version}")
        })?;
        report.check(sound, at::CHECKSUM, DAMAGED, || {
            format!("header checksum {stored:016x}, but the header has {actual:016x}")
        })?;
        let length = u32_at(header, at::HEADER_BYTES);
        report.check(
            length == HEADER_BYTES as u32,
            at::HEADER_BYTES,
            DAMAGED,
            || format!("a header length of {HEADER_BYTES}, not {length}"),
        )?;
        let expected_bytes = u64_at(header, at::FILE_BYTES);
        report.check(
            file_bytes == expected_bytes,
            at::FILE_BYTES,
            DAMAGED,
            || format!("a file of {expected_bytes} bytes, not {file_bytes}"),
        )?;
        let expected = match version {
            VERSION => SECTIONS,
            _ => MOST_SECTIONS,
        };
        let sections = read_sections(header, expected, file_bytes, &report)?;
        let levels = u32_at(header, at::LEVELS) as usize;
        report.check(levels <= MAX_LEVEL_STARTS, at::LEVELS, DAMAGED, || {
            format!("at most {MAX_LEVEL_STARTS} level entries, not {levels}")
        })?;
        let eights = |from: usize| [0, 8, 16].map(|skip| field::<8>(header, from + skip));
        let [up] = field(header, at::MESH_UP);
        report.check(up <= MESH_Y_UP, at::MESH_UP, DAMAGED, || {
            format!("0 to {MESH_Y_UP}, not {up}")
        })?;
        let mesh = (up != NO_MESH).then(|| MeshBox {
            low: eights(at::MESH_LOW).map(f64::from_le_bytes),
            high: eights(at::MESH_HIGH).map(f64::from_le_bytes),
            bevels: field(header, at::MESH_BEVELS),
            y_up: up == MESH_Y_UP,
        });
        Ok(Self {
            depth: u32_at(header, at::DEPTH),
            root: u32_at(header, at::ROOT),
            voxels: u64_at(header, at::VOXELS),
            placement: Placement {
                origin_index: eights(at::ORIGIN_INDEX).map(i64::from_le_bytes),
                world_origin: eights(at::WORLD_ORIGIN).map(f64::from_le_bytes),
                voxel_size: f64::from_le_bytes(field(header, at::VOXEL_SIZE)),
                mesh,
            },
            level_start: (0..levels)
                .map(|i| u32_at(header, at::LEVEL_START + 4 * i))
                .collect(),
            sections,
            file_bytes,
        })
    }

    /// A graph whose arrays are windows of the map.
    fn graph_mapped(&self, map: &Arc<Mmap>, path: &Path) -> Result<Graph, VxgError> {
        // The file may have changed since its length was asked for.
        if map.len() as u64 != self.file_bytes {
            let expected = format!("a file of {} bytes, not {}", self.file_bytes, map.len());
            return Err(Reporter(path).error(("header", at::FILE_BYTES as u64), expected, DAMAGED));
        }
        // Within the map, whose length is a usize.
        let range = |i: usize| {
            let Section { offset, bytes, .. } = self.sections[i];
            offset as usize..(offset + bytes) as usize
        };
        let opacity = match self.sections.len() {
            SECTIONS => Vec::new().into(),
            _ => Store::Mapped(Arc::clone(map), range(SECTIONS)),
        };
        self.graph(
            Store::Mapped(Arc::clone(map), range(0)),
            Store::Mapped(Arc::clone(map), range(1)),
            Store::Mapped(Arc::clone(map), range(2)),
            Store::Mapped(Arc::clone(map), range(3)),
            (Store::Mapped(Arc::clone(map), range(4)), opacity),
            path,
        )
    }

    /// A graph that owns its arrays, on a machine of any byte order.
    fn graph_owned(&self, bytes: &[u8], path: &Path) -> Result<Graph, VxgError> {
        // `Header::read` has seen that the sections are within the file.
        let section = |i: usize| self.sections[i].of(bytes);
        let numbers = |i: usize| -> Store<u32> {
            let items = section(i).as_chunks().0.iter();
            let numbers: Vec<u32> = items.map(|&item| u32::from_le_bytes(item)).collect();
            numbers.into()
        };
        let normal = section(4).as_chunks().0.iter();
        let normal = normal.map(|&n| PackedNormal(u16::from_le_bytes(n)));
        let opacity = match self.sections.len() {
            SECTIONS => Vec::new(),
            _ => {
                let items = section(SECTIONS).as_chunks().0.iter();
                items.map(|&sides| Opacity(sides)).collect()
            }
        };
        let opacity: Store<Opacity> = opacity.into();
        self.graph(
            section(0).to_vec().into(),
            numbers(1),
            numbers(2),
            section(3).as_chunks().0.to_vec().into(),
            (normal.collect::<Vec<_>>().into(), opacity),
            path,
        )
    }

    fn graph(
        &self,
        mask: Store<u8>,
        first: Store<u32>,
        links: Store<u32>,
        color: Store<[u8; 3]>,
        (normal, opacity): (Store<PackedNormal>, Store<Opacity>),
        path: &Path,
    ) -> Result<Graph, VxgError> {
        let graph = Graph {
            depth: self.depth,
            root: self.root,
            mask,
            first,
            links,
            color,
            normal,
            opacity,
            level_start: self.level_start.clone(),
            voxels: self.voxels,
            placement: self.placement,
        };
        let structure = graph
            .validate_shape()
            .and_then(|()| graph.validate_levels());
        structure.map_err(|invalid| self.locate(invalid, path))?;
        Ok(graph)
    }

    /// Says at which byte of the file an invariant is broken.
    fn locate(&self, invalid: Invalid, path: &Path) -> VxgError {
        let kinds = KINDS.iter().take(self.sections.len());
        let kind = { kinds }.position(|kind| kind.array == invalid.array);
        let place = match (kind, invalid.array) {
            (Some(i), _) => {
                let within = invalid.index as u64 * u64::from(KINDS[i].item_bytes);
                (KINDS[i].name, self.sections[i].offset + within)
            }
            (None, "depth") => ("header", at::DEPTH as u64),
            (None, "root") => ("header", at::ROOT as u64),
            (None, "voxels") => ("header", at::VOXELS as u64),
            (None, "level_start") => ("header", (at::LEVEL_START + 4 * invalid.index) as u64),
            (None, "world_origin") => ("header", at::WORLD_ORIGIN as u64),
            (None, "mesh") => ("header", at::MESH_LOW as u64),
            (None, "voxel_size") => ("header", at::VOXEL_SIZE as u64),
            (None, _) => ("header", at::ORIGIN_INDEX as u64),
        };
        Reporter(path).error(place, invalid.expected, DAMAGED)
    }
}

impl Section {
    /// The section's bytes; none if they are not within the file.
    fn of(self, file: &[u8]) -> &[u8] {
        let range = self.offset as usize..(self.offset.saturating_add(self.bytes)) as usize;
        file.get(range).unwrap_or_default()
    }
}

/// The section table: kinds, and the one layout that lengths allow.
fn read_sections(
    header: &[u8; HEADER_BYTES],
    expected: usize,
    file_bytes: u64,
    report: &Reporter<'_>,
) -> Result<Vec<Section>, VxgError> {
    let count = u32_at(header, at::SECTION_COUNT);
    report.check(
        count as usize == expected,
        at::SECTION_COUNT,
        DAMAGED,
        || format!("{expected} sections, not {count}"),
    )?;
    let mut sections = vec![Section::default(); expected];
    for (i, (kind, section)) in KINDS.iter().zip(&mut sections).enumerate() {
        let entry = entry_at(i);
        let tag = field::<4>(header, entry);
        report.check(tag == kind.tag, entry, DAMAGED, || {
            format!(
                "section {}, not {:?}",
                kind.name,
                tag.escape_ascii().to_string()
            )
        })?;
        let item = u32_at(header, entry + 4);
        report.check(item == kind.item_bytes, entry + 4, DAMAGED, || {
            format!("items of {} bytes, not {item}", kind.item_bytes)
        })?;
        *section = Section {
            offset: u64_at(header, entry + 8),
            bytes: u64_at(header, entry + 16),
            checksum: u64_at(header, entry + 24),
        };
        let whole = section.bytes.is_multiple_of(u64::from(kind.item_bytes));
        report.check(whole, entry + 16, DAMAGED, || {
            format!(
                "whole items of {} bytes, not {}",
                kind.item_bytes, section.bytes
            )
        })?;
    }
    if let Some(opacity) = sections.get(SECTIONS) {
        // Without opacities a file is of the other version.
        report.check(opacity.bytes > 0, entry_at(SECTIONS) + 16, DAMAGED, || {
            "opacities, not none".to_owned()
        })?;
    }
    let (offsets, end) = layout(sections.iter().map(|section| section.bytes));
    for (i, section) in sections.iter().enumerate() {
        let entry = entry_at(i);
        report.check(section.offset == offsets[i], entry + 8, DAMAGED, || {
            format!("the section at byte {}, not {}", offsets[i], section.offset)
        })?;
    }
    report.check(end == file_bytes, at::FILE_BYTES, DAMAGED, || {
        format!("sections that end with the file at byte {file_bytes}, not {end}")
    })?;
    Ok(sections)
}

/// Checks everything that [`open`] leaves unread.
fn verify_sections(
    graph: &Graph,
    header: &Header,
    bytes: &[u8],
    path: &Path,
) -> Result<(), VxgError> {
    let report = Reporter(path);
    let mut end = HEADER_BYTES as u64;
    for (kind, section) in KINDS.iter().zip(&header.sections) {
        let padding = bytes
            .get(end as usize..section.offset as usize)
            .unwrap_or_default();
        if let Some(place) = padding.iter().position(|&byte| byte != 0) {
            let offset = end + place as u64;
            let expected = format!("zero, not {}", padding[place]);
            return Err(report.error(("padding", offset), expected, DAMAGED));
        }
        let actual = xxh3_64(section.of(bytes));
        if actual != section.checksum {
            let expected = format!(
                "the {} bytes from here to have checksum {:016x}, but they have {actual:016x}",
                section.bytes, section.checksum
            );
            return Err(report.error((kind.name, section.offset), expected, DAMAGED));
        }
        end = section.offset + section.bytes;
    }
    graph
        .validate()
        .map_err(|invalid| header.locate(invalid, path))
}
