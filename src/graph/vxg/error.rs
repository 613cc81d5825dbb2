//! What can be wrong with a `.vxg` file.

use std::io;
use std::path::PathBuf;

use crate::graph::Invalid;

/// Why a `.vxg` file was not read or written.
#[derive(Debug, thiserror::Error)]
pub enum VxgError {
    /// The operating system refused.
    #[error("{}: cannot {doing}: {source}", file.display())]
    Io {
        /// The file.
        file: PathBuf,
        /// What was tried.
        doing: &'static str,
        /// What the system says.
        source: io::Error,
    },
    /// The file exists, and overwriting was not requested.
    #[error("{}: the file exists already", .0.display())]
    Exists(PathBuf),
    /// The file is not as it should be.
    #[error(
        "{}: section {section}, byte {offset}: expected {expected}; {advice}",
        file.display()
    )]
    Malformed {
        /// The file.
        file: PathBuf,
        /// `header`, a section's four letters, or `padding`.
        section: &'static str,
        /// Bytes from the beginning of the file.
        offset: u64,
        /// What should have been there, and what was.
        expected: String,
        /// What to do.
        advice: &'static str,
    },
    /// The graph to be written breaks an invariant.
    #[error("the graph cannot be stored: {0}")]
    Graph(#[from] Invalid),
}

/// Advice for a damaged file.
pub(super) const DAMAGED: &str =
    "the file is damaged: copy it again, or convert it again from its source";
/// Advice for a file that is something else.
pub(super) const NOT_OURS: &str = "is this a .vxg file? Convert other formats with `convert`";
/// Advice for a file of a later program.
pub(super) const NEWER: &str = "the file is of another version: convert it again with this one";
