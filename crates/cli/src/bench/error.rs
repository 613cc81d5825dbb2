//! `bench error`: run time against error.

use clap::Args;
use serde_json::json;

use super::args::check_sizes;
use super::meshes::MeshMethodArgs;
use super::picture_export as pictures;
use super::select::SelectArgs;
use crate::args::{CameraArgs, SceneArgs, Size};
use crate::console::Console;
use crate::error::{CliError, Kind};
use crate::experiment::context::Context;
use crate::experiment::export::ExportArgs;
use crate::experiment::export::{self, Results};
use crate::experiment::subjects;
use crate::{engines, report};
use shiftvox::project::SetupOptions;
use shiftvox_lab::bench::{Schedule, Subject};
use shiftvox_lab::error::{
    self as experiment, ErrorPlan, Method, PixelStyle, SceneErrors, voxel_method,
};

/// Scenes where none is named: a model, a landscape, a sponge, thin things.
pub(super) const SCENES: [&str; 5] = [
    subjects::BUNDLED,
    "gen:terrain,depth=9",
    "gen:menger,depth=5",
    "gen:wires,depth=8",
    "gen:truss,depth=8",
];

/// Pixels a side where nothing is said.
const DEFAULT_SIDE: u32 = 256;
/// Most pixels a side: references are 512 times the work of a picture.
pub(super) const MOST_SIDE: u32 = 4096;

/// Arguments of `bench error`.
#[derive(Debug, Args)]
pub(super) struct ErrorArgs {
    /// Scenes: files, generators, or `bundled` [default: bundled gen:terrain,depth=9
    /// gen:menger,depth=5 gen:wires,depth=8 gen:truss,depth=8]
    #[arg(value_name = "SCENE", value_parser = crate::names::parser())]
    scenes: Vec<String>,
    #[command(flatten)]
    select: SelectArgs,
    #[command(flatten)]
    meshes: MeshMethodArgs,
    /// Pixels: 512 for a square, or 640x360 [default: 256]
    #[arg(long, value_name = "N|WxH")]
    size: Option<Size>,
    /// Frames of each method before those that count
    #[arg(long, value_name = "N", default_value_t = 1,
          value_parser = clap::value_parser!(u32).range(0..=1000))]
    warmup: u32,
    /// Frames of each method that count; methods take turns
    #[arg(long, value_name = "N", default_value_t = 3,
          value_parser = clap::value_parser!(u32).range(1..=10_000))]
    runs: u32,
    #[command(flatten)]
    reference: ReferenceArgs,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    export: ExportArgs,
}

/// How references are sampled.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Measurement")]
pub(super) struct ReferenceArgs {
    /// Exact rays of the reference along each axis of a pixel
    #[arg(long, value_name = "N", default_value = "16",
          value_parser = clap::builder::PossibleValuesParser::new(["2", "4", "8", "16"]))]
    reference_samples: String,
}

impl ReferenceArgs {
    /// Strata of a pixel and axis, as a power of two.
    pub(super) fn strata_log2(&self) -> u32 {
        match self.reference_samples.as_str() {
            "2" => 1,
            "4" => 2,
            "8" => 3,
            _ => 4,
        }
    }
}

pub(super) fn run(
    args: &ErrorArgs,
    from_config: Vec<String>,
    console: &Console,
) -> Result<(), CliError> {
    let names = subjects::names_or(&args.scenes, from_config, &SCENES);
    let scene_args = SceneArgs {
        opacities: args.scene.opacities || args.select.coverages.iter().any(|rule| rule.blends()),
        ..args.scene.clone()
    };
    export::check(&args.export)?;
    pictures::check(&args.export, &names)?;
    let size = reference_size(args.size, DEFAULT_SIDE)?;
    let context = Context::now();
    context.warn(console);
    let plan = ErrorPlan {
        size,
        schedule: Schedule {
            warmup: args.warmup,
            runs: args.runs,
        },
        strata_log2: args.reference.strata_log2(),
        style: PixelStyle::default(),
    };
    let options = args.select.options();
    let mut scenes = Vec::new();
    for name in &names {
        let subject = subjects::open(name, &args.camera, &scene_args, size, console)?;
        let mesh = args.meshes.open(name, &args.scene, console)?;
        let mut methods = if args.meshes.has_voxels(mesh.is_some()) {
            methods(&args.select, &options, &subject, plan.style)
        } else {
            Vec::new()
        };
        let mut references = experiment::References::default();
        if let Some(mesh) = &mesh {
            methods.extend(args.meshes.methods(mesh, plan.style)?);
            references = experiment::References::of_triangles(&mesh.mesh);
        }
        let progress = console.progress();
        let measured = experiment::measure(&subject, &methods, &plan, &mut references, progress)?;
        scenes.push(measured);
    }
    write(args, &scenes, &context, plan.schedule, console)
}

/// The size that `--size` says, else a square; refuses what is too large for a reference.
pub(super) fn reference_size(
    given: Option<Size>,
    default_side: u32,
) -> Result<(u32, u32), CliError> {
    let square = (default_side, default_side);
    let size = given.map_or(square, |size| (size.width, size.height));
    check_sizes(&[size])?;
    if size.0.max(size.1) <= MOST_SIDE {
        return Ok(size);
    }
    let message = format!("a picture of {}x{} has no reference", size.0, size.1);
    Err(CliError::new(Kind::Limit, message).advise(format!("the most is {MOST_SIDE} a side")))
}

/// The image-order engines with all settings. Renderers of meshes join in `meshes`.
fn methods<'s>(
    select: &SelectArgs,
    options: &[SetupOptions],
    subject: &'s Subject,
    style: PixelStyle,
) -> Vec<Method<'s>> {
    let asked = |name: &str| match select.engines.as_slice() {
        [] => name == engines::FAST.name,
        given => given.iter().any(|given| given == name),
    };
    let chosen = engines::CANDIDATES.iter().filter(|c| asked(c.name));
    let mut methods: Vec<Method<'s>> = Vec::new();
    for engine in chosen {
        for &options in options {
            let engine = (engine.name, engine.make);
            methods.push(voxel_method(&subject.graph, engine, options, style));
        }
    }
    methods
}

/// What is shown by octree level: the default, the image-order paper, other rules, more
/// samples.
fn is_shown(method: &str) -> bool {
    const SHOWN: [&str; 5] = [
        "exact frame",
        "any inf corners",
        "any 1/8 frame",
        "center 1/8 frame",
        "exact frame aa 4",
    ];
    SHOWN.contains(&method)
}

fn write(
    args: &ErrorArgs,
    scenes: &[SceneErrors],
    context: &Context,
    schedule: Schedule,
    console: &Console,
) -> Result<(), CliError> {
    let mut fields = context.json(schedule, &SetupOptions::default());
    fields["scenes"] = json!(scenes);
    let mut tables: Vec<_> = scenes.iter().map(experiment::table).collect();
    let shown = |method: &str| is_shown(method);
    let vertices = scenes.iter().map(|s| experiment::vertex_table(s, &shown));
    tables.extend(vertices.filter(|table| !table.rows.is_empty()));
    let panels: Vec<_> = scenes
        .iter()
        .map(|scene| (scene.scene.clone(), experiment::panels(scene)))
        .collect();
    pictures::write_plots(&args.export, &panels, console)?;
    let results = Results {
        document: report::document("bench error", fields),
        rows: experiment::rows(scenes),
        tables,
        more_tables: Vec::new(),
        preface: context.markdown(schedule),
        panels: Vec::new(),
    };
    export::write_without_plots(&results, &args.export, console)
}
