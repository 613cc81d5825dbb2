//! Area, delay and energy of operations, from tables in which every row names its source (`tables/*.toml`, and a user's).

mod estimator;
mod leakage;
mod rows;
mod sram;
mod sums;
mod table;
mod technology;

pub use estimator::{Attributes, Estimator};
pub use leakage::Standing;
pub use rows::{CostError, Goal, Quantity, Spread};
pub use sram::MemoryShape;
pub use sums::{
    Breakdown, Line, Store, Tally, energy_of, energy_of_tallies, memory_energy_of, operation_of,
    tallies, unit_of,
};
pub use table::{Cost, CostTable, Fit};
pub use technology::Technology;
