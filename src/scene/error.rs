//! Errors of reading and writing scene files.

use super::fault::Fault;
use super::formats::{self, FileKind};

#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The operating system rejected an operation; the file's content was not examined.
    #[error("{file}: cannot {action}: {source}")]
    Io {
        file: String,
        action: &'static str,
        source: std::io::Error,
    },
    #[error(transparent)]
    Invalid(Box<Fault>),
    #[error(transparent)]
    Limit(Box<Fault>),
    /// There are more voxels than the reader has room for.
    #[error("{file}: {voxels} voxels or more, and there is room for {most}")]
    TooMany {
        file: String,
        /// Least number of voxels, with those at one index counted each.
        voxels: u64,
        most: u64,
    },
    #[error(
        "{file}: this is a {kind} mesh, which has triangles and no voxels; open it as a scene to have it voxelised"
    )]
    Mesh { file: String, kind: FileKind },
    #[error(
        "{file}: this is a {kind} file, which has no triangles; triangles are in files of the formats {}",
        formats::mesh_endings()
    )]
    NotMesh { file: String, kind: FileKind },
    #[error("{file}: this is a .vxg graph, which is opened as a graph and not read as voxels")]
    IsGraph { file: String },
    #[error("{file}: this is a {kind} file, which has neither voxels nor triangles to be read")]
    BuiltOfMesh { file: String, kind: FileKind },
    #[error(
        "{file}: not a known scene file: it begins with {begins}; expected {}; formats are recognised by content, so renaming the file does not help{}",
        formats::all_endings(),
        formats::advice(file)
    )]
    Unknown { file: String, begins: String },
}

impl SceneError {
    /// Whether the file is sound but exceeds a limit of this program.
    pub fn is_limit(&self) -> bool {
        match self {
            Self::Limit(_) | Self::TooMany { .. } => true,
            Self::Io { source, .. } => source.kind() == std::io::ErrorKind::OutOfMemory,
            _ => false,
        }
    }
}
