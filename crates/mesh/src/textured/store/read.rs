//! Reading a `.tvx` file: mapped, or held in memory.

use std::mem::offset_of;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use xxhash_rust::xxh3::xxh3_64;

use super::TexturedError;
use super::check::{Part, check, check_entry, check_primitives};
use super::format::{ENTRY_BYTES, FIELDS, FORMAT, Fields, GridEntry, GridPlaces, Layout};
use crate::textured::build::{MOST_GRIDS, depths_of};
use crate::textured::levels::Levels;
use crate::textured::record::{PRIMITIVE_BYTES, Primitive, Texel, VOXEL_BYTES, VoxelRecord};
use crate::textured::{CellGrid, Element};
use shiftvox::graph::MeshBox;
use shiftvox::graph::file::{self, Bytes, HEADER_BYTES, check_padding, range};
use shiftvox::graph::place::{MOST_PARTS, can_be_seen};

/// An open `.tvx` file.
#[derive(Debug)]
pub struct TexturedFile {
    path: PathBuf,
    bytes: Bytes,
    layout: Layout,
    low: DVec3,
    high: DVec3,
    y_up: bool,
    bevels: [u8; 8],
    entries: Vec<GridEntry>,
    levels: Vec<Levels>,
    /// Grids whose texels were found sound.
    is_checked: Vec<AtomicBool>,
}

impl TexturedFile {
    /// Opens a file: maps it and checks all but the texels.
    ///
    /// # Errors
    /// When it cannot be read, is something else, is truncated, or a field is not as it should be.
    pub fn open(path: &Path) -> Result<Self, TexturedError> {
        let opened = file::open(path, HEADER_BYTES)?;
        read_header(&opened.beginning, opened.bytes, path)?;
        Self::of(Bytes::Mapped(opened.map()?), path)
    }

    /// A file that is held in memory; it is named `(memory)` in errors.
    ///
    /// # Errors
    /// As [`TexturedFile::open`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TexturedError> {
        Self::of(Bytes::held(bytes), Path::new("(memory)"))
    }

    fn of(bytes: Bytes, path: &Path) -> Result<Self, TexturedError> {
        FORMAT.check_byte_order(path)?;
        let all = bytes.get();
        let header = read_header(all, all.len() as u64, path)?;
        let entries = read_entries(&header, all, path)?;
        let layout = Layout::of(header.primitives, &entries);
        if layout.end() != all.len() as u64 {
            let expected = format!("sections that end with the file at byte {}", all.len());
            let offset = layout.entries[0];
            return Err(TexturedError::damaged(path, "grids", offset, expected));
        }
        check_padding(all, layout.sections(), path)?;
        let mut file = Self {
            path: path.to_owned(),
            is_checked: entries.iter().map(|_| AtomicBool::new(false)).collect(),
            bytes,
            layout,
            low: header.low.into(),
            high: header.high.into(),
            y_up: header.y_up == 1,
            bevels: header.bevels,
            entries,
            levels: Vec::new(),
        };
        file.check_primitives(header.primitives_checksum)?;
        for number in 0..file.entries.len() {
            file.check_grid(number)?;
            let grid = &file.entries[number];
            let (voxels, lists) = (file.voxels(number), file.lists(number));
            let levels = Levels::of(voxels, lists, file.primitives().len(), grid.cells);
            file.levels.push(levels);
        }
        Ok(file)
    }

    fn check_primitives(&self, checksum: u64) -> Result<(), TexturedError> {
        let place = self.layout.primitives;
        if xxh3_64(&self.bytes.get()[range(place)]) != checksum {
            let expected = format!("checksum {checksum:016x}");
            return Err(self.damaged("primitives", place[0], expected));
        }
        check_primitives(self.primitives(), self.low, self.high).map_err(|(number, expected)| {
            let offset = place[0] + (number * PRIMITIVE_BYTES) as u64;
            self.damaged("primitives", offset, expected)
        })
    }

    fn check_grid(&self, number: usize) -> Result<(), TexturedError> {
        let (entry, places) = (&self.entries[number], &self.layout.grids[number]);
        for (section, place, checksum) in [
            ("voxels", places.voxels, entry.voxels_checksum),
            ("lists", places.lists, entry.lists_checksum),
        ] {
            if xxh3_64(&self.bytes.get()[range(place)]) != checksum {
                let expected = format!("checksum {checksum:016x} of grid {number}");
                return Err(self.damaged(section, place[0], expected));
            }
        }
        let (voxels, lists) = (self.voxels(number), self.lists(number));
        check(entry, voxels, lists, self.primitives().len()).map_err(|fault| {
            let (section, begin, bytes) = match fault.part {
                Part::Voxels => ("voxels", places.voxels[0], VOXEL_BYTES),
                Part::Lists => ("lists", places.lists[0], size_of::<u32>()),
            };
            let offset = begin + (fault.record * bytes) as u64;
            self.damaged(
                section,
                offset,
                format!("{} in grid {number}", fault.expected),
            )
        })
    }

    fn damaged(
        &self,
        section: &'static str,
        offset: u64,
        expected: impl Into<String>,
    ) -> TexturedError {
        TexturedError::damaged(&self.path, section, offset, expected)
    }

    /// Lowest and highest corner of the box around all primitives, world units.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        (self.low, self.high)
    }

    /// Whether +Y is up, for fitted cameras; else +Z.
    pub fn y_up(&self) -> bool {
        self.y_up
    }

    /// The box for fitted cameras.
    pub fn mesh_box(&self) -> MeshBox {
        let span = (self.low.to_array(), self.high.to_array());
        MeshBox::new(span, self.bevels, self.y_up)
    }

    /// The primitives, in the mesh's order.
    pub fn primitives(&self) -> &[Primitive] {
        bytemuck::cast_slice(&self.bytes.get()[range(self.layout.primitives)])
    }

    /// Bytes of the file.
    pub fn len(&self) -> u64 {
        self.layout.end()
    }

    /// Never: a file has a header.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Number of grids, at least one.
    pub fn grids(&self) -> usize {
        self.entries.len()
    }

    /// A grid, coarse before fine; `number` is below [`TexturedFile::grids`].
    pub fn grid(&self, number: usize) -> Grid<'_> {
        Grid { file: self, number }
    }

    /// Checks everything, also texels and erosion depths.
    ///
    /// # Errors
    /// At the first that is not as it should be.
    pub fn verify(&self) -> Result<(), TexturedError> {
        for number in 0..self.grids() {
            self.grid(number).ensure()?;
            let (entry, voxels) = (&self.entries[number], self.voxels(number));
            let element = self.grid(number).element();
            let depths = depths_of(voxels, entry.cells, element);
            let wrong = voxels
                .iter()
                .zip(depths)
                .position(|(v, depth)| v.depth != depth);
            if let Some(voxel) = wrong {
                let offset = self.layout.grids[number].voxels[0] + (voxel * VOXEL_BYTES) as u64;
                let expected = format!("the erosion depth of voxel {voxel} of grid {number}");
                return Err(self.damaged("voxels", offset, expected));
            }
        }
        Ok(())
    }

    fn places(&self, number: usize) -> &GridPlaces {
        &self.layout.grids[number]
    }

    fn voxels(&self, number: usize) -> &[VoxelRecord] {
        bytemuck::cast_slice(&self.bytes.get()[range(self.places(number).voxels)])
    }

    fn lists(&self, number: usize) -> &[u32] {
        bytemuck::cast_slice(&self.bytes.get()[range(self.places(number).lists)])
    }
}

/// One grid of a file.
#[derive(Debug, Clone, Copy)]
pub struct Grid<'f> {
    file: &'f TexturedFile,
    number: usize,
}

impl<'f> Grid<'f> {
    /// Where its cells and texels lie.
    pub fn cell_grid(&self) -> CellGrid {
        let entry = &self.file.entries[self.number];
        CellGrid::around(self.file.low, self.file.high, entry.cells, entry.texels)
    }

    /// The structuring element of the erosion.
    pub fn element(&self) -> Element {
        match self.file.entries[self.number].element {
            0 => Element::Cube,
            _ => Element::Sides,
        }
    }

    /// The voxels, by erosion depth and then by cell.
    pub fn voxels(&self) -> &'f [VoxelRecord] {
        self.file.voxels(self.number)
    }

    /// The primitives of a voxel, rising.
    pub fn list(&self, voxel: usize) -> &'f [u32] {
        let (voxels, lists) = (self.voxels(), self.file.lists(self.number));
        let end = voxels
            .get(voxel + 1)
            .map_or(lists.len(), |v| v.first as usize);
        &lists[voxels[voxel].first as usize..end]
    }

    /// Entries of all lists.
    pub fn listed(&self) -> u64 {
        self.file.entries[self.number].listed
    }

    /// The contents of its levels.
    pub fn levels(&self) -> &'f Levels {
        &self.file.levels[self.number]
    }

    /// Number of sub-textures.
    pub fn textures(&self) -> u64 {
        self.file.entries[self.number].textures
    }

    /// Texels that primitives were projected on; and how many it would have
    /// been, had each volume been projected afresh.
    pub fn projected(&self) -> [u64; 2] {
        let entry = &self.file.entries[self.number];
        [entry.projected, entry.projected_afresh]
    }

    /// Bytes of its voxels, lists and texels.
    pub fn bytes(&self) -> [u64; 3] {
        let places = self.file.places(self.number);
        [places.voxels, places.lists, places.textures].map(|[begin, end]| end - begin)
    }

    /// A sub-texture, row after row; `number` is below [`Grid::textures`].
    /// Texels are as they are in the file: [`Grid::ensure`] checks them.
    pub fn texture(&self, number: u32) -> &'f [Texel] {
        let side = self.file.entries[self.number].texels as usize;
        let texels = self.texels();
        &texels[number as usize * side * side..][..side * side]
    }

    fn texels(&self) -> &'f [Texel] {
        let place = self.file.places(self.number).textures;
        bytemuck::cast_slice(&self.file.bytes.get()[range(place)])
    }

    /// Checks the texels, the first time.
    ///
    /// # Errors
    /// When they are not as they were written.
    pub fn ensure(&self) -> Result<(), TexturedError> {
        let is_checked = &self.file.is_checked[self.number];
        if is_checked.load(Ordering::Relaxed) {
            return Ok(());
        }
        let place = self.file.places(self.number).textures;
        let checksum = self.file.entries[self.number].textures_checksum;
        let texels = self.texels();
        let is_sound =
            xxh3_64(bytemuck::cast_slice(texels)) == checksum && texels.iter().all(Texel::is_sound);
        if !is_sound {
            let expected = format!("sound texels with checksum {checksum:016x}");
            return Err(self.file.damaged("textures", place[0], expected));
        }
        is_checked.store(true, Ordering::Relaxed);
        Ok(())
    }
}

/// Reads and checks a header from the beginning of a file of `file_bytes`.
fn read_header(beginning: &[u8], file_bytes: u64, path: &Path) -> Result<Fields, TexturedError> {
    let header = FORMAT.read(beginning, file_bytes, path)?;
    let bytes = header.bytes_at::<{ size_of::<Fields>() }>(FIELDS);
    let fields: Fields = bytemuck::pod_read_unaligned(&bytes);
    let grids = format!("1 to {MOST_GRIDS} grids, not {}", fields.grids);
    let [low, high] = [fields.low, fields.high].map(DVec3::from_array);
    let extent = (high - low).max_element();
    let is_box = low.is_finite() && high.is_finite() && extent > 0.0;
    let is_seen = can_be_seen(fields.low, fields.high, extent / MOST_PARTS);
    for (holds, offset, expected) in [
        (fields.spare == [0; 11], offset_of!(Fields, spare), "zeros"),
        (
            (1..=MOST_GRIDS).contains(&(fields.grids as usize)),
            offset_of!(Fields, grids),
            &grids[..],
        ),
        (
            (1..u64::from(u32::MAX)).contains(&fields.primitives),
            offset_of!(Fields, primitives),
            "1 to 2^32 primitives",
        ),
        (is_box, offset_of!(Fields, low), "a box of finite numbers"),
        (
            is_seen,
            offset_of!(Fields, low),
            "a box whose parts can be told apart",
        ),
        (fields.y_up <= 1, offset_of!(Fields, y_up), "0 or 1"),
    ] {
        header.ensure(holds, FIELDS + offset, || expected)?;
    }
    Ok(fields)
}

/// The entries of the grids, which follow the header.
fn read_entries(header: &Fields, all: &[u8], path: &Path) -> Result<Vec<GridEntry>, TexturedError> {
    let damaged = |number: usize, expected: String| {
        let offset = (HEADER_BYTES + number * ENTRY_BYTES) as u64;
        TexturedError::damaged(path, "grids", offset, expected)
    };
    let length = header.grids as usize * ENTRY_BYTES;
    let bytes = all.get(HEADER_BYTES..HEADER_BYTES + length);
    let bytes = bytes.ok_or_else(|| damaged(0, format!("{} grids", header.grids)))?;
    if xxh3_64(bytes) != header.grids_checksum {
        return Err(damaged(
            0,
            format!("checksum {:016x}", header.grids_checksum),
        ));
    }
    let entries: Vec<GridEntry> = bytemuck::pod_collect_to_vec(bytes);
    for (number, entry) in entries.iter().enumerate() {
        let is_finer = number == 0 || entries[number - 1].cells < entry.cells;
        let order = is_finer.then_some(()).ok_or("grids from coarse to fine");
        check_entry(entry)
            .and(order)
            .map_err(|expected| damaged(number, expected.to_owned()))?;
    }
    Ok(entries)
}
