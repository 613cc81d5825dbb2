//! `bench flicker`: films of a camera that moves a little.

use clap::{Args, ValueEnum};
use serde_json::json;

use super::error::{SCENES, reference_size};
use super::meshes::MeshMethodArgs;
use super::picture_export as pictures;
use crate::args::{CameraArgs, SceneArgs, Size};
use crate::console::Console;
use crate::error::CliError;
use crate::experiment::export::ExportArgs;
use crate::experiment::export::{self, Results};
use crate::experiment::subjects;
use crate::{engines, report};
use shiftvox::project::{Coverage, SetupOptions};
use shiftvox_lab::error::{PixelStyle, References, voxel_method};
use shiftvox_lab::flicker::{self as experiment, FilmPlan, Films, Motion};

/// Pixels a side where nothing is said.
const DEFAULT_SIDE: u32 = 128;

/// How the camera moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MotionName {
    /// Half a degree around the target.
    Turntable,
    /// A hundredth of the way towards the target.
    Dolly,
    /// An eighth of a pixel to the right.
    Pan,
}

/// Arguments of `bench flicker`.
#[derive(Debug, Args)]
pub(super) struct FlickerArgs {
    /// Scenes: files, generators, or `bundled` [default: bundled gen:terrain,depth=9
    /// gen:menger,depth=5 gen:wires,depth=8 gen:truss,depth=8]
    #[arg(value_name = "SCENE", value_parser = crate::names::parser())]
    scenes: Vec<String>,
    /// How the camera moves from frame to frame [default: all]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "LIST")]
    motions: Vec<MotionName>,
    /// Frames of a film
    #[arg(long, value_name = "N", default_value_t = 13,
          value_parser = clap::value_parser!(u32).range(2..=1000))]
    frames: u32,
    /// Pixels: 512 for a square, or 640x360 [default: 128]
    #[arg(long, value_name = "N|WxH")]
    size: Option<Size>,
    /// Exact rays of the reference along each axis of a pixel
    #[arg(long, value_name = "N", default_value = "8",
          value_parser = clap::builder::PossibleValuesParser::new(["2", "4", "8", "16"]))]
    reference_samples: String,
    #[command(flatten)]
    meshes: MeshMethodArgs,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    export: ExportArgs,
}

impl FlickerArgs {
    fn motions(&self) -> Vec<Motion> {
        let wanted = |motion: &Motion| {
            let is_named = |name: &MotionName| match name {
                MotionName::Turntable => matches!(motion, Motion::Turntable { .. }),
                MotionName::Dolly => matches!(motion, Motion::Dolly { .. }),
                MotionName::Pan => matches!(motion, Motion::Pan { .. }),
            };
            self.motions.is_empty() || self.motions.iter().any(is_named)
        };
        Motion::ALL.into_iter().filter(wanted).collect()
    }
}

/// Drawing rules with one and four samples a pixel, `exact` with sixteen; the
/// paper; the default without level of detail; and `alpha` where `blends`.
fn options(blends: bool) -> Vec<SetupOptions> {
    let rules = Coverage::UNBLENDED;
    let one = rules.map(|coverage| (coverage, 0));
    let four = rules.map(|coverage| (coverage, 1));
    let mut all = Vec::new();
    for (coverage, aa_log2) in one.into_iter().chain(four).chain([(Coverage::Exact, 2)]) {
        all.push(SetupOptions {
            aa_log2,
            ..SetupOptions::of(coverage)
        });
    }
    all.push(SetupOptions {
        lod_px: 0.0,
        ..SetupOptions::default()
    });
    all.push(SetupOptions::paper());
    if blends {
        for (lod_px, aa_log2) in [(1.0, 0), (2.0, 0), (1.0, 1)] {
            all.push(SetupOptions {
                coverage: Coverage::Alpha,
                lod_px,
                aa_log2,
                ..SetupOptions::of(Coverage::Alpha)
            });
        }
    }
    all
}

pub(super) fn run(
    args: &FlickerArgs,
    from_config: Vec<String>,
    console: &Console,
) -> Result<(), CliError> {
    let names = subjects::names_or(&args.scenes, from_config, &SCENES);
    export::check(&args.export)?;
    pictures::check(&args.export, &names)?;
    let size = reference_size(args.size, DEFAULT_SIDE)?;
    let samples: u32 = args.reference_samples.parse().unwrap_or(8);
    let plan = FilmPlan {
        size,
        frames: args.frames,
        strata_log2: samples.ilog2(),
        style: PixelStyle::default(),
    };
    let mut films = Vec::new();
    for name in &names {
        let subject = subjects::open(name, &args.camera, &args.scene, size, console)?;
        let engine = (engines::FAST.name, engines::FAST.make);
        let method = |options| voxel_method(&subject.graph, engine, options, plan.style);
        let mesh = args.meshes.open(name, &args.scene, console)?;
        let mut methods: Vec<_> = if args.meshes.has_voxels(mesh.is_some()) {
            let blends = !subject.graph.opacity.is_empty();
            options(blends).into_iter().map(method).collect()
        } else {
            Vec::new()
        };
        // The first frame is the same for all motions.
        let mut references = References::default();
        if let Some(mesh) = &mesh {
            methods.extend(args.meshes.methods(mesh, plan.style)?);
            references = References::of_triangles(&mesh.mesh);
        }
        for motion in args.motions() {
            films.push(experiment::film(
                &subject,
                motion,
                &methods,
                &plan,
                &mut references,
                console.progress(),
            )?);
        }
    }
    write(args, &films, console)
}

fn write(args: &FlickerArgs, films: &[Films], console: &Console) -> Result<(), CliError> {
    let by_scene: Vec<&[Films]> = films.chunk_by(|a, b| a.scene == b.scene).collect();
    let panels: Vec<_> = by_scene
        .iter()
        .map(|films| {
            let panels = films.iter().flat_map(experiment::panels).collect();
            (films[0].scene.clone(), panels)
        })
        .collect();
    pictures::write_plots(&args.export, &panels, console)?;
    let tables = by_scene.iter().map(|films| experiment::table(films));
    let results = Results {
        document: report::document("bench flicker", json!({ "films": films })),
        rows: experiment::table(films),
        tables: tables.collect(),
        more_tables: Vec::new(),
        preface: "The same in every run.\n".to_owned(),
        panels: Vec::new(),
    };
    export::write_without_plots(&results, &args.export, console)
}
