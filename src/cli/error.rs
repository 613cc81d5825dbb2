//! What can go wrong, and which exit code says so.

use std::convert::Infallible;
use std::fmt;
use std::io;
use std::process::ExitCode;

use crate::picture::ResolveError;
use crate::picture::store::StoreError;
use crate::project::{EngineError, SetupError};

/// The kinds of failure that a script can tell apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Something failed while the program ran: exit code 1.
    Run,
    /// The command line makes no sense: exit code 2.
    Usage,
    /// A comparison or an expectation failed: exit code 3.
    Failed,
    /// An input cannot be used: exit code 4.
    Input,
    /// A limit of the program or of the word format is exceeded: exit code 5.
    Limit,
    /// Whoever read our output stopped reading: no failure of ours.
    Pipe,
}

impl Kind {
    /// The process's exit code.
    #[must_use]
    pub fn code(self) -> u8 {
        match self {
            Self::Pipe => 0,
            Self::Run => 1,
            Self::Usage => 2,
            Self::Failed => 3,
            Self::Input => 4,
            Self::Limit => 5,
        }
    }
}

/// A failure: its kind, what happened and where, and what to do about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CliError {
    /// The kind, hence the exit code.
    pub kind: Kind,
    /// What happened, and where.
    pub message: String,
    /// What the user can do, where there is something.
    pub advice: Option<String>,
}

impl CliError {
    /// A failure without advice.
    pub fn new(kind: Kind, message: impl fmt::Display) -> Self {
        Self {
            kind,
            message: message.to_string(),
            advice: None,
        }
    }

    /// A wrong command line.
    pub fn usage(message: impl fmt::Display) -> Self {
        Self::new(Kind::Usage, message)
    }

    /// An input that cannot be used.
    pub fn input(message: impl fmt::Display) -> Self {
        Self::new(Kind::Input, message)
    }

    /// The same failure with advice.
    #[must_use]
    pub fn advise(mut self, advice: impl Into<String>) -> Self {
        self.advice = Some(advice.into());
        self
    }

    /// The same failure, said of a place: a file or a scene; once, where it is said already.
    #[must_use]
    pub fn at(mut self, place: impl fmt::Display) -> Self {
        let place = format!("{place}: ");
        if !self.message.starts_with(&place) {
            self.message.insert_str(0, &place);
        }
        self
    }

    /// The process's exit code.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(self.kind.code())
    }
}

impl fmt::Display for CliError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)?;
        match &self.advice {
            Some(advice) => write!(f, "\n  {advice}"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for CliError {}

impl From<StoreError> for CliError {
    fn from(error: StoreError) -> Self {
        let failure = Self::new(Kind::Run, &error);
        match error {
            StoreError::Exists(_) => failure.advise("give another name, or --force to replace it"),
            StoreError::Io { .. } => failure,
        }
    }
}

impl From<SetupError> for CliError {
    fn from(error: SetupError) -> Self {
        let kind = match error {
            SetupError::Camera(_)
            | SetupError::Format(_)
            | SetupError::Tolerance(_)
            | SetupError::Setting { .. } => Kind::Usage,
            SetupError::Depth(_) | SetupError::OutOfRange | SetupError::Collapsed { .. } => {
                Kind::Limit
            }
        };
        Self::new(kind, error)
    }
}

impl From<EngineError> for CliError {
    fn from(error: EngineError) -> Self {
        match error {
            EngineError::Trap(_) => Self::new(Kind::Limit, error),
        }
    }
}

impl From<Infallible> for CliError {
    fn from(never: Infallible) -> Self {
        match never {}
    }
}

impl From<ResolveError> for CliError {
    fn from(error: ResolveError) -> Self {
        let kind = match error {
            ResolveError::Size(..) | ResolveError::Voxel => Kind::Run,
            ResolveError::Index => Kind::Limit,
        };
        Self::new(kind, error)
    }
}

/// For what is written to stdout.
impl From<io::Error> for CliError {
    fn from(error: io::Error) -> Self {
        let kind = match error.kind() {
            io::ErrorKind::BrokenPipe => Kind::Pipe,
            _ => Kind::Run,
        };
        Self::new(kind, format!("cannot write to stdout: {error}"))
    }
}
