//! The `.far` file: hierarchy and data apart, mapped and used in place.
//!
//! Opening a file reads header and hierarchy and checks every field of both.
//! Voxels and triangles of a node are checked, against their checksum and the
//! node's box, when they are first needed, so that only what is drawn is
//! read. [`FarFile::verify`] reads all. [`FarFile::open_within`] keeps what is
//! in memory of them to a budget.

mod budget;
mod check;
mod format;
mod read;
mod write;

pub use crate::graph::file::FileError as FarError;
pub use budget::Resident;
pub use read::FarFile;
pub use write::{encode, write_to};
