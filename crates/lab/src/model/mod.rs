//! The hardware model's report: what a frame costs on the light hardware, and
//! what a ray caster with multipliers would cost instead.
//!
//! [`frame`] draws a frame and has everything counted; [`ray_caster`] does the same
//! with the ray caster; [`cost`] turns counts into energy and area, [`clock`] compares the
//! units with the clock, [`design`] does all of that; [`rules`],
//! [`sweep`], [`caches`] and [`growth`] repeat that over cages and drawing rules, over word
//! formats, over sizes of the node cache, and over pictures and objects; [`steps`] over the settings
//! of a hardware's organisation; [`mod@explore`] over many designs; [`floor`] says what every
//! design must move; [`claims`] compares the image-order
//! paper's statements with the counts. The other files present it: as tables, as statistics, as a page.

pub mod area;
pub mod caches;
pub mod claims;
pub mod clock;
pub mod compare;
pub mod cost;
pub mod design;
pub mod explore;
pub mod fill_bits;
pub mod floor;
pub mod frame;
pub mod growth;
pub mod heat;
pub mod plots;
pub mod range;
pub mod ray_caster;
pub mod ray_cycles;
pub mod record;
pub mod rules;
pub mod safe;
pub mod statistics;
pub mod steps;
pub mod sweep;
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
    /// The hardware could not.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The hardware's description is not sound.
    #[error(transparent)]
    Hardware(#[from] HardwareError),
    /// A figure is missing in the cost tables.
    #[error(transparent)]
    Cost(#[from] CostError),
}

/// Infinity, which JSON has not, as the word `inf`.
pub(crate) fn infinity_as_word<S: serde::Serializer>(
    value: &f64,
    to: S,
) -> Result<S::Ok, S::Error> {
    if value.is_infinite() {
        to.serialize_str("inf")
    } else {
        to.serialize_f64(*value)
    }
}
