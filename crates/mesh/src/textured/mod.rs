//! Textured voxels: a mesh as an approximate core of textured voxels, and true geometry around it.
//!
//! [`build()`] makes voxels with their primitives, erosion depths and six textures of half the scene. [`store`] is the
//! `.tvx` file, [`levels`] what a level of detail shows, and [`view`] draws it. Rules, and where Tellier and Baroud 2003
//! leaves a choice: `spec/textured.md`. Visibility of texels is decided in integers.

pub mod build;
pub mod cell_grid;
pub mod levels;
pub mod record;
pub mod store;
pub mod view;

pub use build::{BuildError, BuildOptions, build};
pub use cell_grid::CellGrid;
pub use store::{TexturedError, TexturedFile};

use std::sync::Arc;

use glam::DVec3;

use crate::Texture;
use crate::texture::paint::Paint;
use record::{Primitive, Texel, VoxelRecord};

/// The voxels that an erosion removes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Element {
    /// Those with an empty cell among the 26 around them.
    Cube,
    /// Those with an empty cell at one of their six sides, as in the table of Tellier and Baroud 2003
    /// (`spec/textured.md`).
    #[default]
    Sides,
}

/// Textured voxels in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct TexturedData {
    pub low: DVec3,
    pub high: DVec3,
    /// Whether +Y is up, for fitted cameras; else +Z.
    pub y_up: bool,
    pub bevels: [u8; 8],
    pub primitives: Vec<Primitive>,
    /// Of the primitives; none if none has a texture or lets light through.
    pub paints: Vec<Paint>,
    pub textures: Vec<Arc<Texture>>,
    /// The grids, coarse before fine, each of another number of cells.
    pub grids: Vec<GridData>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct GridData {
    pub cells: u32,
    pub texels: u32,
    pub element: Element,
    /// By erosion depth and then by cell.
    pub voxels: Vec<VoxelRecord>,
    /// The primitives of each voxel in rising order, voxel after voxel.
    pub lists: Vec<u32>,
    /// Sub-textures, each `texels * texels`, row after row.
    pub textures: Vec<Texel>,
    /// Texels that primitives were projected on, once along each axis.
    pub projected: u64,
    /// The same, had each volume been projected afresh.
    pub projected_afresh: u64,
}
