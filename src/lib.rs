//! Image-order voxel-graph rendering with nothing but adders and shifts.
//!
//! See `ARCHITECTURE.md` for the floors and `SPEC.md` for the numeric rules.

pub mod drawing;
pub mod far;
pub mod fast;
pub mod frame;
pub mod graph;
pub mod lab;
pub mod machine;
pub mod measure;
pub mod mesh;
pub mod picture;
pub mod project;
pub mod rays;
pub mod report;
pub mod scene;
pub mod textured;
pub mod whole;

#[cfg(feature = "cli")]
pub mod cli;
