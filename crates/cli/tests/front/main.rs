//! Tests of the program: command lines, and the files that it writes.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

mod bench;
mod cases;
mod compared;
mod damaged;
mod explore;
mod faults;
mod model;
mod one_camera;
mod printed;
mod program;
mod resolve;
mod robust;
mod stopped;
