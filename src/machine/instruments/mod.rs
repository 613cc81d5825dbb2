//! Instruments observe the machine, or drive its steps in another way, for the hardware model, experiments and tests.

mod directed;
mod positions;
mod simulate;
mod widths;

pub use positions::{Cage, Coordinates, cages_along};
pub use simulate::{SimulateError, Simulated};
pub use widths::{NumberSpan, NumberSpans, ProvenWidths, RecordNumber, narrowed, proven_widths};
