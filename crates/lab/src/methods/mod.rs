//! All methods on a mesh, side by side, from full screen to a few pixels.
//!
//! Each method is a [`Method`](crate::error::Method): triangles, decimated
//! triangles, the image-order engine on the voxelised mesh, far voxels, textured
//! voxels, the hybrid; another joins as one more function. They take part in [`error`](crate::error)
//! and [`flicker`](crate::flicker) too. The truth is the mesh's triangles with
//! 256 samples a pixel.

mod answers;
mod distance;
mod families;
mod measure;
mod plots;
mod tables;

pub use answers::{Answer, Rivals, answers, rivals, tables as answer_tables};
pub use distance::at_distance;
pub use families::{decimated, far, hybrid, opacity_in_words, textured, triangles};
pub use measure::{Distance, Facts, MeshMethods, MethodAtDistance, MethodsPlan, Outcome, measure};
pub use plots::panels;
pub use tables::{rows, table};
