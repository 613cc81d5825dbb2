//! What can be wrong with a `.tvx` file.

use std::io;
use std::path::PathBuf;

/// Why a `.tvx` file was not read or written.
#[derive(Debug, thiserror::Error)]
pub enum TexturedError {
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
    /// The file is not as it should be.
    #[error("{}: {section}, byte {offset}: expected {expected}; {advice}", file.display())]
    Malformed {
        /// The file.
        file: PathBuf,
        /// The header, or a section.
        section: &'static str,
        /// Bytes from the beginning of the file.
        offset: u64,
        /// What should have been there, and what was.
        expected: String,
        /// What to do.
        advice: &'static str,
    },
    /// A machine that stores the highest byte first.
    #[error("{}: .tvx files are used in place, which this machine's byte order does not allow", .0.display())]
    ByteOrder(PathBuf),
}

/// Advice for a damaged file.
pub(super) const DAMAGED: &str =
    "the file is damaged: copy it again, or convert it again from its mesh";
/// Advice for a file that is something else.
pub(super) const NOT_OURS: &str = "is this a .tvx file? Make one of a mesh with `convert`";
/// Advice for a file of another program version.
pub(super) const NEWER: &str = "the file is of another version: convert it again with this one";
