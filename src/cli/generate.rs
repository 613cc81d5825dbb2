//! `generate`: a scene from integers alone, written to a file.

use std::path::PathBuf;

use clap::Args;

use super::args::SceneArgs;
use super::console::Console;
use super::error::CliError;
use super::{scene_files, scenes};
use crate::scene::Source;
use crate::whole;

/// Arguments of `generate`.
#[derive(Debug, Args)]
pub struct GenerateArgs {
    /// Generator and its settings: gen:terrain,depth=10,seed=1 (gen: may be left out)
    #[arg(value_name = "SPEC")]
    spec: String,
    /// File to write; its ending names the format: .vxg, .vox or .ply
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Replace a file that exists
    #[arg(long)]
    force: bool,
}

pub(super) fn run(args: &GenerateArgs, console: &Console) -> Result<(), CliError> {
    scene_files::check_ending(&args.output)?;
    whole::check_free(&args.output, args.force)?;
    let spec = if Source::is_generated(&args.spec) {
        args.spec.clone()
    } else {
        format!("gen:{}", args.spec)
    };
    let scene = scenes::open(&spec, &SceneArgs::default(), console)?;
    let written = scene_files::write(&scene, &args.output, args.force, console.progress())?;
    scene_files::report_written("generate", &spec, &args.output, &written, console)
}
