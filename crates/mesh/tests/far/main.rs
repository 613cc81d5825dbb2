//! Far voxels: build, file, view.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

mod build;
mod city;
mod file;
mod golden;
#[path = "../shared/mod.rs"]
mod shared;
mod solid;
mod textures;
mod thin;
mod view;
