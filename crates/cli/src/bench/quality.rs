//! `bench quality`: what pictures cost and how far they are from the truth.

use clap::Args;

use super::check_sizes;
use super::made::Made;
use super::methods::{self, Choice, Choices};
use crate::args::{CameraArgs, SceneArgs, Size};
use crate::console::Console;
use crate::error::CliError;
use crate::experiment::context::Context;
use crate::experiment::export::{self, ExportArgs, Results};
use crate::experiment::subjects;
use crate::scenes;
use shiftvox::project::{Bounds, Camera, SetupOptions, Up};
use shiftvox_lab::bench::Schedule;
use shiftvox_lab::quality::{Motion, QualityPlan, Scene, at_distance, charts, measure, table};
use shiftvox_lab::report::Row;
use shiftvox_mesh::{Surface, mesh_box};

const SCENES: [&str; 5] = [
    subjects::BUNDLED,
    "gen:terrain,depth=9",
    "gen:menger,depth=5",
    "gen:wires,depth=8",
    "gen:truss,depth=8",
];
const DEFAULT_SIDE: u32 = 256;
/// Most pixels a side: references take 512 times the work of a picture.
const MOST_SIDE: u32 = 4096;

#[derive(Debug, Args)]
pub(super) struct QualityArgs {
    /// Scenes, as files, generators or `bundled` [default: bundled gen:terrain,depth=9
    /// gen:menger,depth=5 gen:wires,depth=8 gen:truss,depth=8]
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,
    /// Methods to measure [default: some thirty of each kind]
    ///
    /// NAME[=VALUE][:KEY=VALUE]..., such as exact:bits=64+24:lod=0+1,far=six:aa=1+2. All combinations
    /// of alternatives (+) are measured. exact, alpha, any, center and paper have the keys cage,
    /// tolerance, bits, lod, aa and engine (fast, machine). Meshes also have triangles, decimated=N
    /// (one of N triangles), far=none|scalar|six, hybrid and textured=auto|EROSIONS, with the key
    /// aa, and lod of far and hybrid.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    methods: Vec<Choices>,
    /// Pixels, such as 512 (square) or 640x360 [default: 256]
    #[arg(long, value_name = "N|WxH")]
    size: Option<Size>,
    /// Cameras at growing distances, by the heights of their pictures in pixels, such as 190,58,22
    #[arg(long, value_name = "PX,...", value_delimiter = ',',
          value_parser = clap::value_parser!(u32).range(4..=i64::from(MOST_SIDE)))]
    heights: Vec<u32>,
    /// Camera motions to film, for flicker [default: none]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "LIST")]
    motions: Vec<Motion>,
    /// Frames of a film
    #[arg(long, value_name = "N", default_value_t = 5,
          value_parser = clap::value_parser!(u32).range(2..=1000))]
    frames: u32,
    #[command(flatten)]
    schedule: Schedule,
    /// Exact rays of the reference per pixel and axis
    #[arg(long, value_name = "N", default_value = "16",
          value_parser = clap::builder::PossibleValuesParser::new(["2", "4", "8", "16"]))]
    reference_samples: String,
    /// Rays of the build of far voxels [default: as of convert]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    far_rays: Option<u64>,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    export: ExportArgs,
}

impl QualityArgs {
    fn open(
        &self,
        name: &str,
        size: (u32, u32),
        console: &Console,
    ) -> Result<(Made, Vec<Choice>, Camera), CliError> {
        let mut choices = methods::of_list(&self.methods);
        let is_mesh = name != subjects::BUNDLED && scenes::is_mesh(name)?;
        if choices.is_empty() {
            choices = methods::default(is_mesh);
        }
        if is_mesh {
            let (mesh, up) = scenes::open_mesh(name, &self.scene, None, console)?;
            let bounds = Bounds::of_mesh(&mesh_box(&mesh, up == Up::Y));
            let camera = self.camera.camera(&bounds, up, size, 0.0);
            let made = Made::of_mesh(name, mesh, &choices, &self.scene, self.far_rays, console)?;
            return Ok((made, choices, camera));
        }
        let is_of_voxels = |choice: &Choice| matches!(choice, Choice::Voxels(..));
        if !choices.iter().all(is_of_voxels) {
            let message = format!("{name}: only meshes have methods other than coverage rules");
            return Err(CliError::usage(message));
        }
        let subject = subjects::open(name, &self.camera, &self.scene, size, console)?;
        Ok((Made::of_graph(Some(subject.graph)), choices, subject.camera))
    }
}

pub(super) fn run(args: &QualityArgs, console: &Console) -> Result<(), CliError> {
    let names = subjects::names_or(&args.scenes, &SCENES);
    export::check(&args.export, [])?;
    args.camera.check().map_err(CliError::usage)?;
    let side = args.heights.first().copied().unwrap_or(DEFAULT_SIDE);
    let size = args.size.unwrap_or(Size::square(side));
    check_sizes(&[size], MOST_SIDE)?;
    let context = Context::now();
    context.warn(console);
    let samples: u32 = args.reference_samples.parse().unwrap_or(16);
    let plan = QualityPlan {
        schedule: args.schedule,
        motions: args.motions.clone(),
        frames: args.frames,
        strata_log2: samples.ilog2(),
    };
    let mut rows: Vec<Row> = Vec::new();
    for name in &names {
        let (made, choices, camera) = args.open(name, size.pair(), console)?;
        let methods = made.methods(&choices);
        let mut cameras = vec![camera];
        if !args.heights.is_empty() {
            let at = |&height: &u32| at_distance(&camera, height);
            cameras = args.heights.iter().map(at).collect();
        }
        let graph = made.graphs.iter().flatten().next();
        let scene = Scene {
            name,
            graph: graph.map(|(graph, _)| graph),
            mesh: made.mesh.as_ref().map(|mesh| mesh as &dyn Surface),
        };
        let measured = measure(scene, &cameras, &methods, &plan, console.progress());
        rows.extend(measured?);
    }
    let fields = context.json(plan.schedule, &SetupOptions::default());
    let by_picture = |a: &Row, b: &Row| {
        let same = |name: &str| a.get(name) == b.get(name);
        same("scene") && same("size")
    };
    let title = |rows: &[Row]| format!("{}, {}", rows[0].text("scene"), rows[0].text("size"));
    let pictures = || rows.chunk_by(by_picture);
    let tables = pictures().map(|rows| table(&title(rows), rows)).collect();
    let charts = pictures().flat_map(charts).collect();
    let results = Results::of_rows("bench quality", fields, &rows, tables, charts);
    export::write(&results, &args.export, console)
}
