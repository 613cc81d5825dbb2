//! Errors of writing files.

use std::io;
use std::path::{Path, PathBuf};

/// Why a file was not written. An older file is kept.
#[derive(Debug, thiserror::Error)]
pub enum WholeError {
    #[error("{0} exists already")]
    Exists(PathBuf),
    /// Neither the folder nor the one above it exists.
    #[error("{0}: there is no such folder")]
    NoFolder(PathBuf),
    #[error("{path}: {source}")]
    Io {
        /// The file, or its folder.
        path: PathBuf,
        source: io::Error,
    },
}

pub(super) fn failed(path: &Path, source: io::Error) -> WholeError {
    WholeError::Io {
        path: path.to_owned(),
        source,
    }
}
