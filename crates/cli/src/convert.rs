//! `convert`: a scene in another format.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::args::{SceneArgs, bytes};
use super::console::Console;
use super::error::{CliError, Kind};
use super::scene_files::{self, Written};
use super::{far, report, scenes, textured};
use shiftvox::graph::ExternalOptions;
use shiftvox::scene::{self, Source};
use shiftvox::whole;
use shiftvox_mesh::far::view::Opacity;
use shiftvox_mesh::textured::Element;

/// Most rays of a `.far` build: days of work.
const MOST_RAYS: u64 = 1 << 36;

#[derive(Debug, Args)]
pub(super) struct ConvertArgs {
    /// Scene to read, recognised by its content
    #[arg(value_name = "IN")]
    pub(super) input: String,
    /// File to write, with the ending .vxg, .vox or .ply, or for a mesh .far (far voxels) or .tvx
    /// (textured voxels)
    #[arg(value_name = "OUT")]
    pub(super) output: PathBuf,
    /// Replace an existing file
    #[arg(long)]
    pub(super) force: bool,
    /// Build a .vxg or .far out of core with at most this much memory, such as 64M or 2G. The mesh
    /// of a .far is in temporary files then
    #[arg(long, value_name = "SIZE", value_parser = memory)]
    pub(super) memory: Option<u64>,
    /// Folder of the temporary files of --memory, about 22 bytes per voxel of a .vxg and 100 to 250
    /// per triangle of a .far [default: OUT's folder]
    #[arg(long, value_name = "DIR", requires = "memory")]
    pub(super) temp: Option<PathBuf>,
    /// Rays of a .far [default: up to 28 per voxel, and 20 more per visible voxel]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=MOST_RAYS))]
    rays: Option<u64>,
    /// Triangles below which a node of a .far is a leaf [default: 1000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..))]
    leaf_triangles: Option<u32>,
    /// Voxels along the longest side of a .far's node [default: 64]. For a .tvx, cells along each axis of
    /// its grids, such as 4,8,16 [default: 16]
    #[arg(long, value_name = "N", value_delimiter = ',',
          value_parser = clap::value_parser!(u32).range(2..=255))]
    grid: Vec<u32>,
    /// Texels along the side of a voxel's face of a .tvx [default: 16]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    texels: Option<u32>,
    /// Structuring element of the erosion of a .tvx [default: sides]
    #[arg(long, value_enum, value_name = "ELEMENT")]
    element: Option<Element>,
    /// Build a .far of so many copies of the mesh, in rows on the ground
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) instances: Option<u32>,
    /// Keep the finished nodes of a .far in OUT.unfinished, from which a run after a stopped one continues
    #[arg(long)]
    pub(super) resume: bool,
    /// Keep parts of a .far wider than a voxel as a decimated surface, and thinner parts as voxels
    #[arg(long)]
    hybrid: bool,
    /// Stored opacities of a .far [default: six]
    #[arg(long, value_enum, value_name = "KIND")]
    far_opacity: Option<Opacity>,
    #[command(flatten)]
    pub(super) scene: SceneArgs,
}

const LEAST_MEMORY: u64 = 64 << 20;

fn memory(text: &str) -> Result<u64, String> {
    match bytes(text)? {
        bytes if bytes < LEAST_MEMORY => Err("building takes 64M at the least".to_owned()),
        bytes => Ok(bytes),
    }
}

impl ConvertArgs {
    fn has_far_settings(&self) -> bool {
        self.rays.is_some()
            || self.leaf_triangles.is_some()
            || self.instances.is_some()
            || self.far_opacity.is_some()
            || self.hybrid
            || self.resume
    }

    pub(super) fn report(&self, mut described: Value, build_ms: f64, console: &Console) {
        described["input"] = json!(self.input);
        described["output"] = json!(self.output.display().to_string());
        described["build_ms"] = json!(build_ms);
        console.report("convert", described);
    }

    pub(super) fn far_options(&self) -> shiftvox_mesh::far::BuildOptions {
        let defaults = shiftvox_mesh::far::BuildOptions::default();
        shiftvox_mesh::far::BuildOptions {
            rays: self.rays,
            leaf_triangles: self.leaf_triangles.unwrap_or(defaults.leaf_triangles),
            grid: self.grid.first().copied().unwrap_or(defaults.grid),
            opacity: self.far_opacity.unwrap_or_default(),
            hybrid: self.hybrid,
            ..defaults
        }
    }

    pub(super) fn textured_options(&self) -> shiftvox_mesh::textured::BuildOptions {
        let defaults = shiftvox_mesh::textured::BuildOptions::default();
        shiftvox_mesh::textured::BuildOptions {
            grids: match self.grid.is_empty() {
                true => defaults.grids,
                false => self.grid.clone(),
            },
            texels: self.texels.unwrap_or(defaults.texels),
            element: self.element.unwrap_or(defaults.element),
        }
    }
}

pub(super) fn run(args: &ConvertArgs, console: &Console) -> Result<(), CliError> {
    whole::check_free(&args.output, args.force)?;
    let is_ending = |name: &str| args.output.extension().is_some_and(|ending| ending == name);
    if !is_ending("tvx") && (args.texels.is_some() || args.element.is_some()) {
        return Err(CliError::usage("--texels and --element are for .tvx files"));
    }
    let mut idle = args.scene.given().filter(|&flag| flag != "mesh-colors");
    if (is_ending("tvx") || is_ending("far"))
        && let Some(idle) = idle.next()
    {
        let message = format!("--{idle} changes nothing in a .far or .tvx file");
        return Err(CliError::usage(message).advise("leave it out"));
    }
    if is_ending("tvx") {
        if args.memory.is_some() || args.has_far_settings() {
            return Err(CliError::usage(
                "a .tvx takes --grid, --texels and --element; --memory is for .vxg and .far files, \
                 --rays, --leaf-triangles, --instances, --far-opacity, --resume and --hybrid are for \
                 .far files",
            ));
        }
        return textured::convert(args, console);
    }
    if is_ending("far") {
        if args.grid.len() > 1 {
            return Err(CliError::usage("a .far has one --grid"));
        }
        check_temporary(args)?;
        return far::convert(args, console);
    }
    if args.has_far_settings() || !args.grid.is_empty() {
        return Err(CliError::usage(
            "--rays, --leaf-triangles, --instances, --far-opacity, --resume and --hybrid are for .far files, \
             --grid for .far and .tvx files",
        ));
    }
    scene_files::check_ending(&args.output)?;
    check_temporary(args)?;
    if let Some(memory) = args.memory {
        if args.scene.opacities {
            return Err(CliError::usage(
                "--opacities are found in memory: leave --memory out, or ask for fewer levels with \
                 --depth",
            ));
        }
        return build_outside_memory(args, memory, console);
    }
    let scene = scenes::open(&args.input, &args.scene, console)?;
    let written = scene_files::write(&scene, &args.output, args.force, console.progress())?;
    written.report("convert", &args.input, &args.output, console);
    Ok(())
}

fn check_temporary(args: &ConvertArgs) -> Result<(), CliError> {
    match args.temp.as_deref().filter(|folder| !folder.is_dir()) {
        None => Ok(()),
        Some(temporary) => {
            let message = format!("{}: there is no such folder", temporary.display());
            let error = CliError::new(Kind::Run, message);
            Err(error.advise("make it first, or name another with --temp"))
        }
    }
}

fn build_outside_memory(
    args: &ConvertArgs,
    memory: u64,
    console: &Console,
) -> Result<(), CliError> {
    if args.output.extension().is_none_or(|ending| ending != "vxg") {
        return Err(CliError::usage(format!(
            "{}: only .vxg and .far files are built out of core",
            args.output.display()
        ))
        .advise("end the name in .vxg (or .far, of a mesh), or leave --memory out"));
    }
    if args.scene.crop.is_some() {
        return Err(CliError::usage(
            "--crop needs the scene in memory: leave --memory out",
        ));
    }
    let beside = whole::folder_of(&args.output);
    whole::make_folder(beside)?;
    let external = ExternalOptions {
        memory,
        temporary: args.temp.as_deref().unwrap_or(beside).to_owned(),
    };
    let options = scenes::options(&args.scene);
    let built = scene::build_file(
        Source::find(&args.input)?,
        &options.voxels,
        &options.mesh,
        external,
        &args.output,
        args.force,
        console.progress(),
    )?;
    if let Some(report) = built.report {
        console.note(format!(
            "{}: sorted in {} runs; temporary files took {} bytes at most, {} were written to them",
            args.output.display(),
            report.runs,
            report::grouped(report.temporary_bytes),
            report::grouped(report.temporary_written)
        ));
    }
    let written = Written {
        what: "voxels",
        count: built.voxels,
        bytes: built.bytes,
        warnings: built.warnings,
    };
    written.report("convert", &args.input, &args.output, console);
    Ok(())
}
