//! Words, datapath and counters of a light hardware: adders, shifts, logic
//! and compares; no multiplier, no divider, no floating point.
//!
//! This crate is the ground floor of `shiftvox`. It knows nothing of voxels
//! beyond the words *record*, *stage* and *level*.

#![forbid(unsafe_code)]

pub mod count;
mod datapath;
mod format;
pub mod probe;
mod word;

pub use datapath::{Datapath, Trap, TrapOp};
pub use format::{Format, FormatError, MAX_BITS, MIN_BITS, Overflow};
pub use probe::{Memory, NoProbe, OpClass, Place, Probe, Stage};
pub use word::{Number, WideWord, Word};
