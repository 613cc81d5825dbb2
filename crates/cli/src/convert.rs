//! `convert`: a scene in another format.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;

use super::args::{Memory, SceneArgs};
use super::console::Console;
use super::error::{CliError, Kind};
use super::scene_files::Conversion;
use super::{far, names, report, scene_files, scenes, textured};
use shiftvox::graph::{BuildOptions, ExternalOptions};
use shiftvox::scene::Source;
use shiftvox::whole;
use shiftvox_mesh::far::view::Opacity;
use shiftvox_mesh::textured::Element;

/// Most rays of a `.far` build: days of work.
const MOST_RAYS: u64 = 1 << 36;

/// Arguments of `convert`.
#[derive(Debug, Args)]
pub struct ConvertArgs {
    /// Scene to read, recognised by its content
    #[arg(value_name = "IN", value_parser = super::names::parser())]
    input: String,
    /// File to write; its ending names the format: .vxg, .vox, .ply or, of a mesh,
    /// .far (far voxels) or .tvx (textured voxels)
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Replace a file that exists
    #[arg(long)]
    force: bool,
    /// Build a .vxg or .far out of core, taking at most this much memory: 512M, 2G; 64M at the
    /// least. The mesh of a .far, which is in memory, is part of it
    #[arg(long, value_name = "SIZE")]
    memory: Option<Memory>,
    /// Folder of the temporary files of --memory, about 22 bytes a voxel of a .vxg, 80 a triangle
    /// of a .far; else beside OUT
    #[arg(long, value_name = "DIR", requires = "memory")]
    temp: Option<PathBuf>,
    /// Of .far: rays of all nodes together [default: up to 24 that look for each voxel, 24 for each
    /// that is seen]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=MOST_RAYS))]
    rays: Option<u64>,
    /// Of .far: nodes with fewer triangles are leaves [default: 1000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..))]
    leaf_triangles: Option<u32>,
    /// Of .far: voxels along a node's longest side [default: 64]. Of .tvx: cells along each axis,
    /// an even number, or several such as 4,8,16,32: a file with a grid of each [default: 16]
    #[arg(long, value_name = "N", value_delimiter = ',',
          value_parser = clap::value_parser!(u32).range(2..=255))]
    grid: Vec<u32>,
    /// Of .tvx: texels along the side of a voxel's face [default: 16]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    texels: Option<u32>,
    /// Of .tvx: structuring element of the erosion [default: sides]
    #[arg(long, value_enum, value_name = "ELEMENT")]
    element: Option<Element>,
    /// Of .far: so many copies of the mesh, in rows on the ground
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    instances: Option<u32>,
    /// Of .far: keep parts wider than a voxel as a decimated surface, and thinner parts as voxels
    #[arg(long)]
    hybrid: bool,
    /// Of .far: stored opacities [default: six]
    #[arg(long, value_enum, value_name = "KIND")]
    far_opacity: Option<Opacity>,
    #[command(flatten)]
    scene: SceneArgs,
}

impl ConvertArgs {
    /// Whether there is a setting of `.far` files alone.
    fn has_far_settings(&self) -> bool {
        self.rays.is_some()
            || self.leaf_triangles.is_some()
            || self.instances.is_some()
            || self.far_opacity.is_some()
            || self.hybrid
    }

    fn conversion(&self) -> Conversion<'_> {
        Conversion {
            input: &self.input,
            output: &self.output,
            force: self.force,
            scene: &self.scene,
        }
    }

    fn far_options(&self) -> shiftvox_mesh::far::BuildOptions {
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

    fn textured_options(&self) -> shiftvox_mesh::textured::BuildOptions {
        let defaults = shiftvox_mesh::textured::BuildOptions::default();
        shiftvox_mesh::textured::BuildOptions {
            grids: if self.grid.is_empty() {
                defaults.grids
            } else {
                self.grid.clone()
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
    if is_ending("tvx") {
        if args.memory.is_some() || args.has_far_settings() {
            return Err(CliError::usage(
                "a .tvx takes --grid, --texels and --element; --memory is for .vxg and .far files, \
                 --rays, --leaf-triangles, --instances, --far-opacity and --hybrid are for \
                 .far files",
            ));
        }
        return textured::convert(&args.conversion(), &args.textured_options(), console);
    }
    if is_ending("far") {
        if args.grid.len() > 1 {
            return Err(CliError::usage("a .far has one --grid"));
        }
        check_temporary(args)?;
        let resources = far::Resources {
            memory: args.memory.map(|memory| memory.bytes),
            temporary: args.temp.as_deref(),
        };
        return far::convert(
            &args.conversion(),
            &args.far_options(),
            args.instances,
            &resources,
            console,
        );
    }
    if args.has_far_settings() || !args.grid.is_empty() {
        return Err(CliError::usage(
            "--rays, --leaf-triangles, --instances, --far-opacity and --hybrid are for .far files, \
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
    let source = Source::find(names::path(&args.input))?;
    let started = Instant::now();
    let scene = scenes::open_source(
        source,
        &args.input,
        &args.scene,
        scenes::Verify::All,
        started,
        console,
    )?;
    let written = scene_files::write(&scene, &args.output, args.force, console.progress())?;
    scene_files::report_written("convert", &args.input, &args.output, &written, console)
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
    memory: Memory,
    console: &Console,
) -> Result<(), CliError> {
    if args.output.extension().is_none_or(|ending| ending != "vxg") {
        return Err(CliError::usage(format!(
            "{}: only a .vxg is built out of core",
            args.output.display()
        ))
        .advise("end the name in .vxg, or leave --memory out"));
    }
    let beside = whole::folder_of(&args.output);
    whole::make_folder(beside)?;
    let external = ExternalOptions {
        build: BuildOptions::default(),
        memory: memory.bytes,
        temporary: args.temp.as_deref().unwrap_or(beside).to_owned(),
    };
    let (written, report) = scene_files::build_file(
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
    scene_files::report_written("convert", &args.input, &args.output, &written, console)
}

#[cfg(test)]
mod tests {
    use clap::{Command, ValueEnum};

    use super::*;
    use shiftvox_mesh::{far, textured};

    #[test]
    fn help_states_the_true_defaults() {
        let command = ConvertArgs::augment_args(Command::new("convert"));
        let states = |flag: &str, default: &str| {
            let argument = command.get_arguments().find(|a| a.get_id() == flag);
            let help = argument.unwrap().get_help().unwrap().to_string();
            let stated = format!("[default: {default}]");
            assert!(help.contains(&stated), "{flag}: {help}, not {stated}");
        };
        let (of_far, of_tvx) = (
            far::BuildOptions::default(),
            textured::BuildOptions::default(),
        );
        states("leaf_triangles", &of_far.leaf_triangles.to_string());
        states("grid", &of_far.grid.to_string());
        states("grid", &of_tvx.grids[0].to_string());
        states("texels", &of_tvx.texels.to_string());
        let element = of_tvx.element.to_possible_value().unwrap();
        states("element", element.get_name());
        let opacity = of_far.opacity.to_possible_value().unwrap();
        states("far_opacity", opacity.get_name());
    }
}
