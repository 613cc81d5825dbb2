//! What can be wrong with a scene file, in terms that the user can act on.

use std::fmt;

use super::FileKind;

/// Why a scene could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
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
    /// The content breaks its format's rules, or has a value that no voxel scene can have.
    #[error(transparent)]
    Invalid(Box<Fault>),
    /// The content is sound but larger than this program handles.
    #[error(transparent)]
    Limit(Box<Fault>),
    /// There are more voxels than the reader has room for.
    #[error("{file}: {voxels} voxels or more, and there is room for {most}")]
    TooMany {
        /// The file, as the user named it.
        file: String,
        /// Voxels that there are at the least, those at one place counted each.
        voxels: u64,
        /// Most that there may be: [`ReadOptions::most_voxels`](super::ReadOptions::most_voxels).
        most: u64,
    },
    /// The file is a mesh.
    #[error(
        "{file}: this is a {kind} mesh, which has triangles and no voxels; open it as a scene to have it voxelised"
    )]
    Mesh {
        /// The file, as the user named it.
        file: String,
        /// Which mesh format it is.
        kind: FileKind,
    },
    /// The file is no mesh.
    #[error(
        "{file}: this is a {kind} file, which has no triangles; triangles are in .obj, .ply, .stl, .gltf and .glb files"
    )]
    NotMesh {
        /// The file, as the user named it.
        file: String,
        /// Which format it is.
        kind: FileKind,
    },
    /// The file holds a finished voxel graph, not voxels to build one from.
    #[error("{file}: this is a .vxg graph, which is opened as a graph and not read as voxels")]
    IsGraph {
        /// The file, as the user named it.
        file: String,
    },
    /// The file was built of a mesh for one method.
    #[error("{file}: this is a {kind} file, which has neither voxels nor triangles to be read")]
    BuiltOfMesh {
        /// The file, as the user named it.
        file: String,
        /// Which format it is.
        kind: FileKind,
    },
    /// The content begins like none of the known formats.
    #[error(
        "{file}: not a known scene file: it begins with {begins}; expected .vox (\"VOX \"), .ply (\"ply\"), .npy (\"\\x93NUMPY\") .vxg (\"\\x89VXG\"), or a mesh (.obj, .ply, .stl, .gltf, .glb); formats are recognised by content, so renaming the file does not help"
    )]
    Unknown {
        /// The file, as the user named it.
        file: String,
        /// Its first bytes, printable.
        begins: String,
    },
}

impl SceneError {
    /// Whether the file is sound but exceeds a limit of this program.
    #[must_use]
    pub fn is_limit(&self) -> bool {
        match self {
            Self::Limit(_) | Self::TooMany { .. } => true,
            Self::Io { source, .. } => source.kind() == std::io::ErrorKind::OutOfMemory,
            _ => false,
        }
    }

    /// The details, where the content is at fault.
    #[must_use]
    pub fn fault(&self) -> Option<&Fault> {
        match self {
            Self::Invalid(fault) | Self::Limit(fault) => Some(fault),
            _ => None,
        }
    }
}

/// One finding in a file: where, what was expected, what was found, and what to do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// The file, as the user named it.
    pub file: String,
    /// The chunk, section or element: "chunk XYZI", "header", "vertex 17".
    pub part: String,
    /// Byte offset from the beginning of the file.
    pub offset: u64,
    /// What the format, or this program, expects there.
    pub expected: String,
    /// What is there instead.
    pub found: String,
    /// What the user can do.
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
    /// A finding in a file whose name is filled in by [`Fault::in_file`] once it is known.
    pub fn new(
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

/// What went wrong below the level at which the file's name is known.
#[derive(Debug)]
pub enum Problem {
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

impl Problem {
    /// Adds the file's name.
    pub fn in_file(self, file: &str) -> SceneError {
        match self {
            Self::Invalid(mut fault) => {
                file.clone_into(&mut fault.file);
                SceneError::Invalid(fault)
            }
            Self::Limit(mut fault) => {
                file.clone_into(&mut fault.file);
                SceneError::Limit(fault)
            }
            Self::TooMany { voxels, most } => SceneError::TooMany {
                file: file.to_owned(),
                voxels,
                most,
            },
            Self::Read(source) => SceneError::Io {
                file: file.to_owned(),
                action: "read the file",
                source,
            },
        }
    }
}

/// At most 16 bytes as they can be shown on one line of a terminal.
pub fn printable(bytes: &[u8]) -> String {
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
