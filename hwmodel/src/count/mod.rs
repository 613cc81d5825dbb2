//! Counts of operations, accesses and records: the probe [`Counter`], and its cells [`OpCount`] and [`AccessCount`].

mod counter;
mod sums;

pub use counter::{Counter, LEVELS};
pub use sums::{AccessCount, Accesses, OpCount};
