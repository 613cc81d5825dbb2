//! Far voxels: build, file, view, command line.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

mod build;
mod city;
mod command;
mod file;
mod hybrid;
mod models;
mod samples;
mod solid;
mod stopped;
mod view;
