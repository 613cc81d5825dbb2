//! The voxel graph and its file.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

mod external;
mod pages;
mod properties;
mod scale;
mod speed;
mod vxg;
