//! `bench coherence`: what a turntable's next frame has in common with the last.

use clap::Args;
use serde_json::json;

use super::args::check_sizes;
use crate::cli::args::{CameraArgs, RuleArgs, SceneArgs, Size};
use crate::cli::console::Console;
use crate::cli::error::CliError;
use crate::cli::experiment::export::ExportArgs;
use crate::cli::experiment::export::{self, Results};
use crate::cli::experiment::subjects;
use crate::cli::{engines, report};
use crate::lab::bench::coherence as experiment;

/// Pixels a side where nothing is said.
const DEFAULT_SIDE: u32 = 1024;

/// Arguments of `bench coherence`.
#[derive(Debug, Args)]
pub(super) struct CoherenceArgs {
    /// Scenes: files, generators, or `bundled` [default: gen:terrain,depth=10 gen:menger,depth=5
    /// bundled]
    #[arg(value_name = "SCENE", value_parser = crate::cli::names::parser())]
    scenes: Vec<String>,
    /// How far the camera goes around its target between two frames, degrees
    #[arg(long, value_name = "DEG,...", value_delimiter = ',',
          default_values_t = [0.0, 0.01, 0.05, 0.25, 1.0, 5.0, 10.0], value_parser = step)]
    steps: Vec<f64>,
    /// Pixels: 512 for a square, or 640x360 [default: 1024]
    #[arg(long, value_name = "N|WxH")]
    size: Option<Size>,
    /// Nodes of at most this many pixels are drawn as one voxel; 0: only leaves [default: 0.5]
    #[arg(long, value_name = "PX")]
    lod: Option<f64>,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    export: ExportArgs,
}

fn step(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(step) if (0.0..=360.0).contains(&step) => Ok(step),
        _ => Err("expected degrees from 0 to 360".to_owned()),
    }
}

pub(super) fn run(
    args: &CoherenceArgs,
    from_config: Vec<String>,
    console: &Console,
) -> Result<(), CliError> {
    export::check(&args.export)?;
    let square = (DEFAULT_SIDE, DEFAULT_SIDE);
    let size = args.size.map_or(square, |size| (size.width, size.height));
    check_sizes(&[size])?;
    let engine = RuleArgs {
        lod: args.lod,
        ..RuleArgs::default()
    };
    let options = engine.options(0);
    let mut rows = Vec::new();
    for name in subjects::names(&args.scenes, from_config) {
        let subject = subjects::open(&name, &args.camera, &args.scene, size, console)?;
        rows.extend(experiment::run(
            &subject,
            size,
            &options,
            &args.steps,
            &engines::FAST,
            console.progress(),
        )?);
    }
    let table = experiment::table(&rows);
    let results = Results {
        document: report::document("bench coherence", json!({ "results": rows })),
        rows: table.clone(),
        tables: vec![table],
        more_tables: Vec::new(),
        preface: "Shares are exact: the same in every run.\n".to_owned(),
        panels: experiment::panels(&rows),
    };
    export::write(&results, &args.export, console)
}
