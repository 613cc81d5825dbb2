//! A camera that sees all of an object: [`crate::project::fit`].

pub use crate::project::fit::*;
