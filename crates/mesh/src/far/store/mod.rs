//! The `.far` file: hierarchy and data apart, mapped and used in place.
//!
//! Opening a file reads header and hierarchy and checks every field of both. The data of a node is unpacked and checked
//! when it is first needed, against its checksum and the node's box. So only drawn nodes are read. [`FarFile::verify`]
//! reads all. [`FarFile::open_within`] keeps what is in memory of them to a budget.

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
