//! The `.tvx` file, mapped and used in place.
//!
//! Opening checks everything except the texels, which take most of it: those of a grid are checked when it is first
//! drawn. [`TexturedFile::verify`] reads all, and computes erosion depths again.

mod check;
mod format;
mod read;

pub use format::{GridEntry, encode, write_to};
pub(in crate::textured) use read::Painted;
pub use read::{Grid, TexturedFile};
pub use shiftvox::graph::file::FileError as TexturedError;
