//! A fault in a scene file, in terms that the user can act on.

use std::fmt;

/// A fault in a file: its place, the expected and the actual content, and a remedy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// The file, as the user named it.
    pub file: String,
    /// The chunk, section or element: "chunk XYZI", "header", "vertex 17".
    pub part: String,
    /// Byte offset from the beginning of the file.
    pub offset: u64,
    /// Content that the format, or this program, expects there.
    pub expected: String,
    /// The actual content.
    pub found: String,
    /// A remedy.
    pub advice: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: {} at byte {}: expected {}, found {}; {}",
            self.file, self.part, self.offset, self.expected, self.found, self.advice
        )
    }
}

impl std::error::Error for Fault {}

impl Fault {
    /// A fault in a file whose name is filled in later.
    pub(super) fn new(
        part: impl Into<String>,
        offset: u64,
        expected: impl Into<String>,
        found: impl Into<String>,
        advice: impl Into<String>,
    ) -> Box<Self> {
        Box::new(Self {
            file: String::new(),
            part: part.into(),
            offset,
            expected: expected.into(),
            found: found.into(),
            advice: advice.into(),
        })
    }
}

/// An error of a reader, which does not know the file's name.
#[derive(Debug)]
pub(super) enum Problem {
    /// See [`SceneError::Invalid`].
    Invalid(Box<Fault>),
    /// See [`SceneError::Limit`].
    Limit(Box<Fault>),
    /// See [`SceneError::TooMany`].
    TooMany { voxels: u64, most: u64 },
    /// Reading failed.
    Read(std::io::Error),
}

impl From<Box<Fault>> for Problem {
    fn from(fault: Box<Fault>) -> Self {
        Self::Invalid(fault)
    }
}

/// At most 16 bytes as they can be shown on one line of a terminal.
pub(super) fn printable(bytes: &[u8]) -> String {
    if bytes.is_empty() {
        return "nothing (no bytes)".to_owned();
    }
    let shown: String = bytes
        .iter()
        .take(16)
        .map(|b| b.escape_ascii().to_string())
        .collect();
    let rest = if bytes.len() > 16 { "..." } else { "" };
    format!("\"{shown}{rest}\"")
}
