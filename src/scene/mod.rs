//! Where voxels come from.

pub mod generate;
