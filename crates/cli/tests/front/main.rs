//! The command line and the pictures it writes.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

mod bench;
mod buffers;
mod cases;
#[path = "../common/mod.rs"]
mod common;
mod damaged;
mod explore;
mod model;
mod one_camera;
mod printed;
mod program;
mod refusals;
mod resolve;
mod robust;
