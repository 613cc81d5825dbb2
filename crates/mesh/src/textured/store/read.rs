//! Reading a `.tvx` file: mapped, or held in memory.

use std::mem::offset_of;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use bytemuck::{Pod, cast_slice};
use glam::DVec3;
use xxhash_rust::xxh3::xxh3_64;

use super::TexturedError;
use super::check::{check, check_entry, check_primitives};
use super::format::{ENTRY_BYTES, FIELDS, FORMAT, Fields, GridEntry, Layout};
use crate::Texture;
use crate::texture::paint::{PAINT_BYTES, Paint};
use crate::texture::stored;
use crate::textured::build::{MOST_GRIDS, depths};
use crate::textured::levels::Levels;
use crate::textured::record::{Primitive, Texel, VoxelRecord, list_of};
use crate::textured::{CellGrid, Element};
use shiftvox::graph::MeshBox;
use shiftvox::graph::file::{self, Bytes, HEADER_BYTES, Stored, range, to_file, turn};
use shiftvox::graph::place::{MOST_PARTS, can_be_seen};

#[derive(Debug)]
pub struct TexturedFile {
    path: PathBuf,
    bytes: Bytes,
    layout: Layout,
    header: Fields,
    entries: Vec<GridEntry>,
    levels: Vec<Levels>,
    /// Grids whose texels were found sound.
    is_checked: Vec<AtomicBool>,
    painted: OnceLock<Painted>,
}

/// Textures, and of each primitive its paint, or nothing.
#[derive(Debug, Default)]
pub(in crate::textured) struct Painted {
    pub(in crate::textured) textures: Vec<Arc<Texture>>,
    pub(in crate::textured) paints: Vec<Paint>,
}

impl Painted {
    fn of(textures: &[u8], paints: &[u8], primitives: usize) -> Option<Self> {
        let textures = stored::from_bytes(textures)?;
        let paints = stored::opened(paints)?;
        let (paints, []) = paints.as_chunks::<PAINT_BYTES>() else {
            return None;
        };
        let paints = paints.iter().map(Paint::from_bytes);
        let paints: Vec<Paint> = paints.collect::<Option<_>>()?;
        let is_sound = paints.is_empty() || paints.len() == primitives;
        let mut all = paints.iter();
        let is_sound = is_sound && all.all(|paint| paint.is_of(textures.len()));
        is_sound.then_some(Self { textures, paints })
    }
}

impl TexturedFile {
    /// Opens a file: maps it and checks all but the texels.
    pub fn open(path: &Path) -> Result<Self, TexturedError> {
        let opened = file::open(path, HEADER_BYTES)?;
        read_header(&opened.beginning, opened.bytes, path)?;
        Self::of(Bytes::Mapped(opened.map()?), path)
    }

    /// A file that is held in memory; it is named `(memory)` in errors.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TexturedError> {
        Self::of(Bytes::held(bytes), Path::new("(memory)"))
    }

    fn of(bytes: Bytes, path: &Path) -> Result<Self, TexturedError> {
        let all = bytes.get();
        let header = read_header(all, all.len() as u64, path)?;
        let entries = read_entries(&header, all, path)?;
        let layout = Layout::of(&header, &entries);
        if layout.end() != all.len() as u64 {
            let expected = format!("sections that end with the file at byte {}", all.len());
            let offset = layout.entries[0];
            return Err(TexturedError::damaged(path, "grids", offset, expected));
        }
        FORMAT.check_padding(all, layout.sections(), path)?;
        let bytes = match cfg!(target_endian = "big") {
            true => turned(all, &layout),
            false => bytes,
        };
        let mut file = Self {
            path: path.to_owned(),
            is_checked: entries.iter().map(|_| AtomicBool::new(false)).collect(),
            bytes,
            layout,
            header,
            entries,
            levels: Vec::new(),
            painted: OnceLock::new(),
        };
        file.check_primitives()?;
        for number in 0..file.entries.len() {
            file.check_grid(number)?;
            let (grid, primitives) = (file.grid(number), file.primitives().len());
            let levels = Levels::of(grid.voxels(), grid.lists(), primitives, grid.entry().cells);
            file.levels.push(levels);
        }
        Ok(file)
    }

    fn check_primitives(&self) -> Result<(), TexturedError> {
        let place = self.layout.primitives;
        self.check_sum::<Primitive>("primitives", place, self.header.primitives_checksum)?;
        check_primitives(self.primitives(), self.bounds()).map_err(|(number, expected)| {
            let offset = place[0] + (number * size_of::<Primitive>()) as u64;
            self.damaged("primitives", offset, expected)
        })
    }

    fn check_grid(&self, number: usize) -> Result<(), TexturedError> {
        let (entry, [voxels, lists, _]) = (&self.entries[number], self.layout.grids[number]);
        self.check_sum::<VoxelRecord>("voxels", voxels, entry.voxels_checksum)?;
        self.check_sum::<u32>("lists", lists, entry.lists_checksum)?;
        let (grid, primitives) = (self.grid(number), self.primitives().len());
        let checked = check(entry, grid.voxels(), grid.lists(), primitives);
        checked.map_err(|(section, record, expected)| {
            let offset = match section {
                "voxels" => voxels[0] + (record * size_of::<VoxelRecord>()) as u64,
                _ => lists[0] + (record * size_of::<u32>()) as u64,
            };
            self.damaged(section, offset, format!("{expected} in grid {number}"))
        })
    }

    fn check_sum<T: Stored>(
        &self,
        section: &'static str,
        place: [u64; 2],
        checksum: u64,
    ) -> Result<(), TexturedError> {
        if xxh3_64(&to_file::<T>(self.section(place))) == checksum {
            return Ok(());
        }
        Err(self.damaged(section, place[0], format!("checksum {checksum:016x}")))
    }

    fn damaged(
        &self,
        section: &'static str,
        offset: u64,
        expected: impl Into<String>,
    ) -> TexturedError {
        TexturedError::damaged(&self.path, section, offset, expected)
    }

    fn section<T: Pod>(&self, place: [u64; 2]) -> &[T] {
        cast_slice(&self.bytes.get()[range(place)])
    }

    pub fn bounds(&self) -> (DVec3, DVec3) {
        (self.header.low.into(), self.header.high.into())
    }

    pub fn mesh_box(&self) -> MeshBox {
        let span = (self.header.low, self.header.high);
        MeshBox::new(span, self.header.bevels, self.header.y_up == 1)
    }

    pub fn primitives(&self) -> &[Primitive] {
        self.section(self.layout.primitives)
    }

    /// Unpacked when it is first needed.
    pub(in crate::textured) fn painted(&self) -> Result<&Painted, TexturedError> {
        if self.painted.get().is_none() {
            let bytes = [self.layout.textures, self.layout.paints].map(|place| self.section(place));
            let painted = Painted::of(bytes[0], bytes[1], self.primitives().len());
            let expected = "a texture or none for each primitive, as they were written";
            let damaged = || self.damaged("textures", self.layout.textures[0], expected);
            let _ = self.painted.set(painted.ok_or_else(damaged)?);
        }
        Ok(self.painted.get_or_init(Painted::default))
    }

    /// Of the primitives' pictures, as they are stored.
    pub fn texture_bytes(&self) -> u64 {
        let [begin, end] = self.layout.textures;
        end - begin
    }

    pub fn file_bytes(&self) -> u64 {
        self.layout.end()
    }

    pub fn grids(&self) -> usize {
        self.entries.len()
    }

    /// A grid, coarse before fine; `number` is below [`TexturedFile::grids`].
    pub fn grid(&self, number: usize) -> Grid<'_> {
        Grid { file: self, number }
    }

    /// Checks everything, also texels and erosion depths.
    pub fn verify(&self) -> Result<(), TexturedError> {
        self.painted()?;
        for number in 0..self.grids() {
            let grid = self.grid(number);
            grid.ensure()?;
            let voxels = grid.voxels().iter();
            let cells = voxels.clone().map(|voxel| voxel.cell.map(u32::from));
            let depths = depths(cells, grid.entry().cells, grid.element());
            let wrong = voxels.zip(depths).position(|(v, depth)| v.depth != depth);
            if let Some(voxel) = wrong {
                let at = (voxel * size_of::<VoxelRecord>()) as u64;
                let expected = format!("the erosion depth of voxel {voxel} of grid {number}");
                return Err(self.damaged("voxels", grid.places()[0][0] + at, expected));
            }
        }
        Ok(())
    }
}

#[derive(Debug, Clone, Copy)]
pub struct Grid<'f> {
    file: &'f TexturedFile,
    number: usize,
}

impl<'f> Grid<'f> {
    pub fn entry(&self) -> &'f GridEntry {
        &self.file.entries[self.number]
    }

    fn places(&self) -> &'f [[u64; 2]; 3] {
        &self.file.layout.grids[self.number]
    }

    pub fn cell_grid(&self) -> CellGrid {
        let (low, high) = self.file.bounds();
        CellGrid::around(low, high, self.entry().cells, self.entry().texels)
    }

    pub fn element(&self) -> Element {
        match self.entry().element {
            0 => Element::Cube,
            _ => Element::Sides,
        }
    }

    pub fn voxels(&self) -> &'f [VoxelRecord] {
        self.file.section(self.places()[0])
    }

    fn lists(&self) -> &'f [u32] {
        self.file.section(self.places()[1])
    }

    pub fn list(&self, voxel: usize) -> &'f [u32] {
        list_of(self.voxels(), self.lists(), voxel)
    }

    pub fn levels(&self) -> &'f Levels {
        &self.file.levels[self.number]
    }

    /// Bytes of its voxels, lists and texels.
    pub fn bytes(&self) -> [u64; 3] {
        self.places().map(|[begin, end]| end - begin)
    }

    /// A sub-texture, row after row, as it is in the file; [`Grid::ensure`] checks it.
    pub fn texture(&self, number: u32) -> &'f [Texel] {
        let face = (self.entry().texels * self.entry().texels) as usize;
        &self.texels()[number as usize * face..][..face]
    }

    fn texels(&self) -> &'f [Texel] {
        self.file.section(self.places()[2])
    }

    /// Checks the texels, the first time.
    pub fn ensure(&self) -> Result<(), TexturedError> {
        let is_checked = &self.file.is_checked[self.number];
        if is_checked.load(Ordering::Relaxed) {
            return Ok(());
        }
        let place = self.places()[2];
        let checksum = self.entry().textures_checksum;
        self.file.check_sum::<Texel>("textures", place, checksum)?;
        if !self.texels().iter().all(Texel::is_sound) {
            return Err(self.file.damaged("textures", place[0], "sound texels"));
        }
        is_checked.store(true, Ordering::Relaxed);
        Ok(())
    }
}

/// A file with the numbers of its sections in the processor's order.
fn turned(all: &[u8], layout: &Layout) -> Bytes {
    let mut all = all.to_vec();
    turn::<Primitive>(&mut all[range(layout.primitives)]);
    for &[voxels, lists, texels] in &layout.grids {
        turn::<VoxelRecord>(&mut all[range(voxels)]);
        turn::<u32>(&mut all[range(lists)]);
        turn::<Texel>(&mut all[range(texels)]);
    }
    Bytes::held(&all)
}

fn read_header(beginning: &[u8], file_bytes: u64, path: &Path) -> Result<Fields, TexturedError> {
    let header = FORMAT.read(beginning, file_bytes, path)?;
    let bytes = header.bytes_at::<{ size_of::<Fields>() }>(FIELDS);
    let fields = file::from_file::<Fields>(&bytes)[0];
    let grids = format!("1 to {MOST_GRIDS} grids, not {}", fields.grids);
    let [low, high] = [fields.low, fields.high].map(DVec3::from_array);
    let extent = (high - low).max_element();
    let is_box = low.is_finite() && high.is_finite() && extent > 0.0;
    let is_seen = can_be_seen(fields.low, fields.high, extent / MOST_PARTS);
    let has_grids = (1..=MOST_GRIDS).contains(&(fields.grids as usize));
    let has_primitives = (1..u64::from(u32::MAX)).contains(&fields.primitives);
    for (holds, offset, expected) in [
        (fields.spare == [0; 3], offset_of!(Fields, spare), "zeros"),
        (has_grids, offset_of!(Fields, grids), &grids[..]),
        (
            has_primitives,
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

fn read_entries(header: &Fields, all: &[u8], path: &Path) -> Result<Vec<GridEntry>, TexturedError> {
    let damaged = |number: usize, expected: String| {
        let offset = (HEADER_BYTES + number * ENTRY_BYTES) as u64;
        TexturedError::damaged(path, "grids", offset, expected)
    };
    let length = header.grids as usize * ENTRY_BYTES;
    let bytes = all.get(HEADER_BYTES..HEADER_BYTES + length);
    let bytes = bytes.ok_or_else(|| damaged(0, format!("{} grids", header.grids)))?;
    let checksum = header.grids_checksum;
    if xxh3_64(bytes) != checksum {
        return Err(damaged(0, format!("checksum {checksum:016x}")));
    }
    let entries: Vec<GridEntry> = file::from_file(bytes);
    for (number, entry) in entries.iter().enumerate() {
        let is_finer = number == 0 || entries[number - 1].cells < entry.cells;
        let order = is_finer.then_some(()).ok_or("grids from coarse to fine");
        check_entry(entry)
            .and(order)
            .map_err(|expected| damaged(number, expected.to_owned()))?;
    }
    Ok(entries)
}
