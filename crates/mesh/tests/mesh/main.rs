//! Meshes: files to triangles, triangles to pixels, triangles to voxels.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

mod bad_files;
mod decimate;
mod files;
mod gltf;
mod opacities;
mod raster;
mod shapes;
#[path = "../shared/mod.rs"]
mod shared;
mod solids;
mod texels;
mod textures;
mod voxels;
mod watertight;
mod work;
