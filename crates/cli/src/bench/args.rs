//! Flags that the timed experiments share.

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};

use crate::args::{CameraArgs, RuleArgs, SceneArgs, Size, Tolerance};
use crate::engines;
use crate::error::{CliError, Kind};
use crate::experiment::export::ExportArgs;
use shiftvox::budget;
use shiftvox::project::camera::MAX_SIDE;
use shiftvox::project::{Coverage, SetupOptions};
use shiftvox_lab::bench::{Candidate, Scan, Schedule};

/// Most pixels of a picture: two gigabytes of samples.
const MAX_PIXELS: u64 = 1 << 26;

/// Arguments of an experiment on scenes.
#[derive(Debug, Args)]
pub(super) struct SceneBenchArgs {
    /// Scenes: files, generators, or `bundled` [default: gen:terrain,depth=10 gen:menger,depth=5
    /// bundled]
    #[arg(value_name = "SCENE", value_parser = crate::names::parser())]
    pub(super) scenes: Vec<String>,
    #[command(flatten)]
    pub(super) measure: MeasureArgs,
    #[command(flatten)]
    pub(super) camera: CameraArgs,
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    #[command(flatten)]
    pub(super) export: ExportArgs,
}

/// How often, how large, and with which rules.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Measurement")]
pub(super) struct MeasureArgs {
    /// Frames of each contender before those that count
    #[arg(long, value_name = "N", default_value_t = 1,
          value_parser = clap::value_parser!(u32).range(0..=1000))]
    warmup: u32,
    /// Frames of each contender that count; contenders take turns
    #[arg(long, value_name = "N", default_value_t = 5,
          value_parser = clap::value_parser!(u32).range(1..=10_000))]
    runs: u32,
    /// Pixels: 512 for a square, or 640x360
    #[arg(long, value_name = "N|WxH")]
    pub(super) size: Option<Size>,
    /// Several square sizes: size=64..4096*2, or size=100..500+100
    #[arg(long, value_name = "size=A..B*F", value_parser = size_scan)]
    pub(super) scan: Option<Scan>,
    /// Engines to measure
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = engine_names())]
    engines: Vec<String>,
    /// Which pixels a voxel draws [default: exact]
    #[arg(long, value_enum, conflicts_with = "paper")]
    coverage: Option<Coverage>,
    /// Of --coverage any and center: largest deviation in pixels at which a record may change from
    /// clip to screen space [default: 0.125]; with exact and alpha 0 and nothing else
    #[arg(long, value_name = "PX|inf", conflicts_with = "paper")]
    tolerance: Option<Tolerance>,
    /// Nodes of at most this many pixels are drawn as one voxel; 0: only leaves [default: 0.5 with
    /// exact, else 1]
    #[arg(long, value_name = "PX")]
    lod: Option<f64>,
    /// As the image-order paper has it: eight corners, screen space at once, coverage any
    #[arg(long)]
    paper: bool,
}

/// The engines that there are, with a line about each.
fn engine_names() -> PossibleValuesParser {
    let name = |c: &Candidate| PossibleValue::new(c.name).help(c.about);
    engines::CANDIDATES
        .iter()
        .map(name)
        .collect::<Vec<_>>()
        .into()
}

fn size_scan(text: &str) -> Result<Scan, String> {
    let scan: Scan = text.parse()?;
    if scan.name() != "size" {
        return Err(format!("only `size` can be scanned, not `{}`", scan.name()));
    }
    Ok(scan)
}

impl MeasureArgs {
    /// How often each contender draws.
    pub(super) fn schedule(&self) -> Schedule {
        Schedule {
            warmup: self.warmup,
            runs: self.runs,
        }
    }

    /// What frames are drawn with.
    pub(super) fn options(&self) -> SetupOptions {
        let engine = RuleArgs {
            coverage: self.coverage,
            tolerance: self.tolerance,
            lod: self.lod,
            paper: self.paper,
            ..RuleArgs::default()
        };
        engine.options(0)
    }

    /// The sizes that `--scan` or `--size` say, else a square.
    pub(super) fn sizes(&self, default_side: u32) -> Result<Vec<(u32, u32)>, CliError> {
        let sizes = match (&self.scan, self.size) {
            (Some(_), Some(_)) => {
                return Err(CliError::usage("--size and --scan cannot both be given"));
            }
            (Some(scan), None) => squares(scan),
            (None, Some(size)) => vec![(size.width, size.height)],
            (None, None) => vec![(default_side, default_side)],
        };
        check_sizes(&sizes)?;
        Ok(sizes)
    }

    /// Those of `all` that were asked for; the named ones if none was.
    pub(super) fn choose(
        &self,
        all: &[Candidate],
        default: &[&str],
    ) -> Result<Vec<Candidate>, CliError> {
        let known: Vec<&str> = all.iter().map(|candidate| candidate.name).collect();
        if let Some(unknown) = self.engines.iter().find(|n| !known.contains(&n.as_str())) {
            return Err(CliError::usage(format!(
                "engine {unknown} has no part in this experiment"
            ))
            .advise(format!("it is about {}", known.join(", "))));
        }
        let wanted = |name: &str| match self.engines.as_slice() {
            [] => default.contains(&name),
            given => given.iter().any(|given| given == name),
        };
        Ok(all.iter().copied().filter(|c| wanted(c.name)).collect())
    }
}

/// The square sizes of a scan.
pub(super) fn squares(scan: &Scan) -> Vec<(u32, u32)> {
    let sides = scan.values().into_iter();
    sides.map(|side| (side, side)).collect()
}

/// Bytes of a pixel that a measured picture and its reference take at the least.
const PIXEL_BYTES: u64 = 40;

/// Refuses pictures that are too large, before any work.
pub(super) fn check_sizes(sizes: &[(u32, u32)]) -> Result<(), CliError> {
    for &(width, height) in sizes {
        let side = width.max(height);
        let pixels = u64::from(width) * u64::from(height);
        if side > MAX_SIDE || pixels > MAX_PIXELS {
            return Err(CliError::new(
                Kind::Limit,
                format!("a picture of {width}x{height} pixels is too large to be measured"),
            )
            .advise(format!(
                "the most is {MAX_PIXELS} pixels, {MAX_SIDE} a side"
            )));
        }
        budget::check("pictures of this size", pixels * PIXEL_BYTES)?;
    }
    Ok(())
}
