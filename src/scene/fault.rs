//! A fault in a file, in terms that the user can act on.

use std::fmt;

use super::SceneError;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    Line(u64),
    Byte(u64),
    Whole,
}

impl From<u64> for Place {
    fn from(byte: u64) -> Self {
        Self::Byte(byte)
    }
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    pub file: String,
    /// The chunk, section or element: "chunk XYZI", "header", "vertex 17".
    pub part: String,
    pub place: Place,
    pub expected: String,
    pub found: String,
    pub advice: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.file, self.part)?;
        match self.place {
            Place::Line(line) => write!(f, " at line {line}")?,
            Place::Byte(byte) => write!(f, " at byte {byte}")?,
            Place::Whole => {}
        }
        let (expected, found, advice) = (&self.expected, &self.found, &self.advice);
        write!(f, ": expected {expected}, found {found}; {advice}")
    }
}

impl std::error::Error for Fault {}

impl Fault {
    pub fn new(
        part: impl Into<String>,
        place: impl Into<Place>,
        expected: impl Into<String>,
        found: impl Into<String>,
        advice: impl Into<String>,
    ) -> Box<Self> {
        Box::new(Self {
            file: String::new(),
            part: part.into(),
            place: place.into(),
            expected: expected.into(),
            found: found.into(),
            advice: advice.into(),
        })
    }
}

/// An error of a reader, which does not know the file's name.
#[derive(Debug)]
pub enum Problem {
    Invalid(Box<Fault>),
    Limit(Box<Fault>),
    TooMany { voxels: u64, most: u64 },
    Read(std::io::Error),
}

impl From<Box<Fault>> for Problem {
    fn from(fault: Box<Fault>) -> Self {
        Self::Invalid(fault)
    }
}

impl Problem {
    pub fn in_file(self, name: &str) -> SceneError {
        let file = name.to_owned();
        match self {
            Self::Invalid(fault) => SceneError::Invalid(Box::new(Fault { file, ..*fault })),
            Self::Limit(fault) => SceneError::Limit(Box::new(Fault { file, ..*fault })),
            Self::TooMany { voxels, most } => SceneError::TooMany { file, voxels, most },
            Self::Read(source) => SceneError::Io {
                file,
                action: "read the file",
                source,
            },
        }
    }
}

/// At most 16 bytes as they can be shown on one line of a terminal.
pub(super) fn printable(bytes: &[u8]) -> String {
    if bytes.is_empty() {
        return "nothing (no bytes)".to_owned();
    }
    let shown = bytes[..bytes.len().min(16)].escape_ascii();
    let rest = if bytes.len() > 16 { "..." } else { "" };
    format!("\"{shown}{rest}\"")
}
