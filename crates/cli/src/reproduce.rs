//! `reproduce`: the image-order paper's Table I and its claims, beside this program's figures.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::args::{CameraArgs, SceneArgs};
use super::console::Console;
use super::engines;
use super::error::CliError;
use super::experiment::context::Context;
use super::experiment::export::{self, ExportArgs, Results};
use super::experiment::subjects;
use super::report;
use shiftvox::project::SetupOptions;
use shiftvox::scene::generate::Spec;
use shiftvox::scene::{OpenError, Source};
use shiftvox_lab::bench::{Harness, Subject};
use shiftvox_lab::reproduce::{self, Engines, Plan, ReproduceError, tables};

/// Arguments of `reproduce`.
#[derive(Debug, Args)]
pub(super) struct ReproduceArgs {
    /// Sides of Table I's pictures, pixels [default: 64,128,256,512,1024]
    #[arg(long, value_name = "LIST", value_delimiter = ',',
          value_parser = clap::value_parser!(u32).range(1..=4096))]
    sides: Vec<u32>,
    /// Side of the pictures in which objects are compared, pixels [default: 512]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    object_side: Option<u32>,
    /// Scenes of one kind and growing detail, smallest first [default: gen:terrain of depth 6 to
    /// 10]
    #[arg(long, value_name = "SCENE", value_delimiter = ';')]
    growing: Vec<String>,
    /// Frames of each contender that count [default: 5]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    runs: Option<u32>,
    /// Folder for all of it: results.json, results.csv, report.md and figures.svg
    #[arg(long, value_name = "DIR")]
    outdir: Option<PathBuf>,
    #[command(flatten)]
    export: ExportArgs,
}

impl From<ReproduceError> for CliError {
    fn from(error: ReproduceError) -> Self {
        match error {
            ReproduceError::Bench(error) => error.into(),
            ReproduceError::Resolve(error) => error.into(),
            ReproduceError::Engine { scene, source } => Self::from(source).at(scene),
        }
    }
}

fn plan(args: &ReproduceArgs) -> Plan {
    let mut plan = Plan::default();
    if !args.sides.is_empty() {
        plan.sides.clone_from(&args.sides);
        plan.sides.sort_unstable();
        plan.sides.dedup();
    }
    if !args.growing.is_empty() {
        plan.growing.clone_from(&args.growing);
    }
    plan.object_side = args.object_side.unwrap_or(plan.object_side);
    plan.schedule.runs = args.runs.unwrap_or(plan.schedule.runs);
    plan
}

/// Where results go: what `--outdir` stands for, unless a flag says another place.
fn exports(args: &ReproduceArgs) -> ExportArgs {
    let mut export = args.export.clone();
    if let Some(folder) = &args.outdir {
        let place = |path: &mut Option<PathBuf>, name: &str| {
            path.get_or_insert_with(|| folder.join(name));
        };
        place(&mut export.export_json, "results.json");
        place(&mut export.export_csv, "results.csv");
        place(&mut export.export_markdown, "report.md");
        place(&mut export.export_svg, "figures.svg");
    }
    export
}

pub(super) fn run(args: &ReproduceArgs, console: &Console) -> Result<(), CliError> {
    let export = exports(args);
    export::check(&export)?;
    let plan = plan(args);
    let context = Context::now();
    context.warn(console);
    let (camera, scene) = (CameraArgs::default(), SceneArgs::default());
    let side = plan.object_side;
    let names = plan.scenes();
    // A wrong name is refused before any scene is made.
    for name in names.iter().filter(|name| Source::is_generated(name)) {
        Spec::parse(name).map_err(OpenError::from)?;
    }
    let subjects: Vec<Subject> = names
        .iter()
        .map(|name| subjects::open(name, &camera, &scene, (side, side), console))
        .collect::<Result<_, _>>()?;
    let (family, order_alone) = (engines::order_family(2), engines::order_family(1));
    let engines = Engines {
        machine: &engines::MACHINE,
        fast: &engines::FAST,
        reference: &engines::REFERENCE,
        family: &family,
        order_alone: &order_alone,
    };
    let progress = console.progress();
    let evidence = reproduce::evidence(&plan, &subjects, progress)?;
    let mut harness = Harness::new(plan.schedule, progress);
    let first = subjects.get(..1).unwrap_or_default();
    let table_one = reproduce::times(first, &plan.sides, &engines, &mut harness)?;
    let objects = reproduce::times(&subjects, &[side], &engines, &mut harness)?;
    let compared: Vec<&Subject> = subjects
        .iter()
        .filter(|s| plan.simple.first() == Some(&s.name) || plan.complex.contains(&s.name))
        .collect();
    let order = reproduce::order(&compared, side, &engines, &mut harness)?;

    let mut fields = context.json(plan.schedule, &SetupOptions::default());
    let order_rows: Vec<Value> = order
        .iter()
        .map(|(settings, row)| json!({ "settings": settings, "row": row }))
        .collect();
    fields["evidence"] = json!(evidence);
    fields["table_1"] = json!(table_one);
    fields["objects"] = json!(objects);
    fields["occlusion_order"] = json!(order_rows);
    fields["paper_law"] = json!(tables::paper_law());
    let rows = tables::table_one(&table_one, &evidence);
    let results = Results {
        document: report::document("reproduce", fields),
        tables: vec![
            rows.clone(),
            tables::laws(&table_one),
            tables::independence(&objects, &plan.growing),
            tables::objects(&objects, &evidence),
            tables::order(&order),
        ],
        rows,
        more_tables: vec![tables::hashes(&evidence)],
        preface: context.markdown(plan.schedule),
        panels: vec![
            tables::figure_five(&table_one),
            tables::object_chart(&objects),
            tables::order_bars(&order),
        ],
    };
    export::write(&results, &export, console)
}
