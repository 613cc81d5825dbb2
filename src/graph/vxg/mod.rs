//! The `.vxg` file: a graph as it is in memory, to be mapped and used in place.
//!
//! [`open`] reads only the header. Nothing follows an index of a section unchecked, so a damaged section gives a wrong
//! picture at worst. [`verify`] reads everything.

mod format;
mod read;
mod write;

pub use super::file::FileError as VxgError;
pub(crate) use format::MAGIC;
pub(crate) use read::verify_mapped;
pub use read::{from_bytes, open, verify};
pub(in crate::graph) use write::write_pieces;
pub use write::{write, write_to};
