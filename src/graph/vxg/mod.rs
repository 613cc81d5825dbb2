//! The `.vxg` file: a graph as it is in memory, to be mapped and used in place.
//!
//! [`open`] reads only the header, so it takes the same time for any size. Indices in the sections are *not* checked
//! on opening. Nothing follows an index unchecked ([`GraphView::child`](super::GraphView::child),
//! [`Graph::color_of`](super::Graph::color_of), [`Graph::children`](super::Graph::children)), so a damaged section
//! gives a wrong picture at worst. [`verify`] reads everything and finds every damage that a 64-bit checksum can.

mod format;
mod read;
mod write;

pub use super::file::FileError as VxgError;
pub(crate) use format::MAGIC;
pub use read::{from_bytes, open, verify};
pub(in crate::graph) use write::{check_free, write_pieces};
pub use write::{write, write_to};
