//! Errors of opening a scene.

use super::SceneError;
use super::generate::SpecError;
use crate::graph::{BuildError, ExternalError, vxg};

#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    #[error(transparent)]
    Spec(#[from] SpecError),
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Graph(#[from] vxg::VxgError),
    #[error("{0}: this is a mesh; open it with the crate shiftvox-mesh")]
    NoMeshes(String),
    #[error("{}", .0.error)]
    Mesh(MeshFailure),
    #[error("{source_name}: {error}")]
    Build {
        source_name: String,
        error: ExternalError,
    },
    #[error(
        "{source_name}: {voxels} voxels or more take at least {needed} bytes of memory while they are built, \
         and {available} are free"
    )]
    TooMany {
        source_name: String,
        voxels: u64,
        needed: u64,
        /// Bytes of memory that were free when reading began.
        available: u64,
    },
}

/// An error of a mesh reader; its message names the file.
#[derive(Debug)]
pub struct MeshFailure {
    pub is_limit: bool,
    pub error: Box<dyn std::error::Error + Send + Sync>,
}

impl OpenError {
    pub fn is_limit(&self) -> bool {
        match self {
            Self::TooMany { .. } => true,
            Self::Build { error, .. } => match error {
                ExternalError::Build(error) => !matches!(error, BuildError::Empty),
                error => matches!(error, ExternalError::Disk(_)),
            },
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
