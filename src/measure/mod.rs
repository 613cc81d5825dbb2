//! How far two pictures are apart: colours and coverage.
//!
//! What each number is, is written where it is computed; none of them is
//! rounded. Pictures of different sizes are not compared.

mod color;
mod coverage;
mod ssim;

pub use color::{ColorError, Colors, difference};
pub use coverage::{CoverageError, count_differing};

/// Why two pictures cannot be compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the pictures differ in size: {}x{} and {}x{}", a.0, a.1, b.0, b.1)]
pub struct SizeError {
    /// Width and height of the first.
    pub a: (u32, u32),
    /// Width and height of the second.
    pub b: (u32, u32),
}
