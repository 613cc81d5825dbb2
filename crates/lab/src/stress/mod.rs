//! Numerical stability: frames of many word formats, cameras, scenes and rules against the oracle, the specification and
//! the bounds on their error (`spec/lab.md`). A failing [`Case`] is a line of text.

mod case;
mod check;
mod findings;
mod outcome;
mod scene;
mod specified;
mod subject;
mod sweep;
mod tables;
mod vertex;
mod viewpoint;

pub use case::Case;
pub use check::PATIENCE;
pub use findings::{Failed, Findings, Key, Tally};
pub use outcome::{Check, End, Failure, Outcome};
pub use scene::StressScene;
pub use sweep::{SweepPlan, TOLERANCES, run_case, sweep};
pub use tables::TABLES;
pub use vertex::{Hold, Worst};

#[cfg(test)]
mod mutants;
