//! What experiments share: their scenes, the machine that they run on, and the files of their
//! results.

pub(in crate::cli) mod context;
pub(in crate::cli) mod export;
pub(in crate::cli) mod subjects;
