//! Why a scene cannot be opened, drawn or saved.

use crate::graph::BuildError;
use crate::graph::vxg::VxgError;
use crate::machine::SimulateError;
use crate::picture::ResolveError;
use crate::picture::store::StoreError;
use crate::project::{EngineError, SetupError};
use crate::scene::OpenError;

/// Why a scene cannot be opened, drawn or saved. Messages name the file to blame, where there is one.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The scene cannot be opened: a missing, damaged, unknown or too large file, or a wrong specification.
    #[error(transparent)]
    Open(Box<OpenError>),
    /// The voxels make no graph: there are none, too many, or they lie too far apart.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// Camera and settings make no frame.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// Samples of a pixel along an axis are not 1, 2 or 4, the picture has more than 2^27 samples, or the zoom is not
    /// above 0.
    #[error("{0}")]
    Size(String),
    /// The system gives no threads.
    #[error(transparent)]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// The engine cannot finish the frame: a word overflowed.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The simulated hardware cannot finish the frame.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The frame makes no picture.
    #[error(transparent)]
    Resolve(#[from] ResolveError),
    /// A file cannot be written. What stood there before still does.
    #[error(transparent)]
    Write(#[from] StoreError),
    /// A graph file cannot be written. What stood there before still does.
    #[error(transparent)]
    WriteGraph(Box<VxgError>),
}

impl From<OpenError> for Error {
    fn from(error: OpenError) -> Self {
        Self::Open(Box::new(error))
    }
}

impl From<VxgError> for Error {
    fn from(error: VxgError) -> Self {
        Self::WriteGraph(Box::new(error))
    }
}
