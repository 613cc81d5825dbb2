//! The command line and the pictures it writes.

mod buffers;
mod manners;
mod resolve;
