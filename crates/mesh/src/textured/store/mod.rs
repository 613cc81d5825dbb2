//! The `.tvx` file: primitives, voxels, lists and sub-textures, mapped and used in place.
//!
//! Opening a file checks everything but the texels, which are most of it: a
//! grid's are checked against their checksum when it is first drawn.
//! [`TexturedFile::verify`] reads all, and computes erosion depths again.

mod check;
mod format;
mod read;
mod write;

pub use read::{Grid, TexturedFile};
pub use shiftvox::graph::file::FileError as TexturedError;
pub use write::{encode, write_to};
