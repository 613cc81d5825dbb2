//! `bench`: the experiments, one file each.

mod ablation;
mod args;
mod engines;
mod error;
mod flicker;
mod meshes;
mod methods;
mod picture_export;
mod scaling;
mod select;
mod vertex_error;
mod walk;

use clap::{Args, Subcommand};

use super::args::ThreadCounts;
use super::console::Console;
use super::error::CliError;

/// Arguments of `bench`.
#[derive(Debug, Args)]
pub(super) struct BenchArgs {
    #[command(subcommand)]
    experiment: Experiment,
}

/// What is measured.
#[derive(Debug, Subcommand)]
enum Experiment {
    /// How fast each engine is, and how far its picture is from the exact one
    ///
    /// A frame is: clear, traverse, the colour of each sample written. Engines take turns. With
    /// --threads 1,2 those that use threads are measured with each number.
    Engines(Box<args::SceneBenchArgs>),
    /// How time grows with the pixels of the picture and the voxels of the scene
    ///
    /// First the picture grows from 64 to 4096 a side (with --size: up to that), for each scene;
    /// then terrain and sponge grow, in pictures of 1024 x 1024 (or --size). Power laws are fitted
    /// to time and work.
    Scaling(Box<scaling::ScalingArgs>),
    /// What each technique is worth, by switching it off
    ///
    /// One at a time, on one thread; says what that costs and whether it changes the picture.
    Ablation(Box<args::SceneBenchArgs>),
    /// How far pictures are from the truth, and what they take: by drawing rule, tolerance, cage,
    /// word format, level of detail and samples a pixel
    ///
    /// Each is compared with exact rays through the same points, and with a reference of 16 x 16
    /// exact rays a pixel. A second reference gives the noise floor. All draw in turn, on one
    /// thread; beside each time stand the operations of the machine, which are the same in every
    /// run.
    Error(Box<error::ErrorArgs>),
    /// How restless pictures are when the camera moves a little
    ///
    /// Films of a turntable, a dolly and a pan of less than a pixel, against films of references.
    /// Flicker is what changes from frame to frame other than in the reference; pop, what level of
    /// detail alone changes. Nothing is timed.
    Flicker(Box<flicker::FlickerArgs>),
    /// All ways to draw a mesh side by side: triangles, the image-order engine on its voxels, far
    /// voxels, textured voxels
    ///
    /// From where the mesh fills the picture to where it is 8 pixels high: time, error against
    /// triangles with 256 samples a pixel, flicker, bytes, build time, counters.
    Methods(Box<methods::MethodsArgs>),
    /// Frame times of far voxels along a walk, with and without opacities (.far files; see convert)
    Walk(Box<walk::WalkArgs>),
    /// How far the image-order paper's screen-space midpoints are from exact projection
    VertexError,
}

impl BenchArgs {
    /// Whether `--threads` may list several numbers.
    pub(super) fn takes_thread_list(&self) -> bool {
        matches!(
            self.experiment,
            Experiment::Engines(_) | Experiment::Scaling(_)
        )
    }
}

/// Runs an experiment; `threads` is what `--threads` said.
pub(super) fn run(
    args: &BenchArgs,
    scenes: Vec<String>,
    threads: Option<&ThreadCounts>,
    console: &Console,
) -> Result<(), CliError> {
    // One where nothing was said.
    let counts = threads.map_or_else(|| vec![1], ThreadCounts::resolved);
    match &args.experiment {
        Experiment::Engines(args) => engines::run(args, scenes, &counts, console),
        Experiment::Scaling(args) => scaling::run(args, scenes, &counts, console),
        Experiment::Ablation(args) => ablation::run(args, scenes, &counts, console),
        Experiment::Error(args) => error::run(args, scenes, console),
        Experiment::Flicker(args) => flicker::run(args, scenes, console),
        Experiment::Methods(args) => methods::run(args, console),
        Experiment::Walk(args) => walk::run(args, console),
        Experiment::VertexError => vertex_error::run(console),
    }
}
