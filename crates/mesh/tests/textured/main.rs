//! Textured voxels: build, levels, file, view, command line.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

mod auto;
mod file;
mod levels;
mod models;
mod scenes;
#[path = "../shared/mod.rs"]
mod shared;
mod textures;
mod view;
