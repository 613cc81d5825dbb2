//! The hardware in `rtl/`, simulated, against the machine: blocks by the rows of `model --vectors` (Icarus
//! Verilog), whole frames by their events, picture and cycles (Verilator). `docs/rtl.md` has the results.
//!
//! Where a simulator is not installed its tests say so and pass. The long set:
//!
//! ```text
//! cargo test --release --test rtl -- --ignored --nocapture
//! ```
#![allow(clippy::unwrap_used, reason = "tests")]

mod area;
mod blocks;
mod bricks;
mod energy;
mod faults;
mod frames;
mod hidden;
mod lanes;
mod machines;
mod mutants;
mod testbench;
mod tools;
mod turned;
mod views;
