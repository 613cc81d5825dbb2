//! Why a file was not written.

use std::io;
use std::path::{Path, PathBuf};

/// Why a file was not written. Whatever stood there before still does.
#[derive(Debug, thiserror::Error)]
pub enum WholeError {
    /// Something is there already.
    #[error("{0} exists already")]
    Exists(PathBuf),
    /// The folder is not there, nor the one that it would be in.
    #[error("{0}: there is no such folder")]
    NoFolder(PathBuf),
    /// The operating system refused.
    #[error("{path}: {source}")]
    Io {
        /// The file, or its folder.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
}

pub(super) fn failed(path: &Path, source: io::Error) -> WholeError {
    WholeError::Io {
        path: path.to_owned(),
        source,
    }
}
