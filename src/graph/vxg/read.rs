//! Reading a `.vxg` file: lazily, or all of it.

use std::path::Path;
use std::sync::Arc;

use memmap2::Mmap;
use xxhash_rust::xxh3::xxh3_64;

use super::VxgError;
use super::format::{
    FORMAT, HEADER_BYTES, KINDS, MAX_LEVEL_STARTS, MESH_Y_UP, NO_MESH, SECTIONS, Section, VERSION,
    at, entry_at, layout,
};
use crate::graph::file::{self, Fields, Stored, from_file, range};
use crate::graph::map::advise;
use crate::graph::{Graph, Invalid, MeshBox, Placement, Store};

/// Maps a file. Fails when it cannot be read, is something else, is truncated, or its header is damaged.
pub fn open(path: &Path) -> Result<Graph, VxgError> {
    let opened = file::open(path, HEADER_BYTES)?;
    let header = Header::read(&opened.beginning, opened.bytes, path)?;
    let map = opened.map()?;
    // The file may have changed since its length was read.
    if map.len() as u64 != opened.bytes {
        let expected = format!("a file of {} bytes, not {}", opened.bytes, map.len());
        let offset = at::FILE_BYTES as u64;
        return Err(VxgError::damaged(path, "header", offset, expected));
    }
    if cfg!(target_endian = "big") {
        // Numbers are turned, so all is read.
        let graph = header.graph(&Source::Held(&map), path)?;
        header.verify_sections(&graph, &map, path)?;
        return Ok(graph);
    }
    advise(&map, false);
    header.graph(&Source::Mapped(&map), path)
}

/// Opens a file and checks all of it: checksums, padding and every index.
pub fn verify(path: &Path) -> Result<Graph, VxgError> {
    verify_mapped(&open(path)?, path)
}

/// Checks all of the file of an opened graph, header included, as it is now. The result is a new graph of the same map.
pub(crate) fn verify_mapped(graph: &Graph, path: &Path) -> Result<Graph, VxgError> {
    let Store::Mapped(map, _) = &graph.mask else {
        return Ok(graph.clone());
    };
    let header = Header::read(map, map.len() as u64, path)?;
    let graph = header.graph(&Source::Mapped(map), path)?;
    advise(map, true);
    let verified = header.verify_sections(&graph, map, path);
    advise(map, false);
    verified.map(|()| graph)
}

/// A graph from the bytes of a whole file, checked like [`verify`]. Errors name the file `(memory)`.
pub fn from_bytes(bytes: &[u8]) -> Result<Graph, VxgError> {
    let path = Path::new("(memory)");
    let header = Header::read(bytes, bytes.len() as u64, path)?;
    let graph = header.graph(&Source::Held(bytes), path)?;
    header.verify_sections(&graph, bytes, path)?;
    Ok(graph)
}

enum Source<'f> {
    Mapped(&'f Arc<Mmap>),
    Held(&'f [u8]),
}

impl Source<'_> {
    fn array<T: Stored>(&self, section: &Section) -> Store<T> {
        let place = range(section.place());
        match self {
            Self::Mapped(map) => Store::Mapped(Arc::clone(map), place),
            Self::Held(bytes) => from_file::<T>(&bytes[place]).into(),
        }
    }
}

struct Header {
    depth: u32,
    root: u32,
    voxels: u64,
    placement: Placement,
    level_start: Vec<u32>,
    sections: Vec<Section>,
}

impl Header {
    fn read(beginning: &[u8], file_bytes: u64, path: &Path) -> Result<Self, VxgError> {
        let fields = FORMAT.read(beginning, file_bytes, path)?;
        let sections = read_sections(&fields, file_bytes)?;
        let levels = fields.u32_at(at::LEVELS) as usize;
        fields.ensure(levels <= MAX_LEVEL_STARTS, at::LEVELS, || {
            format!("at most {MAX_LEVEL_STARTS} level entries, not {levels}")
        })?;
        let up = fields.byte_at(at::MESH_UP);
        fields.ensure(up <= MESH_Y_UP, at::MESH_UP, || {
            format!("0 to {MESH_Y_UP}, not {up}")
        })?;
        let mesh = (up != NO_MESH).then(|| MeshBox {
            low: fields.f64s_at(at::MESH_LOW),
            high: fields.f64s_at(at::MESH_HIGH),
            bevels: fields.bytes_at(at::MESH_BEVELS),
            y_up: up == MESH_Y_UP,
        });
        let [voxel_size] = fields.f64s_at(at::VOXEL_SIZE);
        Ok(Self {
            depth: fields.u32_at(at::DEPTH),
            root: fields.u32_at(at::ROOT),
            voxels: fields.u64_at(at::VOXELS),
            placement: Placement {
                origin_index: [0, 8, 16].map(|k| fields.u64_at(at::ORIGIN_INDEX + k) as i64),
                world_origin: fields.f64s_at(at::WORLD_ORIGIN),
                voxel_size,
                mesh,
            },
            level_start: (0..levels)
                .map(|i| fields.u32_at(at::LEVEL_START + 4 * i))
                .collect(),
            sections,
        })
    }

    fn graph(&self, source: &Source<'_>, path: &Path) -> Result<Graph, VxgError> {
        let opacity = self.sections.get(SECTIONS);
        let graph = Graph {
            depth: self.depth,
            root: self.root,
            mask: source.array(&self.sections[0]),
            first: source.array(&self.sections[1]),
            links: source.array(&self.sections[2]),
            color: source.array(&self.sections[3]),
            normal: source.array(&self.sections[4]),
            opacity: opacity.map_or_else(|| Vec::new().into(), |section| source.array(section)),
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

    fn locate(&self, invalid: Invalid, path: &Path) -> VxgError {
        let arrays = KINDS.iter().zip(&self.sections);
        let array = { arrays }.find(|((_, array, _), _)| *array == invalid.array);
        let (section, offset) = match (array, invalid.array) {
            (Some(((name, _, item_bytes), section)), _) => {
                let within = invalid.index as u64 * u64::from(*item_bytes);
                (*name, section.offset + within)
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
        VxgError::damaged(path, section, offset, invalid.expected)
    }

    fn verify_sections(&self, graph: &Graph, bytes: &[u8], path: &Path) -> Result<(), VxgError> {
        let places = self.sections.iter().map(Section::place);
        FORMAT.check_padding(bytes, places, path)?;
        for ((name, ..), section) in KINDS.iter().zip(&self.sections) {
            let actual = xxh3_64(&bytes[range(section.place())]);
            if actual != section.checksum {
                let expected = format!(
                    "the {} bytes from here to have checksum {:016x}, but they have {actual:016x}",
                    section.bytes, section.checksum
                );
                return Err(VxgError::damaged(path, name, section.offset, expected));
            }
        }
        let checked = graph.validate();
        checked.map_err(|invalid| self.locate(invalid, path))
    }
}

/// The section table: kinds, and the one layout that lengths allow.
fn read_sections(fields: &Fields<'_>, file_bytes: u64) -> Result<Vec<Section>, VxgError> {
    let expected = match fields.u32_at(at::VERSION) {
        VERSION => SECTIONS,
        _ => KINDS.len(),
    };
    let count = fields.u32_at(at::SECTION_COUNT);
    fields.ensure(count as usize == expected, at::SECTION_COUNT, || {
        format!("{expected} sections, not {count}")
    })?;
    let mut sections = vec![Section::default(); expected];
    for (i, (&(name, _, item_bytes), section)) in KINDS.iter().zip(&mut sections).enumerate() {
        let entry = entry_at(i);
        let tag = fields.bytes_at::<4>(entry);
        fields.ensure(tag == name.as_bytes(), entry, || {
            format!("section {name}, not {:?}", tag.escape_ascii().to_string())
        })?;
        let item = fields.u32_at(entry + 4);
        fields.ensure(item == item_bytes, entry + 4, || {
            format!("items of {item_bytes} bytes, not {item}")
        })?;
        *section = Section {
            offset: fields.u64_at(entry + 8),
            bytes: fields.u64_at(entry + 16),
            checksum: fields.u64_at(entry + 24),
        };
        let bytes = section.bytes;
        let is_whole = bytes.is_multiple_of(u64::from(item_bytes));
        fields.ensure(is_whole, entry + 16, || {
            format!("whole items of {item_bytes} bytes, not {bytes}")
        })?;
    }
    if let Some(opacity) = sections.get(SECTIONS) {
        // Without opacities a file is of the other version.
        fields.ensure(
            opacity.bytes > 0,
            entry_at(SECTIONS) + 16,
            || "opacities, not none",
        )?;
    }
    let (offsets, end) = layout(sections.iter().map(|section| section.bytes));
    for (i, (section, expected)) in sections.iter().zip(offsets).enumerate() {
        fields.ensure(section.offset == expected, entry_at(i) + 8, || {
            format!("the section at byte {expected}, not {}", section.offset)
        })?;
    }
    fields.ensure(end == file_bytes, at::FILE_BYTES, || {
        format!("sections that end with the file at byte {file_bytes}, not {end}")
    })?;
    Ok(sections)
}
