//! Reading a `.far` file: on demand, or all of it.

use std::io;
use std::mem::offset_of;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock};

use glam::DVec3;
use xxhash_rust::xxh3::xxh3_64;

use super::FarError;
use super::budget::{Budget, Resident};
use super::check::check;
use super::data::NodeData;
use super::format::{BLENDS, FIELDS, FORMAT, Fields, layout};
use super::pack::unpack;
use crate::Texture;
use crate::far::FarSettings;
use crate::far::record::Node;
use crate::geometry::point;
use crate::list::lock;
use crate::texture::stored;
use shiftvox::graph::MeshBox;
use shiftvox::graph::file::{self, Bytes, HEADER_BYTES, range};
use shiftvox::graph::map::release;
use shiftvox::graph::place::{MOST_PARTS, can_be_seen};

/// Linux's `fault_around_bytes`.
const BROUGHT_IN: u64 = 64 << 10;

/// An open `.far` file.
#[derive(Debug)]
pub struct FarFile {
    pub settings: FarSettings,
    path: PathBuf,
    bytes: Bytes,
    section: [u64; 2],
    texture_place: [u64; 2],
    textures: OnceLock<Vec<Arc<Texture>>>,
    nodes: Vec<Node>,
    /// Voxels and triangles are numbered from node to node.
    pub(in crate::far) first_voxel: Vec<u32>,
    pub(in crate::far) first_triangle: Vec<u32>,
    /// Of the nodes, where it is in memory.
    data: Vec<Mutex<Option<Arc<NodeData>>>>,
    budget: Option<Budget>,
}

impl FarFile {
    /// Maps a file and checks header and hierarchy.
    pub fn open(path: &Path) -> Result<Self, FarError> {
        let opened = file::open(path, HEADER_BYTES)?;
        read_header(&opened.beginning, opened.bytes, path)?;
        Self::of(Bytes::Mapped(opened.map()?), path)
    }

    /// Opens a file of which at most so many bytes of nodes' data are in memory at a time, or one larger node. An error
    /// where the system cannot release mapped pages.
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

    /// `None` without a budget.
    pub fn resident(&self) -> Option<Resident> {
        self.budget.as_ref().map(Budget::resident)
    }

    /// A file that is held in memory; it is named `(memory)` in errors.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FarError> {
        Self::of(Bytes::held(bytes), Path::new("(memory)"))
    }

    fn of(bytes: Bytes, path: &Path) -> Result<Self, FarError> {
        let all = bytes.get();
        let header = read_header(all, all.len() as u64, path)?;
        let places = layout(header.nodes, header.textures_bytes, header.data_bytes);
        let [place, texture_place, section] = places;
        FORMAT.check_padding(all, places.into_iter(), path)?;
        let damaged =
            |section, offset, expected| FarError::damaged(path, section, offset, expected);
        let node_bytes = &all[range(place)];
        if xxh3_64(node_bytes) != header.nodes_checksum {
            let expected = format!("checksum {:016x} of the hierarchy", header.nodes_checksum);
            return Err(damaged("hierarchy", place[0], expected));
        }
        let nodes: Vec<Node> = file::from_file(node_bytes);
        check(&nodes, section[1] - section[0], header.triangles).map_err(|(node, expected)| {
            let offset = place[0] + (node * size_of::<Node>()) as u64;
            let expected = format!("node {node} to have {expected}");
            damaged("hierarchy", offset, expected)
        })?;
        let file = Self {
            settings: FarSettings {
                centre: DVec3::from_array(header.centre),
                distance_voxels: header.distance_voxels,
                leaf_triangles: header.leaf_triangles,
                grid: header.grid,
                y_up: header.y_up == 1,
                bevels: header.bevels,
            },
            path: path.to_owned(),
            section,
            texture_place,
            textures: OnceLock::new(),
            first_voxel: first_of(&nodes, |node| node.voxels() as u32),
            first_triangle: first_of(&nodes, |node| node.surface),
            data: nodes.iter().map(|_| Mutex::default()).collect(),
            nodes,
            budget: None,
            bytes,
        };
        let (low, high) = file.bounds();
        let root = &file.nodes[0];
        let finest = (point(root.high) - point(root.low)).max_element() / MOST_PARTS;
        if !can_be_seen(low.to_array(), high.to_array(), finest) {
            let expected = "a centre from which the boxes of nodes can be told apart";
            return Err(damaged("header", CENTRE, expected.to_owned()));
        }
        Ok(file)
    }

    /// The hierarchy, parents before children; the root comes first.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// As they are stored.
    pub fn texture_bytes(&self) -> u64 {
        let [begin, end] = self.texture_place;
        end - begin
    }

    pub fn file_bytes(&self) -> u64 {
        self.section[1]
    }

    /// Lowest and highest corner of all triangles, world units.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let root = &self.nodes[0];
        let centre = self.settings.centre;
        (centre + point(root.low), centre + point(root.high))
    }

    /// The box for fitted cameras.
    pub fn mesh_box(&self) -> MeshBox {
        let (low, high) = self.bounds();
        let span = (low.to_array(), high.to_array());
        MeshBox::new(span, self.settings.bevels, self.settings.y_up)
    }

    pub fn voxels(&self) -> u32 {
        let last = self.nodes.len() - 1;
        self.first_voxel[last] + self.nodes[last].voxels() as u32
    }

    /// A node's voxels and triangles. An error if they are not as they were written.
    pub fn data(&self, number: usize) -> Result<Arc<NodeData>, FarError> {
        let here = lock(&self.data[number]).clone();
        let data = match here {
            Some(data) => data,
            None => {
                let data = Arc::new(self.unpacked(number)?);
                *lock(&self.data[number]) = Some(Arc::clone(&data));
                data
            }
        };
        if let Some(budget) = &self.budget {
            budget.touch(number, data.bytes(), |other| {
                *lock(&self.data[other]) = None
            });
        }
        Ok(data)
    }

    /// Those of all triangles. They are unpacked when they are first needed.
    pub(in crate::far) fn textures(&self) -> Result<&[Arc<Texture>], FarError> {
        if self.textures.get().is_none() {
            let place = self.texture_place;
            let textures = stored::from_bytes(&self.bytes.get()[range(place)]);
            let expected = "textures as they were written".to_owned();
            let damaged = || FarError::damaged(&self.path, "textures", place[0], expected);
            let _ = self.textures.set(textures.ok_or_else(damaged)?);
        }
        Ok(self.textures.get().map_or(&[], |textures| textures))
    }

    /// The same file with these textures in place of its own.
    pub(in crate::far) fn with_textures(self, textures: &[Arc<Texture>]) -> Self {
        let textures = OnceLock::from(textures.to_vec());
        Self { textures, ..self }
    }

    /// Checks the data of all nodes, and textures.
    pub fn verify(&self) -> Result<(), FarError> {
        let textures = self.textures()?.len();
        (0..self.nodes.len()).try_for_each(|node| {
            let data = self.data(node)?;
            let mut triangles = data.triangles().iter();
            match triangles.all(|triangle| triangle.paint.is_of(textures)) {
                true => Ok(()),
                false => {
                    let expected = format!("at most {textures} textures in node {node}");
                    let place = self.place_of(node)[0];
                    Err(FarError::damaged(&self.path, "data", place, expected))
                }
            }
        })
    }

    fn place_of(&self, number: usize) -> [u64; 2] {
        let [first, last] = self.section;
        let end = self.nodes.get(number + 1).map(|next| first + next.data_at);
        [first + self.nodes[number].data_at, end.unwrap_or(last)]
    }

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
            let end = place[1].next_multiple_of(BROUGHT_IN).min(self.file_bytes());
            let _ = release(map, begin as usize, (end - begin) as usize);
        }
        let expected = "voxels within the grid and triangles within the box of node";
        unpacked.ok_or_else(|| damaged(format!("{expected} {number}")))
    }
}

fn first_of(nodes: &[Node], items: impl Fn(&Node) -> u32) -> Vec<u32> {
    let mut next = 0;
    let first = |node| {
        let first = next;
        next += items(node);
        first
    };
    nodes.iter().map(first).collect()
}

const CENTRE: u64 = (FIELDS + offset_of!(Fields, centre)) as u64;

fn read_header(beginning: &[u8], file_bytes: u64, path: &Path) -> Result<Fields, FarError> {
    let header = FORMAT.read(beginning, file_bytes, path)?;
    let bytes = header.bytes_at::<{ size_of::<Fields>() }>(FIELDS);
    let fields = file::from_file::<Fields>(&bytes)[0];
    let ends = format!("sections that end with the file at byte {file_bytes}");
    let [.., [_, end]] = layout(fields.nodes, fields.textures_bytes, fields.data_bytes);
    let is_finite = fields.centre.iter().all(|c| c.is_finite());
    let is_spare = fields.spare == [0; 5];
    for (holds, offset, expected) in [
        (end == file_bytes, offset_of!(Fields, nodes), &ends[..]),
        (is_spare, offset_of!(Fields, spare), "zeros"),
        (is_finite, offset_of!(Fields, centre), "finite numbers"),
        (
            (1.0..=1e6).contains(&fields.distance_voxels),
            offset_of!(Fields, distance_voxels),
            "1 to 1,000,000 voxels",
        ),
        (
            fields.leaf_triangles >= 2,
            offset_of!(Fields, leaf_triangles),
            "2 or more",
        ),
        (
            (2..=255).contains(&fields.grid),
            offset_of!(Fields, grid),
            "2 to 255",
        ),
        (
            fields.blends == BLENDS,
            offset_of!(Fields, blends),
            "1 and 0",
        ),
        (fields.y_up <= 1, offset_of!(Fields, y_up), "0 or 1"),
    ] {
        header.ensure(holds, FIELDS + offset, || expected)?;
    }
    Ok(fields)
}
