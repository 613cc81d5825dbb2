//! Textured voxels: build, levels, file, view.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

mod file;
mod golden;
mod levels;
mod scenes;
#[path = "../shared/mod.rs"]
mod shared;
mod textures;
mod view;
