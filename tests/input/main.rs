//! Voxel files and generators.

mod generators;
mod input_support;
mod npy;
mod ply;
mod vox_files;
mod vox_written;
