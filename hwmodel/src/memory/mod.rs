//! Bits of the machine's records and accesses.

mod records;
mod widths;

pub use records::{RecordBits, RecordKind, RecordProbe};
pub use widths::{ACCUMULATOR_BITS, PIXEL_BITS, Widths};
