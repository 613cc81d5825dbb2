//! Voxel files and generators.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

mod binvox;
mod generators;
mod input_support;
mod npy;
mod ply;
mod vox;
mod vox_graphs;
