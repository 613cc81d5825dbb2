//! Errors and their exit codes.

use std::fmt;
use std::io;

use shiftvox::budget::{DiskShortage, Shortage};
use shiftvox::drawing::DrawError;
use shiftvox::graph::ExternalError;
use shiftvox::graph::file::FileError;
use shiftvox::machine::SimulateError;
use shiftvox::picture::ResolveError;
use shiftvox::project::{EngineError, SetupError};
use shiftvox::scene::{OpenError, SceneError};
use shiftvox::whole::WholeError;
use shiftvox_lab::bench::BenchError;
use shiftvox_lab::model::ModelError;
use shiftvox_lab::model::vectors::VectorsError;
use shiftvox_mesh::raster::RasterError;
use shiftvox_mesh::view_error::ViewError;
use shiftvox_mesh::{far, textured};

/// Kinds of failure, by exit code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The reader of stdout closed it early: not a failure.
    Pipe = 0,
    /// Something failed while the program ran.
    Run = 1,
    /// A wrong command line.
    Usage = 2,
    /// A comparison or an expectation failed.
    Failed = 3,
    /// An input cannot be used.
    Input = 4,
    /// A limit of the program or of the word format is exceeded.
    Limit = 5,
}

impl Kind {
    /// The process's exit code.
    #[must_use]
    pub fn code(self) -> u8 {
        self as u8
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

    /// An input that cannot be read, because of its contents or for lack of memory.
    pub fn of_reading(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::OutOfMemory => Self::new(Kind::Limit, error)
                .advise("give the program more memory, or take a smaller file"),
            _ => Self::input(error),
        }
    }

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

    /// The same failure with its file or scene in front, unless it is there already.
    #[must_use]
    pub fn at(mut self, place: impl fmt::Display) -> Self {
        let place = format!("{place}: ");
        if !self.message.starts_with(&place) {
            self.message.insert_str(0, &place);
        }
        self
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

/// `From` of errors whose variant decides on the exit code.
macro_rules! exit_codes {
    ($message:ident: $($error:ty { $($variants:pat => $kind:expr),+ $(,)? })+) => {$(
        impl From<$error> for CliError {
            fn from(error: $error) -> Self {
                let $message = error.to_string();
                let kind = match error {
                    $($variants => $kind),+
                };
                Self::new(kind, $message)
            }
        }
    )+};
}

exit_codes! {
    message:
    SetupError {
        SetupError::Camera(_) | SetupError::Format(_) | SetupError::Tolerance(_) | SetupError::Setting { .. } => Kind::Usage,
        SetupError::Depth(_) | SetupError::OutOfRange | SetupError::Collapsed { .. } => Kind::Limit,
    }
    EngineError {
        EngineError::Trap(_) => Kind::Limit,
        EngineError::Stopped => Kind::Run,
        EngineError::Memory(short) => return short.into(),
        EngineError::Records(_) => {
            return Self::new(Kind::Limit, message).advise(
                "ask for a smaller field of view or scene, `--coverage exact` or a coarser --lod",
            );
        },
    }
    ResolveError {
        ResolveError::Size(..) | ResolveError::Voxel => Kind::Run,
        ResolveError::Index => Kind::Limit,
        ResolveError::Memory(short) => return short.into(),
    }
    far::BuildError {
        far::BuildError::Empty | far::BuildError::Range | far::BuildError::FarAway { .. } => Kind::Input,
        far::BuildError::TooMany(_) | far::BuildError::Surface(_) | far::BuildError::Memory { .. } => Kind::Limit,
        far::BuildError::Option(_) => Kind::Usage,
        far::BuildError::File { .. } => Kind::Run,
    }
    textured::BuildError {
        textured::BuildError::Empty | textured::BuildError::Range | textured::BuildError::FarAway { .. } => Kind::Input,
        textured::BuildError::TooMany(_) => Kind::Limit,
        textured::BuildError::Grid { .. } | textured::BuildError::Grids => Kind::Usage,
    }
    ViewError {
        ViewError::File(error) => return error.into(),
        ViewError::NoGrid { has, .. } => {
            let has: Vec<String> = has.iter().map(u32::to_string).collect();
            return Self::usage(message).advise(format!("it has grids of {}", has.join(", ")));
        },
        ViewError::Raster(RasterError::TooMany(_)) => Kind::Limit,
        ViewError::Raster(_) | ViewError::VoxelSize(_) | ViewError::TexelSize(_) => Kind::Usage,
    }
    ModelError {
        ModelError::Setup(error) => return error.into(),
        ModelError::Engine(error) => return error.into(),
        ModelError::Simulate(SimulateError::Workload(error)) => return error.into(),
        ModelError::Simulate(_) => Kind::Limit,
        ModelError::Hardware(_) | ModelError::Cost(_) => Kind::Input,
    }
    BenchError {
        BenchError::Engine { who, source } => return Self::from(source).at(who),
        BenchError::Setup(error) => return error.into(),
        BenchError::Resolve(error) => return error.into(),
        BenchError::Picture(_) => Kind::Run,
    }
    VectorsError {
        VectorsError::Engine(error) => return error.into(),
        VectorsError::Store(error) => return error.into(),
        VectorsError::Misfit(_) => Kind::Limit,
    }
    WholeError {
        WholeError::Exists(_) => {
            return Self::new(Kind::Run, message).advise("give another name, or --force to replace it");
        },
        WholeError::NoFolder(_) => {
            return Self::new(Kind::Run, message).advise("make it first, or give another name");
        },
        WholeError::Io { .. } => Kind::Run,
    }
    DrawError {
        DrawError::TooLarge(_) => {
            return Self::new(Kind::Limit, message)
                .advise("ask for a smaller --size, or fewer samples with --aa");
        },
        DrawError::Memory(short) => return short.into(),
        DrawError::Setup(error) => return error.into(),
        DrawError::Engine(error) => return error.into(),
        DrawError::Resolve(error) => return error.into(),
        DrawError::Camera(_) => Kind::Usage,
        DrawError::Method(error) => match error.downcast::<ViewError>() {
            Ok(error) => return (*error).into(),
            Err(_) => Kind::Run,
        },
    }
}

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
        let is_limit = error.is_limit();
        let failure = Self::new(if is_limit { Kind::Limit } else { Kind::Input }, &error);
        match error {
            OpenError::Scene(SceneError::BuiltOfMesh { file, kind }) => Self::input(format!(
                "{file}: this is a {kind} file: render and turntable draw it, info describes it"
            ))
            .advise("for anything else take the mesh that it was made of"),
            OpenError::Scene(SceneError::Io { source, .. })
                if source.kind() == io::ErrorKind::IsADirectory =>
            {
                failure.advise("only render takes a folder, and draws all scenes in it")
            }
            OpenError::Scene(SceneError::Io { file, .. }) if file.parse::<f64>().is_ok() => {
                failure.advise("a height of --ortho needs a sign between: --ortho=HEIGHT")
            }
            OpenError::Scene(SceneError::Io { .. }) => {
                failure.advise("scenes are files or generators such as gen:terrain,depth=10,seed=1")
            }
            OpenError::TooMany { voxels, .. } if voxels >= u64::from(u32::MAX) => {
                failure.advise("ask for fewer levels: a graph has less than 2^32 nodes")
            }
            OpenError::TooMany { .. } => failure.advise(
                "build it out of core: shiftvox convert SCENE OUT.vxg --memory 2G; then draw OUT.vxg",
            ),
            OpenError::Build { error, .. } => {
                let failure = match error {
                    ExternalError::Temporary { .. } => Self { kind: Kind::Run, ..failure },
                    ExternalError::Disk(_) => failure,
                    ExternalError::Write(error) => return error.into(),
                    ExternalError::Build(_) => return failure,
                };
                failure.advise("choose a folder with more room with --temp")
            }
            OpenError::Graph(error) => error.into(),
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
        match error {
            FileError::Write(error) => error.into(),
            error if error.is_limit() => Self::new(Kind::Limit, error)
                .advise("give the program more memory or address space"),
            error => Self::input(error),
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
