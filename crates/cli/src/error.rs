//! What can go wrong, and which exit code says so.

use std::fmt;
use std::io;
use std::process::ExitCode;

use shiftvox::budget::{DiskShortage, Shortage};
use shiftvox::drawing::DrawError;
use shiftvox::graph::ExternalError;
use shiftvox::graph::file::FileError;
use shiftvox::graph::vxg::VxgError;
use shiftvox::picture::ResolveError;
use shiftvox::project::{EngineError, SetupError};
use shiftvox::scene::{OpenError, SceneError};
use shiftvox::whole::WholeError;
use shiftvox_lab::bench::BenchError;
use shiftvox_mesh::drawing::MethodError;
use shiftvox_mesh::{far, textured};

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
    /// The reader of stdout closed it early: not a failure.
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

    /// An input that cannot be read: for want of memory, or because of what it is.
    pub fn of_reading(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::OutOfMemory => Self::new(Kind::Limit, error)
                .advise("give the program more memory, or take a smaller file"),
            _ => Self::input(error),
        }
    }

    /// Flags that a program put together wrongly.
    #[cfg(feature = "view")]
    pub(super) fn of_words(error: clap::Error) -> Self {
        let message = error.render().to_string();
        let first = message.lines().next().unwrap_or_default();
        Self::usage(first.trim_start_matches("error: "))
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

impl From<WholeError> for CliError {
    fn from(error: WholeError) -> Self {
        let failure = Self::new(Kind::Run, &error);
        match error {
            WholeError::Exists(_) => failure.advise("give another name, or --force to replace it"),
            WholeError::NoFolder(_) => failure.advise("make it first, or give another name"),
            WholeError::Io { .. } => failure,
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
            EngineError::Memory(short) => short.into(),
        }
    }
}

impl From<ResolveError> for CliError {
    fn from(error: ResolveError) -> Self {
        let kind = match error {
            ResolveError::Size(..) | ResolveError::Voxel => Kind::Run,
            ResolveError::Index => Kind::Limit,
            ResolveError::Memory(short) => return short.into(),
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

impl From<OpenError> for CliError {
    fn from(error: OpenError) -> Self {
        let written = matches!(
            error,
            OpenError::External {
                error: ExternalError::Temporary { .. } | ExternalError::Write(_),
                ..
            }
        );
        let kind = if error.is_limit() {
            Kind::Limit
        } else if written {
            Kind::Run
        } else {
            Kind::Input
        };
        let failure = Self::new(kind, &error);
        match error {
            OpenError::Scene(SceneError::BuiltOfMesh { file, kind }) => Self::input(format!(
                "{file}: this is a {kind} file: render and turntable draw it, info describes it"
            ))
            .advise("for anything else take the mesh that it was made of"),
            OpenError::Scene(SceneError::Io { .. }) => {
                failure.advise("scenes are files or generators such as gen:terrain,depth=10,seed=1")
            }
            OpenError::TooMany { voxels, .. } if voxels >= u64::from(u32::MAX) => {
                failure.advise("ask for fewer levels: a graph has less than 2^32 nodes")
            }
            OpenError::TooMany { .. } => failure.advise(
                "build it out of core: shiftvox convert SCENE OUT.vxg --memory 2G; then draw \
                 OUT.vxg",
            ),
            OpenError::External {
                error: ExternalError::Temporary { .. } | ExternalError::Disk(_),
                ..
            } => failure.advise("choose a folder with more room with --temp"),
            OpenError::External {
                error: ExternalError::Write(VxgError::Exists(_)),
                ..
            } => failure.advise("give another name, or --force to replace it"),
            _ => failure,
        }
    }
}

impl From<SceneError> for CliError {
    fn from(error: SceneError) -> Self {
        OpenError::from(error).into()
    }
}

impl From<FileError> for CliError {
    fn from(error: FileError) -> Self {
        match error.is_limit() {
            true => Self::new(Kind::Limit, error)
                .advise("give the program more memory or address space"),
            false => Self::input(error),
        }
    }
}

impl From<far::BuildError> for CliError {
    fn from(error: far::BuildError) -> Self {
        let kind = match error {
            far::BuildError::Empty | far::BuildError::Range | far::BuildError::FarAway { .. } => {
                Kind::Input
            }
            far::BuildError::TooMany(_)
            | far::BuildError::Surface(_)
            | far::BuildError::Memory { .. } => Kind::Limit,
            far::BuildError::Option(_) => Kind::Usage,
            far::BuildError::File { .. } => Kind::Run,
        };
        Self::new(kind, error)
    }
}

impl From<far::view::ViewError> for CliError {
    fn from(error: far::view::ViewError) -> Self {
        match error {
            far::view::ViewError::File(error) => error.into(),
            far::view::ViewError::Raster(_)
            | far::view::ViewError::VoxelSize(_)
            | far::view::ViewError::Samples(_) => Self::usage(error),
        }
    }
}

impl From<textured::BuildError> for CliError {
    fn from(error: textured::BuildError) -> Self {
        let kind = match error {
            textured::BuildError::Empty | textured::BuildError::Range => Kind::Input,
            textured::BuildError::TooMany(_) => Kind::Limit,
            textured::BuildError::Grid { .. } | textured::BuildError::Grids => Kind::Usage,
        };
        Self::new(kind, error)
    }
}

impl From<textured::view::ViewError> for CliError {
    fn from(error: textured::view::ViewError) -> Self {
        match error {
            textured::view::ViewError::File(error) => error.into(),
            textured::view::ViewError::Raster(_)
            | textured::view::ViewError::Grid(..)
            | textured::view::ViewError::TexelSize(_) => Self::usage(error),
        }
    }
}

impl From<DrawError> for CliError {
    fn from(error: DrawError) -> Self {
        let message = error.to_string();
        match error {
            DrawError::TooLarge(_) => Self::new(Kind::Limit, message)
                .advise("ask for a smaller --size, or fewer samples with --aa"),
            DrawError::Memory(short) => short.into(),
            DrawError::Setup(error) => error.into(),
            DrawError::Engine(error) => error.into(),
            DrawError::Resolve(error) => error.into(),
            DrawError::Camera(_) => Self::usage(message),
            DrawError::Method(error) => match error.downcast::<MethodError>() {
                Ok(error) => (*error).into(),
                Err(_) => Self::new(Kind::Run, message),
            },
        }
    }
}

impl From<MethodError> for CliError {
    fn from(error: MethodError) -> Self {
        let message = error.to_string();
        match error {
            MethodError::Far(error) => error.into(),
            MethodError::Textured(error) => error.into(),
            MethodError::NoGrid { has, .. } => {
                let has: Vec<String> = has.iter().map(u32::to_string).collect();
                Self::usage(message).advise(format!("it has grids of {}", has.join(", ")))
            }
            MethodError::Samples(_) => Self::usage(message),
            _ => Self::new(Kind::Run, message),
        }
    }
}

impl From<Shortage> for CliError {
    fn from(short: Shortage) -> Self {
        Self::new(Kind::Limit, short)
            .advise("ask for a smaller --size or fewer samples, or a scene of fewer levels")
    }
}

impl From<DiskShortage> for CliError {
    fn from(short: DiskShortage) -> Self {
        Self::new(Kind::Limit, short).advise("make room, or write to another disk")
    }
}

impl From<BenchError> for CliError {
    fn from(error: BenchError) -> Self {
        match error {
            BenchError::Engine { who, source } => Self::from(source).at(who),
            BenchError::Setup(error) => error.into(),
            BenchError::Picture(_) | BenchError::Threads { .. } => Self::new(Kind::Run, error),
        }
    }
}
