//! `bench`: experiments with pictures and their times.

mod made;
mod methods;
mod quality;
mod time;

use clap::{Args, Subcommand};

use super::args::{Size, ThreadCounts};
use super::console::Console;
use super::error::{CliError, Kind};
use shiftvox::budget;
use shiftvox::project::camera::MAX_SIDE;

/// Arguments of `bench`.
#[derive(Debug, Args)]
pub(super) struct BenchArgs {
    #[command(subcommand)]
    experiment: Experiment,
}

/// The experiments.
#[derive(Debug, Subcommand)]
enum Experiment {
    /// Measure how long engines take per frame, and how their pictures differ from the exact one
    ///
    /// A frame is: clear, traverse, write the colour of each sample. Runs are interleaved. With
    /// --variants techniques are switched off one at a time. With --scan the picture or the scene
    /// grows, and exponents of power laws are fitted. With --threads 1,2 engines that use threads
    /// are measured with each number.
    Time(Box<time::TimeArgs>),
    /// Measure error and cost of pictures: methods x cameras x samples
    ///
    /// The truth is exact rays, of a mesh its triangles with 256 samples per pixel. A second
    /// reference gives the noise floor. Methods draw in turn, on one thread. Beside each time are
    /// the operations of the machine, which are the same in every run. With --motions films of a
    /// moving camera give flicker, and pop: the part of it that changes of level of detail cause.
    Quality(Box<quality::QualityArgs>),
}

impl BenchArgs {
    /// Whether `--threads` may list several numbers.
    pub(super) fn takes_thread_list(&self) -> bool {
        matches!(self.experiment, Experiment::Time(_))
    }
}

/// Runs an experiment; `threads` is the value of `--threads`.
pub(super) fn run(
    args: &BenchArgs,
    scenes: Vec<String>,
    threads: Option<&ThreadCounts>,
    console: &Console,
) -> Result<(), CliError> {
    match &args.experiment {
        Experiment::Time(args) => {
            let counts = threads.map_or_else(|| vec![1], ThreadCounts::resolved);
            time::run(args, scenes, &counts, console)
        }
        Experiment::Quality(args) => quality::run(args, scenes, console),
    }
}

/// How often contenders draw.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Measurement")]
struct ScheduleArgs {
    /// Frames per contender before those that count
    #[arg(long, value_name = "N", default_value_t = 1,
          value_parser = clap::value_parser!(u32).range(0..=1000))]
    warmup: u32,
    /// Frames per contender that count; runs are interleaved
    #[arg(long, value_name = "N", default_value_t = 5,
          value_parser = clap::value_parser!(u32).range(1..=10_000))]
    runs: u32,
}

impl ScheduleArgs {
    fn schedule(&self) -> shiftvox_lab::bench::Schedule {
        shiftvox_lab::bench::Schedule {
            warmup: self.warmup,
            runs: self.runs,
        }
    }
}

/// Most pixels of a measured picture: two gigabytes of samples.
const MAX_PIXELS: u64 = 1 << 26;
/// Least bytes per pixel of a measured picture and its reference.
const PIXEL_BYTES: u64 = 40;

/// Rejects pictures that are too large before any work: with a side above `most_side`, or too many
/// pixels.
fn check_sizes(sizes: &[Size], most_side: u32) -> Result<(), CliError> {
    let most_side = most_side.min(MAX_SIDE);
    for size in sizes {
        let pixels = u64::from(size.width) * u64::from(size.height);
        if size.width.max(size.height) > most_side || pixels > MAX_PIXELS {
            let message = format!("a picture of {size} pixels is too large to be measured");
            return Err(CliError::new(Kind::Limit, message).advise(format!(
                "the most is {MAX_PIXELS} pixels, {most_side} a side"
            )));
        }
        budget::check("pictures of this size", pixels * PIXEL_BYTES)?;
    }
    Ok(())
}
