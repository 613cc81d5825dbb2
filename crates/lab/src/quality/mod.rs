//! Cost and error of pictures: methods x cameras x samples.
//!
//! A [`Method`] draws. A [`Scene`] has the truth: exact rays, or a mesh's triangles at 256 samples
//! per pixel. [`measure()`] returns a row per method and camera, with time, error and flicker. It
//! reports which methods others beat.

mod compare;
mod families;
mod judge;
mod measure;
mod method;
mod motion;
mod reference;
mod voxels;

pub use families::{Triangles, far, hybrid, textured, triangles};
pub use measure::{QualityPlan, Scene, charts, measure, table};
pub use method::{Method, Refused};
pub use motion::{Motion, at_distance};
pub use voxels::voxel_method;
