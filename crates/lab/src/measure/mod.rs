//! How far two pictures are apart: colours, coverage, depths, and films of them.
//!
//! Each number is defined where it is computed. No number is rounded. Pictures of different sizes
//! are not compared.

mod color;
mod coverage;
mod flicker;
mod flip;
mod share;
mod spread;
mod ssim;

pub use color::{ColorError, Colors, difference};
pub use coverage::{CoverageError, count_differing, count_elsewhere};
pub use flicker::{Flicker, LinearPicture};
pub use flip::{Flip, FlipMap, PIXELS_PER_DEGREE};
pub use share::{CoverageBias, ShareError, Shares, is_thin};
pub use spread::Spread;

/// Why two pictures cannot be compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the pictures differ in size: {}x{} and {}x{}", a.0, a.1, b.0, b.1)]
pub struct SizeError {
    /// Width and height of the first.
    pub a: (u32, u32),
    /// Width and height of the second.
    pub b: (u32, u32),
}
