//! How far two pictures are apart: colours, coverage, and films of them. No number is rounded.

mod color;
mod coverage;
mod flicker;
mod flip;
mod share;

pub use color::{ColorError, Colors, SizeError, difference};
pub use coverage::{CoverageError, count_differing};

pub(crate) use coverage::count_elsewhere;
pub(crate) use flicker::{Light, flicker, light_of};
pub(crate) use flip::Flip;
pub(crate) use share::CoverageBias;
