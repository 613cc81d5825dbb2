//! What experiments share: their scenes, the machine that they run on, and the files of their
//! results.

pub(in crate) mod context;
pub(in crate) mod export;
pub(in crate) mod subjects;
