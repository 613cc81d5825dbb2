//! Traffic to the machine's memories.

mod records;
mod traffic;

pub use records::{RecordBits, RecordKind, RecordProbe};
pub use traffic::{ACCUMULATOR_BITS, MemoryProbe, PIXEL_BITS, Widths};
