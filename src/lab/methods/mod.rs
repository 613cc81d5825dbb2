//! All methods on a mesh, side by side, from full screen to a few pixels.
//!
//! Each method is a [`Method`](crate::lab::error::Method): triangles, the
//! image-order engine on the voxelised mesh, far voxels, textured voxels;
//! another joins as one more adaptor. The truth is the mesh's triangles with
//! 256 samples a pixel.

mod camera;
mod far;
mod measure;
#[cfg(feature = "cli")]
mod plots;
mod tables;
mod textured;
mod triangles;

pub use camera::{at_distance, key_light, view_of};
pub use far::FarMethod;
pub use measure::{Distance, Facts, MeshMethods, Plan, Row, measure};
#[cfg(feature = "cli")]
pub use plots::panels;
pub use tables::{rows, table};
pub use textured::TexturedMethod;
pub use triangles::TrianglesMethod;

use crate::mesh::raster::{NO_TRIANGLE, RasterPicture};
use crate::picture::Picture;

/// A rasterised picture as those of other engines, without normals, voxels and nodes.
#[must_use]
pub fn as_picture(drawn: RasterPicture) -> Picture {
    let pixels = drawn.rgba.len();
    let is_drawn = |&triangle: &u32| if triangle == NO_TRIANGLE { -1 } else { 0 };
    Picture {
        width: drawn.width,
        height: drawn.height,
        rgba: drawn.rgba,
        depth: drawn.depth,
        normal: vec![[0.0; 3]; pixels],
        voxel: vec![[0, 0, 0, -1]; pixels],
        node: drawn.triangle.iter().map(is_drawn).collect(),
        records: None,
    }
}
