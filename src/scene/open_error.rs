//! Errors of opening a scene.

use super::SceneError;
use super::generate::SpecError;
use crate::graph::{BuildError, ExternalError, vxg};

/// An error of opening a scene.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The specification is wrong.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// The file could not be read as voxels.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The file is a damaged graph.
    #[error(transparent)]
    Graph(#[from] vxg::VxgError),
    /// The file is a mesh, and the caller gave no reader of meshes.
    #[error("{0}: this is a mesh; open it with the crate shiftvox-mesh")]
    NoMeshes(String),
    /// The file is a mesh that cannot be voxelised.
    #[error("{}", .0.error)]
    Mesh(MeshFailure),
    /// The voxels make no graph.
    #[error("{source_name}: {error}")]
    Build {
        /// The scene, as the user named it.
        source_name: String,
        /// The fault.
        error: BuildError,
    },
    /// The voxels make no `.vxg` file.
    #[error("{source_name}: {error}")]
    External {
        /// The scene, as the user named it.
        source_name: String,
        /// The fault of the voxels or of the output.
        error: ExternalError,
    },
    /// More voxels than can be built in memory.
    #[error(
        "{source_name}: {voxels} voxels or more take at least {needed} bytes of memory while they are built, \
         and {available} are free"
    )]
    TooMany {
        /// The scene, as the user named it.
        source_name: String,
        /// Least number of voxels.
        voxels: u64,
        /// Least number of bytes for them.
        needed: u64,
        /// Bytes of memory that were free when reading began.
        available: u64,
    },
}

/// An error of a mesh reader, and whether its input is sound but exceeds a limit.
#[derive(Debug)]
pub struct MeshFailure {
    /// Whether the input is sound and only too large.
    pub is_limit: bool,
    /// The reader's error; its message names the file.
    pub error: Box<dyn std::error::Error + Send + Sync>,
}

impl OpenError {
    /// Whether the input is sound and only too large.
    pub fn is_limit(&self) -> bool {
        match self {
            Self::TooMany { .. } => true,
            Self::Build { error, .. }
            | Self::External {
                error: ExternalError::Build(error),
                ..
            } => !matches!(error, BuildError::Empty),
            Self::External { error, .. } => matches!(error, ExternalError::Disk(_)),
            Self::Scene(error) => error.is_limit(),
            Self::NoMeshes(_) => false,
            Self::Mesh(failure) => failure.is_limit,
            Self::Graph(vxg::VxgError::Io { source, .. }) => {
                source.kind() == std::io::ErrorKind::OutOfMemory
            }
            Self::Spec(_) | Self::Graph(_) => false,
        }
    }
}
