//! Errors and their exit codes.

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

/// Kinds of failure, by exit code.
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

/// A failure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CliError {
    /// The kind, which decides on the exit code.
    pub kind: Kind,
    /// The error and its place.
    pub message: String,
    /// Advice for the user.
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

    /// An input that cannot be read: for lack of memory, or because of its contents.
    pub fn of_reading(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::OutOfMemory => Self::new(Kind::Limit, error)
                .advise("give the program more memory, or take a smaller file"),
            _ => Self::input(error),
        }
    }

    /// Flags that a program composed wrongly.
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

    /// The same failure with its place, a file or a scene, in front. A place that is there already is
    /// not repeated.
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

/// `From` of errors whose variant decides on the exit code.
macro_rules! exit_codes {
    ($($error:ty { $($variants:pat => $kind:ident),+ $(,)? })+) => {$(
        impl From<$error> for CliError {
            fn from(error: $error) -> Self {
                let kind = match &error {
                    $($variants => Kind::$kind),+
                };
                Self::new(kind, error)
            }
        }
    )+};
}

exit_codes! {
    SetupError {
        SetupError::Camera(_) | SetupError::Format(_) | SetupError::Tolerance(_) => Usage,
        SetupError::Setting { .. } => Usage,
        SetupError::Depth(_) | SetupError::OutOfRange | SetupError::Collapsed { .. } => Limit,
    }
    far::BuildError {
        far::BuildError::Empty | far::BuildError::Range | far::BuildError::FarAway { .. } => Input,
        far::BuildError::TooMany(_) | far::BuildError::Surface(_) => Limit,
        far::BuildError::Memory { .. } => Limit,
        far::BuildError::Option(_) => Usage,
        far::BuildError::File { .. } => Run,
    }
    textured::BuildError {
        textured::BuildError::Empty | textured::BuildError::Range => Input,
        textured::BuildError::TooMany(_) => Limit,
        textured::BuildError::Grid { .. } | textured::BuildError::Grids => Usage,
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

/// For writing to stdout.
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
        let kind = match &error {
            error if error.is_limit() => Kind::Limit,
            OpenError::External {
                error: ExternalError::Temporary { .. } | ExternalError::Write(_),
                ..
            } => Kind::Run,
            _ => Kind::Input,
        };
        let failure = Self::new(kind, &error);
        let advice = match error {
            OpenError::Scene(SceneError::BuiltOfMesh { file, kind }) => {
                let message = format!(
                    "{file}: this is a {kind} file: render and turntable draw it, info describes it"
                );
                return Self::input(message)
                    .advise("for anything else take the mesh that it was made of");
            }
            OpenError::Scene(SceneError::Io { .. }) => {
                "scenes are files or generators such as gen:terrain,depth=10,seed=1"
            }
            OpenError::TooMany { voxels, .. } if voxels >= u64::from(u32::MAX) => {
                "ask for fewer levels: a graph has less than 2^32 nodes"
            }
            OpenError::TooMany { .. } => {
                "build it out of core: shiftvox convert SCENE OUT.vxg --memory 2G; then draw OUT.vxg"
            }
            OpenError::External {
                error: ExternalError::Temporary { .. } | ExternalError::Disk(_),
                ..
            } => "choose a folder with more room with --temp",
            OpenError::External {
                error: ExternalError::Write(VxgError::Exists(_)),
                ..
            } => "give another name, or --force to replace it",
            _ => return failure,
        };
        failure.advise(advice)
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
