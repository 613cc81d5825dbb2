//! `convert`: a scene in another format.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::args::SceneArgs;
use super::console::Console;
use super::error::CliError;
use super::render::open;
use super::scenes::Written;
use super::{report, scenes};
use crate::picture::store;

/// Arguments of `convert`.
#[derive(Debug, Args)]
pub struct ConvertArgs {
    /// Scene to read, told by its content
    #[arg(value_name = "IN")]
    input: String,
    /// File to write; its ending names the format: .vxg, .vox or .ply
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Replace a file that exists
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    scene: SceneArgs,
}

pub(super) fn run(args: &ConvertArgs, console: &Console) -> Result<(), CliError> {
    store::check_free(&args.output, args.force)?;
    let scene = open(&args.input, &args.scene, console)?;
    let written = scenes::write(&scene, &args.output, args.force, console.progress())?;
    tell("convert", &args.input, &args.output, &written, console)
}

/// Says what was written.
pub(super) fn tell(
    verb: &str,
    input: &str,
    output: &std::path::Path,
    written: &Written,
    console: &Console,
) -> Result<(), CliError> {
    for warning in &written.warnings {
        console.note(format!("{}: {warning}", output.display()));
    }
    console.note(format!(
        "{}: {} voxels, {} bytes",
        output.display(),
        report::grouped(written.voxels),
        report::grouped(written.bytes)
    ));
    if console.json {
        let fields = json!({
            "input": input,
            "output": output,
            "voxels": written.voxels,
            "bytes": written.bytes,
            "warnings": written.warnings,
        });
        console.document(&report::document(verb, fields))?;
    }
    Ok(())
}
