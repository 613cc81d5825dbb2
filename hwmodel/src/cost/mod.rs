//! What operations cost in area, time and energy, from tables in which every
//! row names its source.
//!
//! Two tables ship with the crate: `tables/area.toml` (gates, by synthesis
//! with an open standard-cell library) and `tables/energy.toml` (picojoules,
//! as published). Rows of a user's own come before both. Nothing is guessed
//! in silence: a [`Cost`] names the rows that it comes from and whether
//! it lies between or beyond them, and an operation without rows is an error.

mod rows;
mod span;
mod sums;
mod table;

pub use rows::{CostError, Goal, Quantity};
pub use span::MinMaxUnits;
pub use sums::{
    Breakdown, Costing, Line, ORDERED_OCTANTS, ShiftUnits, Store, Stores, Tally, Unit, area_of,
    energy_of, energy_of_tallies, memory_energy_of, operation_of, tallies,
};
pub use table::{Cost, CostTable, Fit};
