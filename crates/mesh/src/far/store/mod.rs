//! The `.far` file, mapped and used in place. A node's data is unpacked and checked when it is first needed.

mod budget;
mod check;
mod data;
mod format;
pub(in crate::far) mod pack;
mod read;
pub(in crate::far) mod surface;

pub use budget::Resident;
pub use data::NodeData;
pub use format::encode;
pub(in crate::far) use format::{VERSION, write_parts};
pub use read::FarFile;
pub use shiftvox::graph::file::FileError as FarError;
