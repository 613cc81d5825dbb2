//! The hardware model: the cost of a frame on the light hardware, beside a ray caster with multipliers.
//!
//! [`frame`] draws a frame and counts it. [`ray_caster`] does the same with rays. [`cost`] and [`area`] turn counts into
//! energy and area. [`clock`] compares the units with the clock. [`mod@floor`] is a lower bound for every design.
//! [`report`] collects all of that. [`mod@explore`] repeats it over many designs, words, rules and sizes. [`vectors`] writes
//! the inputs and outputs of the machine's blocks.

pub mod area;
pub mod clock;
pub mod compare;
pub mod cost;
pub mod design;
pub mod explore;
pub mod fill_bits;
pub mod floor;
pub mod frame;
pub mod heat;
pub mod plots;
pub mod range;
pub mod ray_caster;
pub mod ray_cycles;
pub mod record;
pub mod report;
pub mod safe;
pub mod tables;
pub mod vectors;

use hwmodel::cost::CostError;
use hwmodel::cycles::HardwareError;

use shiftvox::machine::SimulateError;
use shiftvox::project::{EngineError, SetupError};

/// Why the model has no result.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The frame cannot be set up.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The machine could not finish the frame.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The hardware could not finish it.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The hardware's description is not sound.
    #[error(transparent)]
    Hardware(#[from] HardwareError),
    /// A figure is missing in the cost tables.
    #[error(transparent)]
    Cost(#[from] CostError),
}
