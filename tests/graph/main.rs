//! The voxel graph and its file.

mod properties;
mod scale;
mod speed;
mod vxg;
