//! The `.vxg` file: a graph as it is in memory, to be mapped and used in place.
//!
//! [`open`] reads the header alone, so it takes the same time for any size,
//! and a render reads only the pages that it needs: nodes are stored level by
//! level, so that one of the upper levels never touches the lower ones.
//! Therefore the indices in the sections are *not* checked on opening. They
//! need not be for safety: nothing follows an index unchecked
//! ([`GraphView::child`](super::GraphView::child), [`Graph::color_of`](super::Graph::color_of),
//! [`Graph::children`](super::Graph::children)), so a damaged section gives a
//! wrong picture at worst. [`verify`] reads everything and finds every
//! damage that a 64-bit checksum can.

mod error;
mod format;
mod pages;
mod read;
mod write;

pub use error::VxgError;
pub(crate) use format::MAGIC;
pub use pages::MappedPages;
pub use read::{from_bytes, open, verify};
pub(in crate::graph) use write::{check_free, write_pieces};
pub use write::{write, write_to};
