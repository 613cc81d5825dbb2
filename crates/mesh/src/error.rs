//! What can be wrong with a mesh file, in terms that the user can act on.

use std::fmt;

/// Why a mesh could not be read.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// The operating system refused; the file's content was not at fault.
    #[error("{file}: cannot {action}: {source}")]
    Io {
        /// The file, as the user named it.
        file: String,
        /// What was tried, as a verb phrase: "read the file".
        action: &'static str,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The content breaks its format's rules, or has a value that no mesh can have.
    #[error(transparent)]
    Invalid(Box<MeshFault>),
    /// The content is sound but larger than this program handles.
    #[error(transparent)]
    Limit(Box<MeshFault>),
}

impl MeshError {
    /// Whether the file is sound but exceeds a limit of this program.
    #[must_use]
    pub fn is_limit(&self) -> bool {
        matches!(self, Self::Limit(_))
    }

    /// Adds the file's name.
    pub(super) fn in_file(self, file: &str) -> Self {
        match self {
            Self::Invalid(mut fault) => {
                file.clone_into(&mut fault.file);
                Self::Invalid(fault)
            }
            Self::Limit(mut fault) => {
                file.clone_into(&mut fault.file);
                Self::Limit(fault)
            }
            other @ Self::Io { .. } => other,
        }
    }
}

/// Where in a file something is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A line, counted from 1.
    Line(u64),
    /// A byte, counted from 0.
    Byte(u64),
    /// The file as a whole.
    Whole,
}

/// One finding in a mesh file: where, what was expected, what was found, and what to do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeshFault {
    /// The file, as the user named it.
    pub file: String,
    /// The part: "face 17", "header", "accessor 3".
    pub part: String,
    /// Where that is.
    pub place: Place,
    /// What the format, or this program, expects there.
    pub expected: String,
    /// What is there instead.
    pub found: String,
    /// What the user can do.
    pub advice: String,
}

impl MeshFault {
    /// A finding in a file whose name is filled in once it is known.
    pub(super) fn new(
        part: impl Into<String>,
        place: Place,
        expected: impl Into<String>,
        found: impl Into<String>,
        advice: impl Into<String>,
    ) -> Box<Self> {
        Box::new(Self {
            file: String::new(),
            part: part.into(),
            place,
            expected: expected.into(),
            found: found.into(),
            advice: advice.into(),
        })
    }
}

impl From<Box<MeshFault>> for MeshError {
    fn from(fault: Box<MeshFault>) -> Self {
        Self::Invalid(fault)
    }
}

impl fmt::Display for MeshFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.file, self.part)?;
        match self.place {
            Place::Line(line) => write!(f, " at line {line}")?,
            Place::Byte(byte) => write!(f, " at byte {byte}")?,
            Place::Whole => {}
        }
        write!(
            f,
            ": expected {}, found {}; {}",
            self.expected, self.found, self.advice
        )
    }
}

impl std::error::Error for MeshFault {}
