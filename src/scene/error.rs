//! Errors of reading and writing scene files.

use super::fault::Fault;
use super::formats::{self, FileKind};

/// Why a scene could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The operating system rejected an operation; the file's content was not examined.
    #[error("{file}: cannot {action}: {source}")]
    Io {
        /// The file, as the user named it.
        file: String,
        /// The action that failed, as a verb phrase: "read the file".
        action: &'static str,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The content breaks its format's rules, or has a value that no voxel scene can have.
    #[error(transparent)]
    Invalid(Box<Fault>),
    /// The content is sound but exceeds a limit of this program.
    #[error(transparent)]
    Limit(Box<Fault>),
    /// There are more voxels than the reader has room for.
    #[error("{file}: {voxels} voxels or more, and there is room for {most}")]
    TooMany {
        /// The file, as the user named it.
        file: String,
        /// Least number of voxels, with those at one index counted each.
        voxels: u64,
        /// The limit: [`ReadOptions::most_voxels`](super::ReadOptions::most_voxels).
        most: u64,
    },
    /// The file is a mesh.
    #[error(
        "{file}: this is a {kind} mesh, which has triangles and no voxels; open it as a scene to have it voxelised"
    )]
    Mesh {
        /// The file, as the user named it.
        file: String,
        /// Its format.
        kind: FileKind,
    },
    /// The file is no mesh.
    #[error(
        "{file}: this is a {kind} file, which has no triangles; triangles are in files of the formats {}",
        formats::mesh_endings()
    )]
    NotMesh {
        /// The file, as the user named it.
        file: String,
        /// Its format.
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
        /// Its format.
        kind: FileKind,
    },
    /// The format is unknown.
    #[error(
        "{file}: not a known scene file: it begins with {begins}; expected {}; formats are recognised by content, so renaming the file does not help",
        formats::all_endings()
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
    pub fn is_limit(&self) -> bool {
        match self {
            Self::Limit(_) | Self::TooMany { .. } => true,
            Self::Io { source, .. } => source.kind() == std::io::ErrorKind::OutOfMemory,
            _ => false,
        }
    }
}
