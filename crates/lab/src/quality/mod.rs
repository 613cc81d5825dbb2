//! Cost and error of pictures: methods x cameras x samples.
//!
//! A [`Method`] draws. A [`Scene`] has the truth: exact rays, or a mesh's triangles at 256 samples
//! per pixel. [`measure()`] returns a row per method and camera, with time, error and flicker. It
//! reports which methods others beat.

mod compare;
mod cut;
mod families;
mod film;
mod judge;
mod measure;
mod method;
mod motion;
mod reference;
mod vertices;
mod voxels;

pub use compare::answers;
pub use cut::cut_at;
pub use families::{Triangles, far, hybrid, textured, triangles};
pub use judge::{Judge, PictureError};
pub use measure::{NOISE_FLOOR, QualityPlan, Scene, measure, panels, table};
pub use method::{Examine, Examined, Method, Refused, Samples, WithCutOf};
pub use motion::{Motion, at_distance};
pub use reference::{MAX_REFERENCE_LEVELS, Reference, Sampling, cast};
pub use vertices::vertex_errors;
pub use voxels::{PixelStyle, tolerance_in_words, voxel_method};
