//! Times of engines, measured side by side.
//!
//! [`harness`] runs whoever competes in turn; [`mod@measure`] makes contenders
//! of scenes, sizes, engines and thread counts; the experiments [`engines`],
//! [`scaling`] and [`ablation`] define what is measured and how it is shown. Engines
//! are passed in as lists of [`Candidate`]s: no engine is named here.

pub mod ablation;
mod candidate;
mod clock;
pub mod engines;
pub mod harness;
pub mod measure;
mod power_law;
pub mod scaling;
mod scan;
mod statistics;

pub use candidate::{Candidate, Family, FetchedNodes, Frames, MakeEngine, Variant, fetched_nodes};
pub use clock::{Clock, Elapsed};
pub use harness::{BenchError, Contender, Drawer, Harness, Measured, Schedule};
pub use measure::{BenchPlan, Subject, Timing, measure};
pub use power_law::PowerLaw;
pub use scan::Scan;
pub use statistics::Summary;
