//! What experiments share: their scenes, the machine that they run on, and the files of their
//! results.

pub(crate) mod context;
pub(crate) mod export;
pub(crate) mod subjects;
