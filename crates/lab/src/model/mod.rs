//! The hardware model: the cost of a frame on the light hardware, beside a ray caster.
//!
//! - [`frame`] draws a frame and counts its work, [`ray_caster`] does so with rays.
//! - [`cost`], [`area`] and [`standing`] price the counts; [`accelergy`] exchanges prices.
//! - [`verdict`] compares both at uncertain prices.
//! - [`clock`] compares units with the clock.
//! - [`report`] collects all that, and [`mod@explore`] repeats it over many designs.
//!
//! Functions fail when the cost tables lack a figure, or a word overflows and traps.

pub mod accelergy;
pub mod area;
pub mod clock;
pub mod cost;
pub mod design;
pub mod explore;
pub mod fill_bits;
pub mod frame;
pub mod ray_caster;
pub mod record;
pub mod report;
pub mod standing;
pub mod tables;
pub mod vectors;
pub mod verdict;

use hwmodel::cost::CostError;
use hwmodel::cycles::HardwareError;

use shiftvox::machine::SimulateError;
use shiftvox::project::{EngineError, SetupError};

/// Why the model has no result.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    #[error(transparent)]
    Setup(#[from] SetupError),
    #[error(transparent)]
    Engine(#[from] EngineError),
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    #[error(transparent)]
    Hardware(#[from] HardwareError),
    #[error(transparent)]
    Cost(#[from] CostError),
}
