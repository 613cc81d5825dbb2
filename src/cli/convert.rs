//! `convert`: a scene in another format.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::args::{Memory, SceneArgs};
use super::console::Console;
use super::error::{CliError, Kind};
use super::render::open;
use super::scenes::Written;
use super::{report, scenes};
use crate::graph::{BuildOptions, ExternalOptions};
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
    /// Build a .vxg outside memory, taking at most this much of it: 512M, 2G; 64M at the least
    #[arg(long, value_name = "SIZE")]
    memory: Option<Memory>,
    /// Folder of the temporary files of --memory, about 22 bytes a voxel; else beside OUT
    #[arg(long, value_name = "DIR", requires = "memory")]
    temp: Option<PathBuf>,
    #[command(flatten)]
    scene: SceneArgs,
}

pub(super) fn run(args: &ConvertArgs, console: &Console) -> Result<(), CliError> {
    store::check_free(&args.output, args.force)?;
    if let Some(memory) = args.memory {
        return build_outside_memory(args, memory, console);
    }
    let scene = open(&args.input, &args.scene, console)?;
    let written = scenes::write(&scene, &args.output, args.force, console.progress())?;
    tell("convert", &args.input, &args.output, &written, console)
}

fn build_outside_memory(
    args: &ConvertArgs,
    memory: Memory,
    console: &Console,
) -> Result<(), CliError> {
    if args.output.extension().is_none_or(|ending| ending != "vxg") {
        return Err(CliError::usage(format!(
            "{}: only a .vxg is built outside memory",
            args.output.display()
        ))
        .advise("end the name in .vxg, or leave --memory out"));
    }
    let beside = match args.output.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(beside)
        .map_err(|e| CliError::new(Kind::Run, format!("{}: {e}", beside.display())))?;
    let external = ExternalOptions {
        build: BuildOptions::default(),
        memory: memory.bytes,
        temporary: args.temp.as_deref().unwrap_or(beside).to_owned(),
    };
    let (written, report) = scenes::build_file(
        &args.input,
        &args.scene,
        external,
        &args.output,
        args.force,
        console.progress(),
    )?;
    if let Some(report) = report {
        console.note(format!(
            "{}: sorted in {} runs; temporary files took {} bytes at most, {} were written to them",
            args.output.display(),
            report.runs,
            report::grouped(report.temporary_bytes),
            report::grouped(report.temporary_written)
        ));
    }
    tell("convert", &args.input, &args.output, &written, console)
}

/// Says what was written.
pub(super) fn tell(
    verb: &str,
    input: &str,
    output: &Path,
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
