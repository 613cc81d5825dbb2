//! Traffic to the machine's memories, and miss curves.

mod cache;
mod curve;
mod records;
mod traffic;

pub use cache::Cache;
pub use curve::{MissCurve, MissPoint};
pub use records::{RecordBits, RecordKind, RecordProbe};
pub use traffic::{ACCUMULATOR_BITS, MemoryProbe, PIXEL_BITS, Widths};
