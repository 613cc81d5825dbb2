//! Frame times of engines, measured side by side.
//! Engines are passed in as [`Candidate`]s; [`Harness`] runs them interleaved.

mod candidate;
mod clock;
mod harness;
mod power_law;
mod scan;
mod statistics;
mod time;

pub use candidate::{Candidate, Family, MakeEngine, Variant};
pub(crate) use clock::Clock;
pub use harness::{BenchError, Harness, Schedule};
pub(crate) use harness::{interleave, pool};
pub(crate) use power_law::PowerLaw;
pub use scan::Scan;
pub use statistics::Summary;
pub use time::{EVERYTHING_ON, Subject, TimePlan, charts, measure, table};
