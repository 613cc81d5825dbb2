//! `generate`: a generated scene or mesh, written to a file.

use std::path::PathBuf;

use clap::Args;

use super::args::SceneArgs;
use super::console::Console;
use super::error::CliError;
use super::scene_files::{self, Written};
use super::scenes;
use shiftvox::scene::Source;
use shiftvox::whole;
use shiftvox_mesh::generate;

#[derive(Debug, Args)]
pub(super) struct GenerateArgs {
    /// Generator and its settings, such as gen:terrain,depth=10,seed=1 or mesh:tree,seed=2
    ///
    /// The prefix gen: may be left out. Meshes are scan, machine, wheel, tree, stadium, village,
    /// garden, tower, fence, grass and chains.
    #[arg(value_name = "SPEC")]
    spec: String,
    /// File to write, with the ending .vxg, .vox or .ply, for a mesh .ply
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Replace an existing file
    #[arg(long)]
    force: bool,
}

pub(super) fn run(args: &GenerateArgs, console: &Console) -> Result<(), CliError> {
    if args.spec.starts_with(generate::PREFIX) {
        return mesh(args, console);
    }
    scene_files::check_ending(&args.output)?;
    whole::check_free(&args.output, args.force)?;
    let spec = match Source::is_generated(&args.spec) {
        true => args.spec.clone(),
        false => format!("gen:{}", args.spec),
    };
    let scene = scenes::open(&spec, &SceneArgs::default(), console)?;
    let written = scene_files::write(&scene, &args.output, args.force, console.progress())?;
    written.report("generate", &spec, &args.output, console);
    Ok(())
}

fn mesh(args: &GenerateArgs, console: &Console) -> Result<(), CliError> {
    let (kind, seed) = generate::parse(&args.spec).map_err(CliError::input)?;
    let output = &args.output;
    if output.extension().and_then(|e| e.to_str()) != Some("ply") {
        let message = format!("{}: a mesh is written as .ply", output.display());
        return Err(CliError::usage(message).advise("end the name in .ply"));
    }
    whole::check_free(output, args.force)?;
    let mesh = generate::generate(kind, seed);
    let bytes = generate::ply(&mesh);
    whole::write(output, &bytes, args.force)?;
    let written = Written {
        what: "triangles",
        count: mesh.triangles().len() as u64,
        bytes: bytes.len() as u64,
        warnings: Vec::new(),
    };
    written.report("generate", &args.spec, output, console);
    Ok(())
}
