//! Frame times of engines, measured side by side.
//!
//! [`mod@time`] makes contenders of scenes, sizes, engines, switches and numbers of threads;
//! [`harness`] runs them interleaved. Engines are passed in as [`Candidate`]s: none is named here.

mod candidate;
mod clock;
pub mod harness;
mod power_law;
mod scan;
mod statistics;
pub mod time;

pub use candidate::{Candidate, Family, FetchedNodes, Frames, MakeEngine, Variant, fetched_nodes};
pub use clock::{Clock, Elapsed};
pub use harness::{BenchError, Contender, Drawer, Harness, Schedule, Times, interleave, pool};
pub use power_law::PowerLaw;
pub use scan::Scan;
pub use statistics::Summary;
pub use time::{EVERYTHING_ON, Subject, TimePlan, measure, panels, table};
