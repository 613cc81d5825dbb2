//! Meshes, far voxels and textured voxels by the command line.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

#[path = "../common/mod.rs"]
mod common;
mod compared;
mod far_stopped;
#[allow(dead_code, reason = "the mesh crate's tests use the rest")]
#[path = "../../../mesh/tests/mesh/shapes.rs"]
mod shapes;
