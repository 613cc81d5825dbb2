//! Instruments observe the machine, or drive its steps in another way, for the hardware model, experiments and tests.

mod descent;
mod directed;
mod directed_blending;
mod inputs;
#[cfg(feature = "mutants")]
pub mod mutants;
mod positions;
mod simulate;
mod widths;

pub use descent::{Cage, cages_along};
pub use positions::{Positions, Space, visit_positions};
pub use simulate::{MOST_OPEN_TILES, SimulateError, Simulated};
pub use widths::{NumberSpan, NumberSpans, ProvenWidths, RecordNumber, narrowed, proven_widths};
