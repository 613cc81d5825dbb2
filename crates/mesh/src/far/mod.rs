//! Far voxels (`spec/far.md`): a mesh as a hierarchy whose inner nodes are grids of voxels that look from afar like the
//! geometry in them, and whose leaves are triangles. Real numbers are allowed here.

mod blend;
pub mod build;
pub mod record;
pub mod store;
pub mod view;

use std::sync::Arc;

use glam::DVec3;

use crate::Texture;
use record::Node;

pub use build::{BuildError, BuildOptions, build, build_outside};
pub use store::{FarError, FarFile};

/// Far voxels in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct FarData {
    pub settings: FarSettings,
    /// The hierarchy, parents before children, a node's first child right after it.
    pub nodes: Vec<Node>,
    /// Of the triangles, by number.
    pub textures: Vec<Arc<Texture>>,
    /// The nodes' data, node by node, as it is stored.
    pub packed: Vec<u8>,
    /// Nodes of a hybrid whose triangles could not be decimated, so that they have voxels. No file has this number.
    pub undecimated: u32,
}

/// The settings of all nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FarSettings {
    /// Single precision coordinates are relative to it, world units.
    pub centre: DVec3,
    /// Least distance from which a node may be used, in its voxels.
    pub distance_voxels: f64,
    /// Nodes with fewer triangles are leaves.
    pub leaf_triangles: u32,
    /// Voxels along the longest side of a node.
    pub grid: u32,
    /// Whether +Y is up, for fitted cameras; else +Z.
    pub y_up: bool,
    /// For fitted cameras too: [`MeshBox::bevels`](shiftvox::graph::MeshBox::bevels).
    pub bevels: [u8; 8],
}

impl FarData {
    pub fn triangles(&self) -> u64 {
        self.nodes.first().map_or(0, |root| root.triangles.into())
    }
}
