//! Meshes: read from files, drawn as triangles, turned into voxels.
//!
//! - [`read`] makes a [`Mesh`] of an OBJ, PLY, STL or glTF file.
//! - [`raster`] draws it with a depth buffer, as a reference.
//! - [`voxelize`] finds every voxel that a triangle touches.
//! - [`far`] and [`textured`] voxels replace it at a distance.
//!
//! Rules: `spec/mesh.md`.

mod builder;
#[doc(hidden)]
pub mod decimate;
#[doc(hidden)]
pub mod drawing;
#[doc(hidden)]
pub mod far;
#[doc(hidden)]
pub mod generate;
mod geometry;
mod list;
mod load;
mod material;
#[doc(hidden)]
pub mod open;
pub mod raster;
mod scene_options;
mod surface;
mod texture;
#[doc(hidden)]
pub mod textured;
#[doc(hidden)]
pub mod view_error;
#[doc(hidden)]
pub mod voxelize;

use glam::DVec3;
use list::List;
pub use shiftvox::scene::{FileKind as MeshFormat, SceneError};

pub use builder::MeshBuilder;
pub use geometry::barycentric;
pub use list::ListFolder;
pub use load::{Beside, no_files, read, same_folder};
pub use material::{ColorSpace, Material, linear_to_srgb, srgb_to_linear};
pub use scene_options::SceneOptions;
pub use surface::{Instances, Surface, Triangle, mesh_box};
pub use texture::{Sampler, Texture};

/// Triangles with materials, in the file's own coordinates.
///
/// A [`MeshBuilder`] makes sure that every index is in range, every coordinate finite and every area above zero.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    pub(crate) positions: List<[f64; 3]>,
    pub(crate) triangles: List<[u32; 3]>,
    pub(crate) material_of: List<u32>,
    pub(crate) materials: Vec<Material>,
    pub(crate) corner_normals: List<[[f32; 3]; 3]>,
    pub(crate) vertex_colors: List<[u8; 3]>,
    /// Places of each triangle's corners in its texture, in sizes of the picture from its top left corner; not numbers
    /// where a triangle has none. Or nothing.
    pub(crate) places: List<[[f32; 2]; 3]>,
    /// Colour of the middle of each triangle, linear light, for decimation; or nothing.
    pub(crate) tints: List<[f32; 3]>,
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
    pub(crate) warnings: Vec<String>,
}

impl Mesh {
    /// Vertex positions, finite.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// Three positions a triangle, counter-clockwise where seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The material of each triangle: an index of [`Mesh::materials`].
    pub fn material_of(&self) -> &[u32] {
        &self.material_of
    }

    /// The materials; at least one.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// Unit normals of each triangle's corners, or nothing: then a triangle has its plane's.
    pub fn corner_normals(&self) -> &[[[f32; 3]; 3]] {
        &self.corner_normals
    }

    /// sRGB colour of each position, which multiplies the material's, or nothing.
    pub fn vertex_colors(&self) -> &[[u8; 3]] {
        &self.vertex_colors
    }

    /// Lowest and highest corner of all triangles.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        (self.low, self.high)
    }

    /// Warnings about the file, one sentence each.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    pub(crate) fn find_bounds(&mut self) {
        let corners = self.triangles.iter().flatten();
        let points = corners.map(|&corner| geometry::point(self.positions[corner as usize]));
        (self.low, self.high) = geometry::bounds(points);
    }

    /// Bytes of memory that the mesh takes.
    pub fn bytes(&self) -> u64 {
        let sizes = [
            self.positions.bytes(),
            self.triangles.bytes(),
            self.material_of.bytes(),
            self.corner_normals.bytes(),
            self.vertex_colors.bytes(),
            self.places.bytes(),
            self.tints.bytes(),
        ];
        let lists: u64 = sizes.iter().map(|&size| size as u64).sum();
        lists
            + self
                .textures()
                .iter()
                .map(|texture| texture.bytes())
                .sum::<u64>()
    }
}
