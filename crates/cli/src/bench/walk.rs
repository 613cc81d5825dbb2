//! `bench walk`: far voxels along a path.

use clap::Args;
use serde_json::json;

use crate::args::{DataBudget, Size};
use crate::console::Console;
use crate::error::CliError;
use crate::experiment::export::ExportArgs;
use crate::experiment::export::{self, Results};
use crate::{names, report};
use shiftvox_lab::far_path::{self as experiment, FarPathPlan};
use shiftvox_mesh::drawing::resident;
use shiftvox_mesh::far::FarFile;
use shiftvox_mesh::far::view::Opacity;

/// Arguments of `bench walk`.
#[derive(Debug, Args)]
pub(super) struct WalkArgs {
    /// Far voxels: .far files
    #[arg(value_name = "FILE.far", required = true, value_parser = crate::names::parser())]
    files: Vec<String>,
    /// Frames of the walk
    #[arg(long, value_name = "N", default_value_t = 140,
          value_parser = clap::value_parser!(u32).range(2..=10_000))]
    frames: u32,
    /// How often it is walked; the least time of each frame counts
    #[arg(long, value_name = "N", default_value_t = 1,
          value_parser = clap::value_parser!(u32).range(1..=1000))]
    runs: u32,
    /// Pixels: 512 for a square, or 640x360 [default: 640x360]
    #[arg(long, value_name = "N|WxH")]
    size: Option<Size>,
    /// Largest voxel, pixels
    #[arg(long, value_name = "PX", default_value_t = 1.0)]
    lod: f64,
    /// What opacities are used for; all take turns
    #[arg(
        long,
        value_enum,
        value_delimiter = ',',
        value_name = "LIST",
        default_value = "none,six"
    )]
    far_opacity: Vec<Opacity>,
    /// Draw hidden nodes too
    #[arg(long)]
    no_culling: bool,
    /// Keep at most this much of the nodes' data in memory: 512M, 2G [default: as the system
    /// decides]
    #[arg(long, value_name = "SIZE")]
    memory: Option<DataBudget>,
    #[command(flatten)]
    export: ExportArgs,
}

pub(super) fn run(args: &WalkArgs, console: &Console) -> Result<(), CliError> {
    export::check(&args.export)?;
    let plan = FarPathPlan {
        frames: args.frames,
        size: args.size.map_or((640, 360), |s| (s.width, s.height)),
        voxel_px: args.lod,
        opacities: args.far_opacity.clone(),
        culling: !args.no_culling,
        runs: args.runs,
    };
    let (mut tables, mut panels, mut documents) = (Vec::new(), Vec::new(), Vec::new());
    for name in &args.files {
        let file = match args.memory {
            Some(memory) => FarFile::open_within(&names::path(name), memory.bytes)?,
            None => FarFile::open(&names::path(name))?,
        };
        let walks = experiment::walk(&file, &plan)?;
        tables.push(experiment::table(name, &walks));
        panels.push(experiment::panel(name, &walks));
        documents.push(json!({
            "file": name,
            "bytes": file.len(),
            "triangles": file.nodes()[0].triangles,
            "memory": resident(&file),
            "walks": walks,
        }));
    }
    let mut rows = tables[0].clone();
    for more in &tables[1..] {
        rows.rows.extend(more.rows.clone());
    }
    let fields = json!({
        "width": plan.size.0,
        "height": plan.size.1,
        "frames": plan.frames,
        "runs": plan.runs,
        "voxel_px": plan.voxel_px,
        "culling": plan.culling,
        "files": documents,
    });
    let results = Results {
        document: report::document("bench walk", fields),
        tables,
        rows,
        more_tables: Vec::new(),
        preface: String::new(),
        panels,
    };
    export::write(&results, &args.export, console)
}
