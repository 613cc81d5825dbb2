//! Meshes: files to triangles, triangles to pixels, triangles to voxels.

mod bad_files;
mod command;
mod files;
mod models;
mod raster;
mod shapes;
mod voxels;
