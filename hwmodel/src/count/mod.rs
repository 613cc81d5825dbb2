//! Counts of operations, accesses and records: [`Counter`] is the probe that counts, [`OpCount`] and [`AccessCount`]
//! are what it hands out.

mod counter;
mod sums;

pub use counter::{Counter, LEVELS};
pub use sums::{AccessCount, Accesses, OpCount};
