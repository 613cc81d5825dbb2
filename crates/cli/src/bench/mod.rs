//! `bench`: experiments with pictures and their times.

mod made;
mod methods;
mod quality;
mod time;

use clap::{Args, Subcommand};

use super::args::Size;
use super::console::Console;
use super::error::{CliError, Kind};
use shiftvox::budget;
use shiftvox::project::camera::MAX_SIDE;

#[derive(Debug, Args)]
pub(super) struct BenchArgs {
    #[command(subcommand)]
    experiment: Experiment,
}

#[derive(Debug, Subcommand)]
enum Experiment {
    /// Measure how long engines take per frame, and how their pictures differ from the exact one
    ///
    /// Runs are interleaved. --variants switches techniques off one at a time. --scan varies the size
    /// of the picture or scene and fits exponents of power laws. With --threads 1,2 engines that use
    /// threads are measured with each number.
    Time(Box<time::TimeArgs>),
    /// Measure error and cost of pictures: methods x cameras x samples
    ///
    /// The truth is exact rays, or a mesh's triangles with 256 samples per pixel. A second reference
    /// gives the noise floor. Methods draw in turn, on one thread. --motions films a moving camera
    /// and measures flicker, also of the worst step.
    Quality(Box<quality::QualityArgs>),
}

impl BenchArgs {
    pub(super) fn takes_thread_list(&self) -> bool {
        matches!(self.experiment, Experiment::Time(_))
    }
}

pub(super) fn run(args: &BenchArgs, threads: &[u16], console: &Console) -> Result<(), CliError> {
    match &args.experiment {
        Experiment::Time(args) => time::run(args, &thread_counts(threads), console),
        Experiment::Quality(args) => quality::run(args, console),
    }
}

fn thread_counts(given: &[u16]) -> Vec<usize> {
    let all = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let count = |&count: &u16| if count == 0 { all() } else { count.into() };
    let mut counts: Vec<usize> = given.iter().map(count).collect();
    counts.sort_unstable();
    counts.dedup();
    if counts.is_empty() { vec![1] } else { counts }
}

const MAX_PIXELS: u64 = 1 << 26;
const PIXEL_BYTES: u64 = 40;

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
