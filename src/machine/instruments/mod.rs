//! Instruments observe the machine, or drive its steps in another way than the record loop, for the hardware model,
//! experiments and tests. The machine does not import them.

mod descent;
mod directed;
mod directed_blending;
mod inputs;
#[cfg(feature = "mutants")]
pub mod mutants;
mod positions;
mod simulate;
mod vertices;
mod widths;

pub use positions::{Positions, Space, visit_positions};
pub use simulate::{MOST_OPEN_TILES, SimulateError, Simulated};
pub use vertices::{Cage, cages_along};
pub use widths::{NumberSpan, NumberSpans, ProvenWidths, RecordNumber, narrowed, proven_widths};
