//! Run time against error.
//!
//! A [`Method`] draws; a [`Reference`] is what it should have drawn, made of
//! many exact rays, or of a mesh at 256 samples a pixel; [`measure()`] measures methods on a scene,
//! error and time; [`beaten_by`] and the plots show which of them are worth having.

mod cut;
mod measure;
mod method;
mod pareto;
mod picture_error;
mod reference;
mod tables;
mod vertices;
mod voxels;

pub use cut::cut_at;
pub use measure::{
    ErrorPlan, MethodErrors, Outcome, References, SampleError, SceneErrors, measure,
};
pub(crate) use measure::{as_map, outcome_or_reason, race};
pub use method::{
    Examine, Examined, Method, Refused, Samples, Sum, VertexLevel, WithCutOf, over_levels,
};
pub(crate) use method::{drawn, sums};
pub use pareto::panels;
pub use pareto::{beaten_by, dominated};
pub use picture_error::{Judge, PictureError};
pub(crate) use reference::of_triangles;
pub use reference::{MAX_REFERENCE_LEVELS, Reference, Sampling, cast};
pub use tables::{rows, table, vertex_table};
pub use vertices::vertex_levels;
pub use voxels::{PixelStyle, tolerance_in_words, voxel_method};
