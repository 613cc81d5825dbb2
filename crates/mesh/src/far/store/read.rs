//! Reading a `.far` file: on demand, or all of it.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use xxhash_rust::xxh3::xxh3_64;

use super::FarError;
use super::budget::{Budget, Resident};
use super::check::check;
use super::data::{NodeData, Slot};
use super::format::{FORMAT, Layout, at, layout};
use super::pack::unpack;
use super::write::blend_byte;
use crate::far::blend::Blend;
use crate::far::record::Node;
use shiftvox::graph::MeshBox;
use shiftvox::graph::file::{self, Bytes, HEADER_BYTES, check_padding, range};
use shiftvox::graph::map::release;
use shiftvox::graph::place::{MOST_PARTS, can_be_seen};

/// Bytes that the system maps at a time, where it has them: Linux's `fault_around_bytes`.
const BROUGHT_IN: u64 = 64 << 10;

/// An open `.far` file.
#[derive(Debug)]
pub struct FarFile {
    path: PathBuf,
    bytes: Bytes,
    places: Layout,
    nodes: Vec<Node>,
    /// Number of each node's first voxel, over all nodes.
    first_voxel: Vec<u32>,
    /// Number of the first triangle that each node draws, over all nodes.
    first_triangle: Vec<u32>,
    /// Each node's data, once it was needed.
    data: Vec<Slot>,
    /// What limits how much of the data is in memory, if anything does.
    budget: Option<Budget>,
    centre: DVec3,
    distance_voxels: f64,
    blends: [Blend; 2],
    leaf_triangles: u32,
    grid: u32,
    y_up: bool,
    bevels: [u8; 8],
}

impl FarFile {
    /// Opens a file: maps it and checks header and hierarchy.
    ///
    /// # Errors
    /// When it cannot be read, is something else, is truncated, or a field of header or
    /// hierarchy is not as it should be.
    pub fn open(path: &Path) -> Result<Self, FarError> {
        let refused = |refused| FarError::refused(path, refused);
        let opened = file::open(path, HEADER_BYTES).map_err(refused)?;
        Header::read(&opened.beginning, opened.bytes, path)?;
        Self::of(Bytes::Mapped(opened.map().map_err(refused)?), path)
    }

    /// Opens a file of which at most so many bytes of nodes' data are in memory, unpacked,
    /// at a time (a node that is larger is there alone). Header and hierarchy,
    /// pictures and what nodes are in use at the moment come on top.
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

    /// A file that is held in memory; it is named `(memory)` in errors.
    ///
    /// # Errors
    /// As [`FarFile::open`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FarError> {
        Self::of(Bytes::held(bytes), Path::new("(memory)"))
    }

    fn of(bytes: Bytes, path: &Path) -> Result<Self, FarError> {
        FORMAT.check_byte_order(path)?;
        let all = bytes.get();
        let header = Header::read(all, all.len() as u64, path)?;
        let places = header.places;
        let sections = [places.nodes, places.data];
        check_padding(all, sections.into_iter(), path)?;
        let node_bytes = &all[range(places.nodes)];
        if xxh3_64(node_bytes) != header.nodes_checksum {
            let expected = format!("checksum {:016x} of the hierarchy", header.nodes_checksum);
            return Err(FarError::damaged(
                path,
                "hierarchy",
                places.nodes[0],
                expected,
            ));
        }
        let nodes: Vec<Node> = bytemuck::pod_collect_to_vec(node_bytes);
        if let Some(root) = nodes.first() {
            let corner =
                |c: [f32; 3]| (header.centre + DVec3::from_array(c.map(f64::from))).to_array();
            let extents = [0, 1, 2].map(|k| f64::from(root.high[k]) - f64::from(root.low[k]));
            let finest = extents.into_iter().fold(0.0, f64::max) / MOST_PARTS;
            if !can_be_seen(corner(root.low), corner(root.high), finest) {
                let expected = "a centre from which the boxes of nodes can be told apart";
                return Err(FarError::damaged(
                    path,
                    "header",
                    at::CENTRE as u64,
                    expected,
                ));
            }
        }
        check(&nodes, places.data[1] - places.data[0], header.triangles).map_err(|fault| {
            let offset = places.nodes[0] + (fault.node * size_of::<Node>()) as u64;
            let expected = format!("node {} to have {}", fault.node, fault.expected);
            FarError::damaged(path, "hierarchy", offset, expected)
        })?;
        // Checked: fewer than 2^32 of all.
        let first_voxel = first_of(&nodes, |node| node.voxels() as u32);
        let first_triangle = first_of(&nodes, |node| node.surface);
        Ok(Self {
            path: path.to_owned(),
            budget: None,
            data: nodes.iter().map(|_| Slot::default()).collect(),
            places,
            nodes,
            first_voxel,
            first_triangle,
            centre: header.centre,
            distance_voxels: header.distance_voxels,
            blends: header.blends,
            leaf_triangles: header.leaf_triangles,
            grid: header.grid,
            y_up: header.y_up,
            bevels: header.bevels,
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
        self.places.data[1]
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

    /// What fitted cameras look at.
    #[must_use]
    pub fn mesh_box(&self) -> MeshBox {
        let (low, high) = self.bounds();
        MeshBox {
            low: low.to_array(),
            high: high.to_array(),
            bevels: self.bevels,
            y_up: self.y_up,
        }
    }

    /// Number of a node's first voxel, over all nodes.
    pub(in crate::far) fn first_voxel(&self, node: usize) -> u32 {
        self.first_voxel[node]
    }

    /// Number of the first triangle that a node draws, over all nodes.
    pub(in crate::far) fn first_triangle(&self, node: usize) -> u32 {
        self.first_triangle[node]
    }

    /// Voxels of all nodes.
    #[must_use]
    pub fn voxels(&self) -> u32 {
        let last = self.nodes.len() - 1;
        // Checked: fewer than 2^32 of all.
        self.first_voxel[last] + self.nodes[last].voxels() as u32
    }

    /// A node's voxels or triangles.
    ///
    /// # Errors
    /// When they are not as they were written.
    pub fn data(&self, number: usize) -> Result<Arc<NodeData>, FarError> {
        let slot = &self.data[number];
        let data = match slot.get() {
            Some(data) => data,
            None => {
                let data = Arc::new(self.unpacked(number)?);
                slot.set(Some(Arc::clone(&data)));
                data
            }
        };
        if let Some(budget) = &self.budget {
            budget.touch(number, data.bytes(), |other| self.data[other].set(None));
        }
        Ok(data)
    }

    /// Checks the data of all nodes.
    ///
    /// # Errors
    /// At the first node whose data is not as it was written.
    pub fn verify(&self) -> Result<(), FarError> {
        (0..self.nodes.len()).try_for_each(|node| self.data(node).map(drop))
    }

    /// Where a node's data is in the file.
    fn place_of(&self, number: usize) -> [u64; 2] {
        let [first, last] = self.places.data;
        let end = self.nodes.get(number + 1).map(|next| first + next.data_at);
        [first + self.nodes[number].data_at, end.unwrap_or(last)]
    }

    /// Reads a node's data, and checks it.
    fn unpacked(&self, number: usize) -> Result<NodeData, FarError> {
        let node = &self.nodes[number];
        let place = self.place_of(number);
        let packed = &self.bytes.get()[range(place)];
        let damaged = |expected: String| FarError::damaged(&self.path, "data", place[0], expected);
        if xxh3_64(packed) != node.checksum {
            let expected = format!("checksum {:016x} of node {number}", node.checksum);
            return Err(damaged(expected));
        }
        let unpacked = unpack(packed, node);
        let unpacked = unpacked.and_then(|(records, own)| NodeData::of(node, records, own));
        if let (Some(_), Bytes::Mapped(map)) = (&self.budget, &self.bytes) {
            let begin = place[0] / BROUGHT_IN * BROUGHT_IN;
            let end = place[1].next_multiple_of(BROUGHT_IN).min(self.len());
            // It did at the beginning; a page more in memory does no harm.
            let _ = release(map, begin as usize, (end - begin) as usize);
        }
        let expected = "voxels within the grid and triangles within the box of node";
        unpacked.ok_or_else(|| damaged(format!("{expected} {number}")))
    }
}

/// The number of each node's first item, if items are counted on from node to node.
fn first_of(nodes: &[Node], items: impl Fn(&Node) -> u32) -> Vec<u32> {
    let mut next = 0;
    let first = |node| {
        let first = next;
        next += items(node);
        first
    };
    nodes.iter().map(first).collect()
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
    bevels: [u8; 8],
    nodes_checksum: u64,
}

impl Header {
    /// Reads a header from the beginning of a file of `file_bytes`.
    fn read(beginning: &[u8], file_bytes: u64, path: &Path) -> Result<Self, FarError> {
        let header = FORMAT.read(beginning, file_bytes, path)?;
        let [nodes, data_bytes, triangles] =
            [at::NODES, at::DATA_BYTES, at::TRIANGLES].map(|at| header.u64_at(at));
        let places = layout(nodes, data_bytes);
        header.ensure(places.data[1] == file_bytes, at::NODES, || {
            format!("sections that end with the file at byte {file_bytes}")
        })?;
        let is_spare = header.is_zero(at::SPARE) && header.is_zero(at::MORE_SPARE);
        header.ensure(is_spare, at::SPARE.start, || "zeros")?;
        let centre = DVec3::from_array(header.f64s_at(at::CENTRE));
        header.ensure(centre.is_finite(), at::CENTRE, || "finite numbers")?;
        let [distance_voxels] = header.f64s_at(at::DISTANCE);
        let is_distance = (1.0..=1e6).contains(&distance_voxels);
        header.ensure(is_distance, at::DISTANCE, || "1 to 1,000,000 voxels")?;
        let (leaf_triangles, grid) = (header.u32_at(at::LEAF), header.u32_at(at::GRID));
        header.ensure(leaf_triangles >= 2, at::LEAF, || "2 or more")?;
        header.ensure((2..=255).contains(&grid), at::GRID, || "2 to 255")?;
        let blend = |offset: usize| {
            let mut known = [Blend::Squares, Blend::Cosines].into_iter();
            let found = known.find(|&b| blend_byte(b) == header.byte_at(offset));
            found.ok_or_else(|| FarError::damaged(path, "header", offset as u64, "0 or 1"))
        };
        let blends = [blend(at::OPACITY_BLEND)?, blend(at::SHADER_BLEND)?];
        header.ensure(header.byte_at(at::Y_UP) <= 1, at::Y_UP, || "0 or 1")?;
        let bevels = header.bytes_at(at::BEVELS);
        Ok(Self {
            places,
            triangles,
            centre,
            distance_voxels,
            leaf_triangles,
            grid,
            blends,
            y_up: header.byte_at(at::Y_UP) == 1,
            bevels,
            nodes_checksum: header.u64_at(at::NODES_CHECKSUM),
        })
    }
}
