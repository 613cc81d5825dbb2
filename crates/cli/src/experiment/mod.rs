//! Shared parts of experiments: scenes, the description of the computer, files of results.

pub(crate) mod context;
pub(crate) mod export;
pub(crate) mod subjects;
