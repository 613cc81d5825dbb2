//! The voxel graph: trees, and graphs whose nodes have several parents or are cyclic.

mod average;
pub mod build;
pub mod cells;
mod crop;
pub mod external;
pub mod file;
mod layout;
mod linked;
pub mod map;
mod mesh_box;
mod morton;
mod normal;
mod normals;
mod opacity;
pub mod place;
mod prefetch;
mod pushed;
mod side_by_side;
mod store;
pub mod validate;
pub mod vxg;

pub use build::{BuildError, Builder};

pub use cells::Cell;
pub use crop::Crop;
pub use external::{ExternalBuilder, ExternalError, ExternalOptions, ExternalReport};
pub use layout::NodeLayout;
pub use linked::LinkedGraph;
pub use mesh_box::MeshBox;
pub(crate) use normal::KnownNormals;
pub use opacity::{MOST_OPACITY, Opacity, sixteenths};
pub use prefetch::prefetch;
pub use store::Store;
pub use validate::Invalid;

/// Deepest level that a graph may have: voxel coordinates stay within `i32`.
pub const MAX_DEPTH: u32 = 30;

/// The object's place in the file's indices and in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// File index of the object's lowest corner, in finest voxels; may be negative.
    pub origin_index: [i64; 3],
    /// World position of file index (0, 0, 0).
    pub world_origin: [f64; 3],
    /// World length of a finest voxel's side.
    pub voxel_size: f64,
    /// Of voxels made of a mesh: its box, for fitted cameras.
    pub mesh: Option<MeshBox>,
}

impl Placement {
    /// Object coordinates, finest voxels, of a point in world units.
    pub(crate) fn in_voxels(&self, point: glam::DVec3) -> [f64; 3] {
        [0, 1, 2].map(|k| {
            (point[k] - self.world_origin[k]) / self.voxel_size - self.origin_index[k] as f64
        })
    }
}

impl Default for Placement {
    fn default() -> Self {
        Self {
            origin_index: [0; 3],
            world_origin: [0.0; 3],
            voxel_size: 1.0,
            mesh: None,
        }
    }
}

/// A unit normal in two bytes (octahedral), or none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct PackedNormal(pub u16);

/// A voxel graph.
///
/// Nodes `0..mask.len()` may have children. Nodes from there up to `color.len()` are voxels of the finest level, which
/// have neither mask nor child list. A node without children is solid and, as in the image-order paper (section 2.2),
/// its own child. A node reached at level `depth` is a voxel, even if it has children: this ends a cyclic graph.
#[derive(Debug, Clone, Default)]
pub struct Graph {
    /// Levels below the root: the object is a cube of `2^depth` finest voxels a side.
    pub depth: u32,
    pub root: u32,
    /// Bit `c` of an inner node is set where child `c = x << 2 | y << 1 | z` exists. 0: a solid leaf.
    pub mask: Store<u8>,
    /// First child of the inner nodes: a node in a tree, an entry of `links` in a linked graph.
    pub first: Store<u32>,
    /// Child lists of a linked graph. Empty in a tree, where a node's children are `first`, `first + 1`, ... in
    /// octant order.
    pub links: Store<u32>,
    pub color: Store<[u8; 3]>,
    pub normal: Store<PackedNormal>,
    /// Opacity of each node; empty where all are opaque.
    pub opacity: Store<Opacity>,
    /// The first node of each level and the end, `depth + 2` entries; empty unless stored level by level.
    pub level_start: Vec<u32>,
    /// Voxels of the finest level, counted with repetition; saturates.
    pub voxels: u64,
    pub placement: Placement,
}

impl Graph {
    pub fn len(&self) -> usize {
        self.color.len()
    }

    pub fn is_empty(&self) -> bool {
        self.color.is_empty()
    }

    /// Black for a node that does not exist.
    #[inline]
    pub fn color_of(&self, node: u32) -> [u8; 3] {
        self.color.get(node as usize).copied().unwrap_or_default()
    }

    #[inline]
    pub fn normal_of(&self, node: u32) -> PackedNormal {
        self.normal.get(node as usize).copied().unwrap_or_default()
    }

    pub fn children(&self, node: u32) -> [Option<u32>; 8] {
        let view = self.view();
        let nodes = self.len() as u64;
        std::array::from_fn(|octant| {
            view.child(node, octant as u8)
                .filter(|&child| u64::from(child) < nodes)
        })
    }

    /// Bytes of the arrays, in memory or in the mapped file.
    pub fn bytes(&self) -> u64 {
        let sizes = [
            size_of_val::<[u8]>(&self.mask),
            size_of_val::<[u32]>(&self.first),
            size_of_val::<[u32]>(&self.links),
            size_of_val::<[[u8; 3]]>(&self.color),
            size_of_val::<[PackedNormal]>(&self.normal),
            size_of_val::<[Opacity]>(&self.opacity),
            size_of_val::<[u32]>(&self.level_start),
        ];
        sizes.iter().map(|&size| size as u64).sum()
    }

    pub fn view(&self) -> GraphView<'_> {
        GraphView {
            depth: self.depth,
            root: self.root,
            mask: &self.mask,
            first: &self.first,
            links: &self.links,
            opacity: &self.opacity,
            light: &[],
            is_in_order: self.is_level_ordered() && self.links.is_empty(),
        }
    }

    pub fn lit<'g>(&'g self, light: &'g [[u16; 3]]) -> GraphView<'g> {
        GraphView {
            light,
            ..self.view()
        }
    }
}

#[derive(Debug, Clone, Copy, Default)]
pub struct GraphView<'g> {
    pub depth: u32,
    pub root: u32,
    pub mask: &'g [u8],
    pub first: &'g [u32],
    pub links: &'g [u32],
    pub opacity: &'g [Opacity],
    /// Linear light by node, 0 to 65535 per channel (`SPEC.md`, section 11). Empty: white.
    pub light: &'g [[u16; 3]],
    /// A tree stored level by level, in which each child list follows that of the node before.
    pub is_in_order: bool,
}

impl GraphView<'_> {
    #[inline]
    pub fn mask(&self, node: u32) -> u8 {
        self.mask.get(node as usize).copied().unwrap_or(0)
    }

    #[inline]
    pub fn first(&self, node: u32) -> u32 {
        self.first.get(node as usize).copied().unwrap_or(0)
    }

    #[inline]
    pub fn opacity_of(&self, node: u32) -> Opacity {
        self.opacity.get(node as usize).copied().unwrap_or_default()
    }

    #[inline]
    pub fn light_of(&self, node: u32) -> [u16; 3] {
        let light = self.light.get(node as usize);
        light.copied().unwrap_or([u16::MAX; 3])
    }

    /// Child `octant` (`x << 2 | y << 1 | z`) of a node; none for a leaf.
    ///
    /// Never panics: in a damaged file, a child list that leaves the file reads as no child, a child without a node as a
    /// leaf.
    #[inline]
    pub fn child(&self, node: u32, octant: u8) -> Option<u32> {
        let mask = self.mask(node);
        if mask >> octant & 1 == 0 {
            return None;
        }
        let before = mask & ((1u8 << octant) - 1);
        let first = *self.first.get(node as usize)?;
        // Wraps only in a damaged file.
        let slot = first.wrapping_add(before.count_ones());
        if self.links.is_empty() {
            Some(slot)
        } else {
            self.links.get(slot as usize).copied()
        }
    }
}

/// Fills `[i, i+1) x [j, j+1) x [k, k+1)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Voxel {
    /// File index, finest voxels; may be negative.
    pub index: [i32; 3],
    pub color: [u8; 3],
    /// None: the file has none.
    pub normal: Option<PackedNormal>,
}

/// Receives the progress of long work, from any thread.
pub trait Progress: Sync {
    /// A piece of work with `steps` steps begins (0: unknown).
    fn begin(&self, what: &str, steps: u64);
    fn advance(&self, steps: u64);
    fn end(&self);
}

#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _what: &str, _steps: u64) {}
    fn advance(&self, _steps: u64) {}
    fn end(&self) {}
}
