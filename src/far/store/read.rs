//! Reading a `.far` file: on demand, or all of it.

use std::fs::File;
use std::io::{self, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use memmap2::Mmap;
use xxhash_rust::xxh3::xxh3_64;

use super::budget::{Budget, Resident};
use super::check::check;
use super::error::{DAMAGED, FarError, NEWER, NOT_OURS};
use super::format::{HEADER_BYTES, Layout, MAGIC, VERSION, at, layout};
use super::write::blend_byte;
use crate::far::blend::Blend;
use crate::far::record::{LISTS, LeafTriangle, Node, RECORD_BYTES, triangle_bytes};
use crate::graph::vxg::{map_file, release};

/// Whether a file that begins with these bytes is a `.far` file (of any version).
#[must_use]
pub fn is_far(beginning: &[u8]) -> bool {
    beginning.starts_with(&MAGIC)
}

/// Bytes that the system maps at a time, where it has them: Linux's `fault_around_bytes`.
const BROUGHT_IN: u64 = 64 << 10;

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

/// An open `.far` file.
#[derive(Debug)]
pub struct FarFile {
    path: PathBuf,
    bytes: Bytes,
    places: Layout,
    nodes: Vec<Node>,
    /// Number of each node's first voxel, over all nodes.
    first_voxel: Vec<u32>,
    /// Nodes whose data was found sound.
    is_checked: Vec<AtomicBool>,
    /// What limits how much of the data is in memory, if anything does.
    budget: Option<Budget>,
    centre: DVec3,
    distance_voxels: f64,
    blends: [Blend; 2],
    leaf_triangles: u32,
    grid: u32,
    y_up: bool,
}

impl FarFile {
    /// Opens a file: maps it and checks header and hierarchy.
    ///
    /// # Errors
    /// When it cannot be read, is something else, is truncated, or a field of header or
    /// hierarchy is not as it should be.
    pub fn open(path: &Path) -> Result<Self, FarError> {
        let refused = |doing: &'static str| {
            move |source: io::Error| FarError::Io {
                file: path.to_owned(),
                doing,
                source,
            }
        };
        let mut file = File::open(path).map_err(refused("open it"))?;
        let metadata = file.metadata().map_err(refused("ask for its length"))?;
        if !metadata.is_file() {
            return Err(refused("map it")(io::Error::other(
                "it is not a regular file",
            )));
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

    /// Opens a file of which at most so many bytes of nodes' data are in memory
    /// at a time (a node that is larger is there alone). Header and hierarchy,
    /// pictures and what is made of nodes while they are drawn come on top.
    ///
    /// # Errors
    /// As [`FarFile::open`]; and where the system cannot let go of mapped pages.
    pub fn open_within(path: &Path, bytes: u64) -> Result<Self, FarError> {
        let mut file = Self::open(path)?;
        let whole = file.bytes.get().len();
        if let Bytes::Mapped(map) = &file.bytes
            && !release(map, 0, whole)
        {
            return Err(FarError::Io {
                file: path.to_owned(),
                doing: "keep to a budget of memory",
                source: io::Error::from(io::ErrorKind::Unsupported),
            });
        }
        file.budget = Some(Budget::new(bytes, file.nodes.len()));
        Ok(file)
    }

    /// What the budget came to; `None` without one.
    #[must_use]
    pub fn resident(&self) -> Option<Resident> {
        self.budget.as_ref().map(Budget::resident)
    }

    /// Lets go of nodes' data that was let go of before, while it was in use.
    pub(in crate::far) fn settle(&self, nodes: impl Iterator<Item = usize>) {
        if let (Some(budget), Bytes::Mapped(map)) = (&self.budget, &self.bytes) {
            for node in nodes.filter(|&node| !budget.is_here(node)) {
                let place = self.place_of(node);
                let _ = release(map, place.start, place.len());
            }
        }
    }

    /// A file that is held in memory; it is named `(memory)` in errors.
    ///
    /// # Errors
    /// As [`FarFile::open`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FarError> {
        let mut words = vec![0u64; bytes.len().div_ceil(8)];
        bytemuck::cast_slice_mut(&mut words)[..bytes.len()].copy_from_slice(bytes);
        Self::of(Bytes::Held(words, bytes.len()), Path::new("(memory)"))
    }

    fn of(bytes: Bytes, path: &Path) -> Result<Self, FarError> {
        if cfg!(target_endian = "big") {
            return Err(FarError::ByteOrder(path.to_owned()));
        }
        let all = bytes.get();
        let header = Header::read(all, all.len() as u64, path)?;
        let places = header.places;
        let mut end = HEADER_BYTES as u64;
        for section in [places.nodes, places.voxels, places.triangles] {
            let padding = &all[range([end, section[0]])];
            if padding.iter().any(|&byte| byte != 0) {
                return Err(malformed(path, "padding", end, "zeros", DAMAGED));
            }
            end = section[1];
        }
        let node_bytes = &all[range(places.nodes)];
        if xxh3_64(node_bytes) != header.nodes_checksum {
            let expected = format!("checksum {:016x} of the hierarchy", header.nodes_checksum);
            return Err(malformed(
                path,
                "hierarchy",
                places.nodes[0],
                expected,
                DAMAGED,
            ));
        }
        let nodes: Vec<Node> = bytemuck::pod_collect_to_vec(node_bytes);
        check(
            &nodes,
            places.voxels[1] - places.voxels[0],
            header.triangles,
        )
        .map_err(|fault| {
            let offset = places.nodes[0] + (fault.node * size_of::<Node>()) as u64;
            let expected = format!("node {} to have {}", fault.node, fault.expected);
            malformed(path, "hierarchy", offset, expected, DAMAGED)
        })?;
        let mut next = 0;
        let first_voxel = nodes
            .iter()
            .map(|node| {
                let first = next;
                // Checked: fewer than 2^32 of all.
                next += node.voxels() as u32;
                first
            })
            .collect();
        Ok(Self {
            path: path.to_owned(),
            budget: None,
            is_checked: nodes.iter().map(|_| AtomicBool::new(false)).collect(),
            places,
            nodes,
            first_voxel,
            centre: header.centre,
            distance_voxels: header.distance_voxels,
            blends: header.blends,
            leaf_triangles: header.leaf_triangles,
            grid: header.grid,
            y_up: header.y_up,
            bytes,
        })
    }

    /// The hierarchy, parents before children; the root comes first.
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// What single precision coordinates are relative to, world units.
    #[must_use]
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// Least distance from which a node may be used, in its voxels.
    #[must_use]
    pub fn distance_voxels(&self) -> f64 {
        self.distance_voxels
    }

    /// How opacities are blended.
    #[must_use]
    pub fn opacity_blend(&self) -> Blend {
        self.blends[0]
    }

    /// How normals and materials are blended.
    #[must_use]
    pub fn shader_blend(&self) -> Blend {
        self.blends[1]
    }

    /// Nodes with fewer triangles are leaves.
    #[must_use]
    pub fn leaf_triangles(&self) -> u32 {
        self.leaf_triangles
    }

    /// Voxels along the longest side of a node.
    #[must_use]
    pub fn grid(&self) -> u32 {
        self.grid
    }

    /// Whether +Y is up, for fitted cameras; else +Z.
    #[must_use]
    pub fn y_up(&self) -> bool {
        self.y_up
    }

    /// Bytes of the file.
    #[must_use]
    pub fn len(&self) -> u64 {
        self.places.triangles[1]
    }

    /// Never: a file has a header.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Lowest and highest corner of all triangles, world units.
    #[must_use]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let root = &self.nodes[0];
        let world = |p: [f32; 3]| self.centre + DVec3::from_array(p.map(f64::from));
        (world(root.low), world(root.high))
    }

    /// Number of a node's first voxel, over all nodes.
    pub(in crate::far) fn first_voxel(&self, node: usize) -> u32 {
        self.first_voxel[node]
    }

    /// Voxels of all nodes.
    #[must_use]
    pub fn voxels(&self) -> u32 {
        let last = self.nodes.len() - 1;
        // Checked: fewer than 2^32 of all.
        self.first_voxel[last] + self.nodes[last].voxels() as u32
    }

    /// Records of a node's voxels, one slice for each list.
    ///
    /// # Errors
    /// When they are not as they were written.
    pub fn lists(&self, node: usize) -> Result<[&[u8]; 6], FarError> {
        self.ensure(node)?;
        let mut rest = self.voxel_bytes(node);
        let counts = self.nodes[node].counts;
        Ok(std::array::from_fn(|list| {
            let (mine, more) = rest.split_at(counts[list] as usize * RECORD_BYTES[list]);
            rest = more;
            mine
        }))
    }

    /// Triangles of a node.
    ///
    /// # Errors
    /// When those of a leaf are not as they were written.
    pub fn triangles(&self, node: usize) -> Result<&[LeafTriangle], FarError> {
        self.ensure(node)?;
        Ok(self.triangles_of(node))
    }

    /// A triangle by its number over all leaves.
    pub(in crate::far) fn triangle(&self, number: usize) -> &LeafTriangle {
        &self.all_triangles()[number]
    }

    /// Checks the data of all nodes.
    ///
    /// # Errors
    /// At the first node whose data is not as it was written.
    pub fn verify(&self) -> Result<(), FarError> {
        (0..self.nodes.len()).try_for_each(|node| self.ensure(node))
    }

    fn all_triangles(&self) -> &[LeafTriangle] {
        bytemuck::cast_slice(&self.bytes.get()[range(self.places.triangles)])
    }

    fn triangles_of(&self, node: usize) -> &[LeafTriangle] {
        let first = self.nodes[node].first_triangle as usize;
        &self.all_triangles()[first..first + self.nodes[node].triangles as usize]
    }

    fn voxel_bytes(&self, node: usize) -> &[u8] {
        let begin = self.places.voxels[0] + self.nodes[node].voxels_at;
        &self.bytes.get()[range([begin, begin + self.nodes[node].voxel_bytes()])]
    }

    /// Where a node's data is, with what the system may bring in around it.
    fn place_of(&self, number: usize) -> Range<usize> {
        let node = &self.nodes[number];
        let (begin, bytes) = if node.is_leaf() {
            let size = size_of::<LeafTriangle>() as u64;
            let first = u64::from(node.first_triangle) * size;
            (
                self.places.triangles[0] + first,
                u64::from(node.triangles) * size,
            )
        } else {
            (self.places.voxels[0] + node.voxels_at, node.voxel_bytes())
        };
        let end = (begin + bytes).next_multiple_of(BROUGHT_IN);
        range([begin / BROUGHT_IN * BROUGHT_IN, end.min(self.len())])
    }

    /// Counts a node's data into the budget, and checks it when it is first asked for.
    fn ensure(&self, number: usize) -> Result<(), FarError> {
        if let (Some(budget), Bytes::Mapped(map)) = (&self.budget, &self.bytes) {
            let release_range = |range: &Range<usize>| {
                // It did at the beginning; a page more in memory does no harm.
                let _ = release(map, range.start, range.len());
            };
            budget.touch(number, || self.place_of(number), release_range);
        }
        if self.is_checked[number].load(Ordering::Relaxed) {
            return Ok(());
        }
        let node = &self.nodes[number];
        let damaged = |section, offset, expected: String| {
            Err(malformed(&self.path, section, offset, expected, DAMAGED))
        };
        if node.is_leaf() {
            let triangles = self.triangles_of(number);
            let offset = self.places.triangles[0]
                + u64::from(node.first_triangle) * size_of::<LeafTriangle>() as u64;
            if xxh3_64(triangle_bytes(triangles)) != node.checksum {
                let expected = format!("checksum {:016x} of leaf {number}", node.checksum);
                return damaged("triangles", offset, expected);
            }
            let is_within =
                |p: &[f32; 3]| (0..3).all(|k| node.low[k] <= p[k] && p[k] <= node.high[k]);
            let is_sound = |t: &LeafTriangle| t.spare == 0 && t.corners.iter().all(is_within);
            if !triangles.iter().all(is_sound) {
                return damaged(
                    "triangles",
                    offset,
                    format!("triangles within leaf {number}"),
                );
            }
        } else {
            let bytes = self.voxel_bytes(number);
            let offset = self.places.voxels[0] + node.voxels_at;
            if xxh3_64(bytes) != node.checksum {
                let expected = format!("checksum {:016x} of node {number}", node.checksum);
                return damaged("voxels", offset, expected);
            }
            let mut rest = bytes;
            for list in 0..LISTS.len() {
                let (mine, more) = rest.split_at(node.counts[list] as usize * RECORD_BYTES[list]);
                rest = more;
                let mut records = mine.chunks_exact(RECORD_BYTES[list]);
                if records.any(|r| (0..3).any(|k| r[k] >= node.cells[k])) {
                    return damaged(
                        "voxels",
                        offset,
                        format!("voxels within the grid of node {number}"),
                    );
                }
            }
        }
        self.is_checked[number].store(true, Ordering::Relaxed);
        Ok(())
    }
}

/// A place in a mapped file: within the address space, as the file's length is.
fn range([begin, end]: [u64; 2]) -> Range<usize> {
    begin as usize..end as usize
}

fn malformed(
    path: &Path,
    section: &'static str,
    offset: u64,
    expected: impl Into<String>,
    advice: &'static str,
) -> FarError {
    FarError::Malformed {
        file: path.to_owned(),
        section,
        offset,
        expected: expected.into(),
        advice,
    }
}

/// The header, decoded and checked.
struct Header {
    places: Layout,
    triangles: u64,
    centre: DVec3,
    distance_voxels: f64,
    leaf_triangles: u32,
    grid: u32,
    blends: [Blend; 2],
    y_up: bool,
    nodes_checksum: u64,
}

impl Header {
    /// Reads a header from the beginning of a file of `file_bytes`.
    fn read(beginning: &[u8], file_bytes: u64, path: &Path) -> Result<Self, FarError> {
        let ensure = |holds: bool, offset: usize, expected: String, advice: &'static str| {
            if holds {
                return Ok(());
            }
            Err(malformed(path, "header", offset as u64, expected, advice))
        };
        let signature = "the signature of a .far file".to_owned();
        ensure(is_far(beginning), 0, signature, NOT_OURS)?;
        let Some(header) = beginning.first_chunk::<HEADER_BYTES>() else {
            let expected = format!("{HEADER_BYTES} bytes, not {}", beginning.len());
            return Err(malformed(
                path,
                "header",
                beginning.len() as u64,
                expected,
                DAMAGED,
            ));
        };
        let eight = |offset: usize| -> [u8; 8] { std::array::from_fn(|i| header[offset + i]) };
        let u64_at = |offset: usize| u64::from_le_bytes(eight(offset));
        let f64_at = |offset: usize| f64::from_le_bytes(eight(offset));
        let u32_at =
            |offset: usize| u32::from_le_bytes(std::array::from_fn(|i| header[offset + i]));
        let version = u32_at(at::VERSION);
        let stored = u64_at(at::CHECKSUM);
        let sound = stored == xxh3_64(&header[..at::CHECKSUM]);
        // A sound header of another version is no damage.
        let expected = format!("version {VERSION}, not {version}");
        ensure(version == VERSION || !sound, at::VERSION, expected, NEWER)?;
        ensure(
            sound,
            at::CHECKSUM,
            format!("header checksum {stored:016x}"),
            DAMAGED,
        )?;
        let length = u32_at(at::HEADER_BYTES);
        let expected = format!("a header length of {HEADER_BYTES}, not {length}");
        ensure(
            length == HEADER_BYTES as u32,
            at::HEADER_BYTES,
            expected,
            DAMAGED,
        )?;
        let [nodes, voxel_bytes, triangles] =
            [at::NODES, at::VOXEL_BYTES, at::TRIANGLES].map(u64_at);
        let places = layout(nodes, voxel_bytes, triangles);
        let said = u64_at(at::FILE_BYTES);
        let expected = format!("a file of {said} bytes, not {file_bytes}");
        ensure(said == file_bytes, at::FILE_BYTES, expected, DAMAGED)?;
        let expected = format!("sections that end with the file at byte {file_bytes}");
        ensure(
            places.triangles[1] == file_bytes,
            at::NODES,
            expected,
            DAMAGED,
        )?;
        let spare = [at::SPARE, at::MORE_SPARE];
        let is_spare = spare.into_iter().all(|r| header[r].iter().all(|&b| b == 0));
        ensure(is_spare, at::SPARE.start, "zeros".to_owned(), DAMAGED)?;
        let centre = [0, 8, 16].map(|skip| f64_at(at::CENTRE + skip));
        let is_finite = centre.iter().all(|c| c.is_finite());
        ensure(is_finite, at::CENTRE, "finite numbers".to_owned(), DAMAGED)?;
        let distance_voxels = f64_at(at::DISTANCE);
        let is_distance = (1.0..=1e6).contains(&distance_voxels);
        ensure(
            is_distance,
            at::DISTANCE,
            "1 to 1,000,000 voxels".to_owned(),
            DAMAGED,
        )?;
        let (leaf_triangles, grid) = (u32_at(at::LEAF), u32_at(at::GRID));
        ensure(
            leaf_triangles >= 2,
            at::LEAF,
            "2 or more".to_owned(),
            DAMAGED,
        )?;
        ensure(
            (2..=255).contains(&grid),
            at::GRID,
            "2 to 255".to_owned(),
            DAMAGED,
        )?;
        let blend = |offset: usize| {
            let mut known = [Blend::Squares, Blend::Cosines].into_iter();
            let found = known.find(|&b| blend_byte(b) == header[offset]);
            found.ok_or_else(|| malformed(path, "header", offset as u64, "0 or 1", DAMAGED))
        };
        let blends = [blend(at::OPACITY_BLEND)?, blend(at::SHADER_BLEND)?];
        ensure(
            header[at::Y_UP] <= 1,
            at::Y_UP,
            "0 or 1".to_owned(),
            DAMAGED,
        )?;
        Ok(Self {
            places,
            triangles,
            centre: DVec3::from_array(centre),
            distance_voxels,
            leaf_triangles,
            grid,
            blends,
            y_up: header[at::Y_UP] == 1,
            nodes_checksum: u64_at(at::NODES_CHECKSUM),
        })
    }
}
