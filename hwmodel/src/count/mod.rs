//! Counts of operations, accesses and records.

mod counter;
mod sums;

pub use counter::{Counter, LEVELS};
pub use sums::{AccessCount, Accesses, OpCount};
