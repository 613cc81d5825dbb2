//! Area, delay and energy of operations, from tables in which every row names its source.
//!
//! The crate ships `tables/area.toml` (gates, by synthesis with an open standard-cell library) and `tables/energy.toml`
//! (picojoules, as published). A user's own rows take precedence. A [`Cost`] names its rows and whether it lies between
//! or beyond them; an operation without rows is an error.

mod rows;
mod sums;
mod table;

pub use rows::{CostError, Goal, Quantity};
pub use sums::{
    Breakdown, Costing, Line, ShiftUnits, Store, Stores, Tally, energy_of, energy_of_tallies,
    memory_energy_of, operation_of, tallies,
};
pub use table::{Cost, CostTable, Fit};
