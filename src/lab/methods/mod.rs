//! All methods on a mesh, side by side, from full screen to a few pixels.
//!
//! Each method is a [`DrawingMethod`](crate::lab::error::DrawingMethod): triangles, the
//! image-order engine on the voxelised mesh, far voxels, textured voxels;
//! another joins as one more adaptor. They take part in [`error`](crate::lab::error)
//! and [`flicker`](crate::lab::flicker) too. The truth is the mesh's triangles with
//! 256 samples a pixel.

mod distance;
mod far;
mod measure;
#[cfg(feature = "cli")]
mod plots;
mod tables;
mod textured;
mod triangles;

pub use distance::at_distance;
pub use far::{FarMethod, FarSettings, opacity_in_words};
pub use measure::{Distance, Facts, MeshMethods, MethodAtDistance, MethodsPlan, measure};
#[cfg(feature = "cli")]
pub use plots::panels;
pub use tables::{rows, table};
pub use textured::TexturedMethod;
pub use triangles::TrianglesMethod;
