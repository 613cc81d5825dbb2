//! Run time against error.
//!
//! A [`Method`] draws; a [`Reference`] is what it should have drawn, made of
//! many exact rays; [`measure`] measures methods on a scene, error and time;
//! [`pareto`] says which of them are worth having.

mod method;
mod reference;
mod vertices;
mod voxels;

pub use method::{Method, Refused, Samples, Shown, VertexLevel, over_levels};
pub use reference::{MAX_REFERENCE_LEVELS, Reference, Sampling, cast};
pub use vertices::vertex_levels;
pub use voxels::{Look, VoxelMethod, tolerance_in_words};
