//! The `.far` file: hierarchy and data apart, mapped and used in place.
//!
//! Opening a file reads header and hierarchy and checks every field of both.
//! Voxels and triangles of a node are unpacked and checked, against their
//! checksum and the node's box, when they are needed, so that only what is drawn is
//! read. [`FarFile::verify`] reads all. [`FarFile::open_within`] keeps what is
//! in memory of them to a budget.

mod budget;
mod check;
mod data;
mod format;
pub(in crate::far) mod pack;
mod read;
pub(in crate::far) mod surface;

pub use budget::Resident;
pub use data::NodeData;
pub(in crate::far) use format::write_parts;
pub use format::{encode, write_to};
pub use read::FarFile;
pub use shiftvox::graph::file::FileError as FarError;
