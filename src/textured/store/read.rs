//! Reading a `.tvx` file: mapped, or held in memory.

use std::fs::File;
use std::io::{self, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use glam::DVec3;
use memmap2::Mmap;
use xxhash_rust::xxh3::xxh3_64;

use super::check::{Part, check, check_entry, check_primitives};
use super::error::{DAMAGED, NEWER, NOT_OURS, TexturedError};
use super::format::{ENTRY_BYTES, GridEntry, GridPlaces, HEADER_BYTES, Layout, MAGIC, VERSION, at};
use crate::graph::vxg::map_file;
use crate::textured::build::{MOST_GRIDS, depths_of};
use crate::textured::levels::Levels;
use crate::textured::record::{PRIMITIVE_BYTES, Primitive, Texel, VOXEL_BYTES, VoxelRecord};
use crate::textured::{Element, Lattice};

/// Whether a file that begins with these bytes is a `.tvx` file (of any version).
#[must_use]
pub fn is_textured(beginning: &[u8]) -> bool {
    beginning.starts_with(&MAGIC)
}

/// The bytes of a file, mapped or held.
#[derive(Debug)]
enum Bytes {
    Mapped(Arc<Mmap>),
    /// In words of 64 bits, so that records are aligned; and how many bytes count.
    Held(Vec<u64>, usize),
}

impl Bytes {
    fn get(&self) -> &[u8] {
        match self {
            Self::Mapped(map) => map,
            Self::Held(words, length) => &bytemuck::cast_slice(words)[..*length],
        }
    }
}

/// An open `.tvx` file.
#[derive(Debug)]
pub struct TexturedFile {
    path: PathBuf,
    bytes: Bytes,
    layout: Layout,
    low: DVec3,
    high: DVec3,
    y_up: bool,
    entries: Vec<GridEntry>,
    levels: Vec<Levels>,
    /// Grids whose texels were found sound.
    is_checked: Vec<AtomicBool>,
    levels_made: AtomicU64,
}

impl TexturedFile {
    /// Opens a file: maps it and checks all but the texels.
    ///
    /// # Errors
    /// When it cannot be read, is something else, is truncated, or a field is not as it should be.
    pub fn open(path: &Path) -> Result<Self, TexturedError> {
        let refused = |doing: &'static str| {
            move |source: io::Error| TexturedError::Io {
                file: path.to_owned(),
                doing,
                source,
            }
        };
        let mut file = File::open(path).map_err(refused("open it"))?;
        let metadata = file.metadata().map_err(refused("ask for its length"))?;
        if !metadata.is_file() {
            let reason = io::Error::other("it is not a regular file");
            return Err(refused("map it")(reason));
        }
        // The header is read, not mapped: only a file of the right length is mapped.
        let mut beginning = Vec::with_capacity(HEADER_BYTES);
        (&mut file)
            .take(HEADER_BYTES as u64)
            .read_to_end(&mut beginning)
            .map_err(refused("read its header"))?;
        Header::read(&beginning, metadata.len(), path)?;
        let map = map_file(&file).map_err(refused("map it into memory"))?;
        Self::of(Bytes::Mapped(map), path)
    }

    /// A file that is held in memory; it is named `(memory)` in errors.
    ///
    /// # Errors
    /// As [`TexturedFile::open`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TexturedError> {
        let mut words = vec![0u64; bytes.len().div_ceil(8)];
        bytemuck::cast_slice_mut(&mut words)[..bytes.len()].copy_from_slice(bytes);
        Self::of(Bytes::Held(words, bytes.len()), Path::new("(memory)"))
    }

    fn of(bytes: Bytes, path: &Path) -> Result<Self, TexturedError> {
        if cfg!(target_endian = "big") {
            return Err(TexturedError::ByteOrder(path.to_owned()));
        }
        let all = bytes.get();
        let header = Header::read(all, all.len() as u64, path)?;
        let entries = header.entries(all, path)?;
        let layout = Layout::of(header.primitives, &entries);
        if layout.end() != all.len() as u64 {
            let expected = format!("sections that end with the file at byte {}", all.len());
            let offset = layout.entries[0];
            return Err(malformed(path, "grids", offset, expected, DAMAGED));
        }
        let mut end = HEADER_BYTES as u64;
        for section in layout.sections() {
            if all[range([end, section[0]])].iter().any(|&byte| byte != 0) {
                return Err(malformed(path, "padding", end, "zeros", DAMAGED));
            }
            end = section[1];
        }
        let mut file = Self {
            path: path.to_owned(),
            is_checked: entries.iter().map(|_| AtomicBool::new(false)).collect(),
            bytes,
            layout,
            low: header.low,
            high: header.high,
            y_up: header.y_up,
            entries,
            levels: Vec::new(),
            levels_made: AtomicU64::new(0),
        };
        file.check_primitives(header.primitives_checksum)?;
        for number in 0..file.entries.len() {
            file.check_grid(number)?;
            let grid = &file.entries[number];
            let (voxels, lists) = (file.voxels(number), file.lists(number));
            let levels = Levels::of(voxels, lists, file.primitives().len(), grid.cells);
            file.levels.push(levels);
            file.levels_made.fetch_add(1, Ordering::Relaxed);
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
        malformed(&self.path, section, offset, expected, DAMAGED)
    }

    /// Lowest and highest corner of the box around all primitives, world units.
    #[must_use]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        (self.low, self.high)
    }

    /// Whether +Y is up, for fitted cameras; else +Z.
    #[must_use]
    pub fn y_up(&self) -> bool {
        self.y_up
    }

    /// The primitives, in the mesh's order.
    #[must_use]
    pub fn primitives(&self) -> &[Primitive] {
        bytemuck::cast_slice(&self.bytes.get()[range(self.layout.primitives)])
    }

    /// Bytes of the file.
    #[must_use]
    pub fn len(&self) -> u64 {
        self.layout.end()
    }

    /// Never: a file has a header.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Number of grids, at least one.
    #[must_use]
    pub fn grids(&self) -> usize {
        self.entries.len()
    }

    /// A grid, coarse before fine; `number` is below [`TexturedFile::grids`].
    #[must_use]
    pub fn grid(&self, number: usize) -> Grid<'_> {
        Grid { file: self, number }
    }

    /// How often tables of levels were made: once for each grid, on opening.
    #[must_use]
    pub fn levels_made(&self) -> u64 {
        self.levels_made.load(Ordering::Relaxed)
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
    #[must_use]
    pub fn lattice(&self) -> Lattice {
        let entry = &self.file.entries[self.number];
        Lattice::around(self.file.low, self.file.high, entry.cells, entry.texels)
    }

    /// What an erosion takes away.
    #[must_use]
    pub fn element(&self) -> Element {
        match self.file.entries[self.number].element {
            0 => Element::Cube,
            _ => Element::Sides,
        }
    }

    /// The voxels, by erosion depth and then by cell.
    #[must_use]
    pub fn voxels(&self) -> &'f [VoxelRecord] {
        self.file.voxels(self.number)
    }

    /// The primitives of a voxel, rising.
    #[must_use]
    pub fn list(&self, voxel: usize) -> &'f [u32] {
        let (voxels, lists) = (self.voxels(), self.file.lists(self.number));
        let end = voxels
            .get(voxel + 1)
            .map_or(lists.len(), |v| v.first as usize);
        &lists[voxels[voxel].first as usize..end]
    }

    /// Entries of all lists.
    #[must_use]
    pub fn listed(&self) -> u64 {
        self.file.entries[self.number].listed
    }

    /// What its levels show.
    #[must_use]
    pub fn levels(&self) -> &'f Levels {
        &self.file.levels[self.number]
    }

    /// Number of sub-textures.
    #[must_use]
    pub fn textures(&self) -> u64 {
        self.file.entries[self.number].textures
    }

    /// Texels that primitives were projected on; and how many it would have
    /// been, had each volume been projected afresh.
    #[must_use]
    pub fn projected(&self) -> [u64; 2] {
        let entry = &self.file.entries[self.number];
        [entry.projected, entry.projected_afresh]
    }

    /// Bytes of its voxels, lists and texels.
    #[must_use]
    pub fn bytes(&self) -> [u64; 3] {
        let places = self.file.places(self.number);
        [places.voxels, places.lists, places.textures].map(|[begin, end]| end - begin)
    }

    /// A sub-texture, row after row; `number` is below [`Grid::textures`].
    /// Texels are as they are in the file: [`Grid::ensure`] checks them.
    #[must_use]
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

/// A place in a file: within the address space, as the file's length is.
fn range([begin, end]: [u64; 2]) -> Range<usize> {
    begin as usize..end as usize
}

fn malformed(
    path: &Path,
    section: &'static str,
    offset: u64,
    expected: impl Into<String>,
    advice: &'static str,
) -> TexturedError {
    TexturedError::Malformed {
        file: path.to_owned(),
        section,
        offset,
        expected: expected.into(),
        advice,
    }
}

/// The header, decoded and checked.
struct Header {
    primitives: u64,
    grids: usize,
    low: DVec3,
    high: DVec3,
    y_up: bool,
    primitives_checksum: u64,
    grids_checksum: u64,
}

impl Header {
    /// Reads a header from the beginning of a file of `file_bytes`.
    fn read(beginning: &[u8], file_bytes: u64, path: &Path) -> Result<Self, TexturedError> {
        let ensure = |holds: bool, offset: usize, expected: String, advice: &'static str| {
            if holds {
                return Ok(());
            }
            Err(malformed(path, "header", offset as u64, expected, advice))
        };
        let signature = "the signature of a .tvx file".to_owned();
        ensure(is_textured(beginning), 0, signature, NOT_OURS)?;
        let Some(header) = beginning.first_chunk::<HEADER_BYTES>() else {
            let length = beginning.len();
            let expected = format!("{HEADER_BYTES} bytes, not {length}");
            return Err(malformed(path, "header", length as u64, expected, DAMAGED));
        };
        let eight = |offset: usize| -> [u8; 8] { std::array::from_fn(|i| header[offset + i]) };
        let u64_at = |offset: usize| u64::from_le_bytes(eight(offset));
        let point_at = |offset: usize| {
            DVec3::from_array([0, 8, 16].map(|skip| f64::from_le_bytes(eight(offset + skip))))
        };
        let u32_at =
            |offset: usize| u32::from_le_bytes(std::array::from_fn(|i| header[offset + i]));
        let version = u32_at(at::VERSION);
        let stored = u64_at(at::CHECKSUM);
        let sound = stored == xxh3_64(&header[..at::CHECKSUM]);
        // A sound header of another version is no damage.
        let expected = format!("version {VERSION}, not {version}");
        ensure(version == VERSION || !sound, at::VERSION, expected, NEWER)?;
        let expected = format!("header checksum {stored:016x}");
        ensure(sound, at::CHECKSUM, expected, DAMAGED)?;
        let length = u32_at(at::HEADER_BYTES);
        let expected = format!("a header length of {HEADER_BYTES}, not {length}");
        ensure(
            length == HEADER_BYTES as u32,
            at::HEADER_BYTES,
            expected,
            DAMAGED,
        )?;
        let said = u64_at(at::FILE_BYTES);
        let expected = format!("a file of {said} bytes, not {file_bytes}");
        ensure(said == file_bytes, at::FILE_BYTES, expected, DAMAGED)?;
        let is_spare = header[at::SPARE].iter().all(|&byte| byte == 0);
        ensure(is_spare, at::SPARE.start, "zeros".to_owned(), DAMAGED)?;
        let grids = u32_at(at::GRIDS) as usize;
        let expected = format!("1 to {MOST_GRIDS} grids, not {grids}");
        ensure(
            (1..=MOST_GRIDS).contains(&grids),
            at::GRIDS,
            expected,
            DAMAGED,
        )?;
        let primitives = u64_at(at::PRIMITIVES);
        let is_numbered = (1..u64::from(u32::MAX)).contains(&primitives);
        let expected = "1 to 2^32 primitives".to_owned();
        ensure(is_numbered, at::PRIMITIVES, expected, DAMAGED)?;
        let (low, high) = (point_at(at::LOW), point_at(at::HIGH));
        let is_box = low.is_finite() && high.is_finite() && (high - low).max_element() > 0.0;
        let expected = "a box of finite numbers".to_owned();
        ensure(is_box, at::LOW, expected, DAMAGED)?;
        ensure(
            header[at::Y_UP] <= 1,
            at::Y_UP,
            "0 or 1".to_owned(),
            DAMAGED,
        )?;
        Ok(Self {
            primitives,
            grids,
            low,
            high,
            y_up: header[at::Y_UP] == 1,
            primitives_checksum: u64_at(at::PRIMITIVES_CHECKSUM),
            grids_checksum: u64_at(at::GRIDS_CHECKSUM),
        })
    }

    /// The entries of the grids, which follow the header.
    fn entries(&self, all: &[u8], path: &Path) -> Result<Vec<GridEntry>, TexturedError> {
        let [begin, end] = [HEADER_BYTES, HEADER_BYTES + self.grids * ENTRY_BYTES];
        let Some(bytes) = all.get(begin..end) else {
            let expected = format!("{} grids", self.grids);
            return Err(malformed(path, "grids", begin as u64, expected, DAMAGED));
        };
        if xxh3_64(bytes) != self.grids_checksum {
            let expected = format!("checksum {:016x}", self.grids_checksum);
            return Err(malformed(path, "grids", begin as u64, expected, DAMAGED));
        }
        let entries: Vec<GridEntry> = bytemuck::pod_collect_to_vec(bytes);
        for (number, entry) in entries.iter().enumerate() {
            let is_finer = number == 0 || entries[number - 1].cells < entry.cells;
            let sound = check_entry(entry).and(if is_finer {
                Ok(())
            } else {
                Err("grids from coarse to fine")
            });
            sound.map_err(|expected| {
                let offset = (begin + number * ENTRY_BYTES) as u64;
                malformed(path, "grids", offset, expected, DAMAGED)
            })?;
        }
        Ok(entries)
    }
}
