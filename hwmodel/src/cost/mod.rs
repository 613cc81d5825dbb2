//! Area, delay and energy of operations, from tables in which every row names its source (`tables/*.toml`, and a user's).

mod rows;
mod sram;
mod sums;
mod table;

pub use rows::{CostError, Goal, Quantity, Spread};
pub use sram::MemoryShape;
pub use sums::{
    Breakdown, Line, ShiftUnits, Store, Tally, energy_of, energy_of_tallies, memory_energy_of,
    operation_of,
};
pub use table::{Cost, CostTable, Fit};
