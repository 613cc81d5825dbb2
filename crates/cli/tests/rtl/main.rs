//! The hardware in `rtl/`, simulated, against the machine: blocks by the rows of `model --vectors` (Icarus Verilog), whole
//! frames by their events, picture and cycles (Verilator). `docs/rtl.md` has the results.
//!
//! The tests need `iverilog`, `verilator` and `yosys`, and fail without them; the long ones run with `--ignored`.
#![allow(clippy::unwrap_used, reason = "tests")]

mod area;
mod blocks;
mod faults;
mod frames;
mod machines;
mod simulate;
mod tools;
mod views;
