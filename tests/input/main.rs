//! Voxel files and generators.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

mod generators;
mod input_support;
mod npy;
mod ply;
mod vox_damaged;
mod vox_files;
mod vox_graphs;
mod vox_shared;
mod vox_written;
