//! Errors of the public API.

use crate::budget::Shortage;
use crate::drawing::DrawError;
use crate::picture::ResolveError;
use crate::project::{EngineError, SetupError};

/// A message and its source.
type Reason = Box<dyn std::error::Error + Send + Sync>;

/// Why a scene cannot be opened, drawn or saved. Messages name the affected file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The scene cannot be opened: a missing, damaged, unknown or too large file, or a wrong specification.
    #[error(transparent)]
    Open(Reason),
    /// The voxels make no graph: there are none, too many, or they lie too far apart.
    #[error(transparent)]
    Build(Reason),
    /// Camera and settings make no frame.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// An invalid setting, such as one that the engine does not have, more than 2^27 samples, or a buffer that was not
    /// requested.
    #[error("{0}")]
    Setting(String),
    /// The picture does not fit in memory.
    #[error(transparent)]
    Memory(Shortage),
    /// The system provides no threads.
    #[error(transparent)]
    Threads(Reason),
    /// The engine cannot finish the frame: a word overflowed, it takes too many records, or it was stopped.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The simulated hardware cannot finish the frame.
    #[error(transparent)]
    Simulate(Reason),
    /// The frame makes no picture.
    #[error(transparent)]
    Resolve(Reason),
    /// A file cannot be written; an older one is kept.
    #[error(transparent)]
    Write(Reason),
}

impl From<DrawError> for Error {
    fn from(error: DrawError) -> Self {
        match error {
            DrawError::TooLarge(error) => Self::Setting(error.to_string()),
            DrawError::Memory(short) => Self::Memory(short),
            DrawError::Camera(error) => Self::Setup(error.into()),
            DrawError::Setup(error) => Self::Setup(error),
            DrawError::Engine(EngineError::Memory(short))
            | DrawError::Resolve(ResolveError::Memory(short)) => Self::Memory(short),
            DrawError::Engine(error) => Self::Engine(error),
            DrawError::Resolve(error) => Self::Resolve(error.into()),
            DrawError::Method(error) => Self::Resolve(error),
        }
    }
}
