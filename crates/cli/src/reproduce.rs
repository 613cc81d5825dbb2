//! `reproduce`: the image-order paper's Table I and its claims, beside this program's figures.

use std::path::PathBuf;

use clap::Args;

use super::args::{CameraArgs, SceneArgs};
use super::console::Console;
use super::document::read_settings;
use super::engines;
use super::error::CliError;
use super::experiment::context::Context;
use super::experiment::export::{self, ExportArgs, Results};
use super::experiment::subjects;
use shiftvox::project::SetupOptions;
use shiftvox::scene::generate::Spec;
use shiftvox::scene::{OpenError, Source};
use shiftvox_lab::bench::{Harness, Schedule, Subject};
use shiftvox_lab::report::Row;
use shiftvox_lab::reproduce::{self, List};

#[derive(Debug, Args)]
pub(super) struct ReproduceArgs {
    /// Measurements as a TOML list [default: the paper's, crates/lab/src/reproduce.toml]
    #[arg(value_name = "LIST.toml")]
    list: Option<PathBuf>,
    /// Frames per contender that count
    #[arg(long, value_name = "N", default_value_t = 5,
          value_parser = clap::value_parser!(u32).range(1..=10_000))]
    runs: u32,
    /// Folder of results.json, results.csv and figures.svg
    #[arg(long, value_name = "DIR")]
    outdir: Option<PathBuf>,
    #[command(flatten)]
    export: ExportArgs,
}

impl ReproduceArgs {
    fn list(&self) -> Result<List, CliError> {
        let (place, text) = match &self.list {
            None => ("the paper's list".to_owned(), List::PAPER.to_owned()),
            Some(path) => (path.display().to_string(), read_settings(path)?),
        };
        toml::from_str(&text).map_err(|e| CliError::input(e).at(place))
    }

    fn exports(&self) -> ExportArgs {
        let mut export = self.export.clone();
        if let Some(folder) = &self.outdir {
            let place = |path: &mut Option<PathBuf>, name: &str| {
                path.get_or_insert_with(|| folder.join(name));
            };
            place(&mut export.export_json, "results.json");
            place(&mut export.export_csv, "results.csv");
            place(&mut export.export_svg, "figures.svg");
        }
        export
    }
}

pub(super) fn run(args: &ReproduceArgs, console: &Console) -> Result<(), CliError> {
    let export = args.exports();
    export::check(&export, [])?;
    let list = args.list()?;
    let generated = |name: &&str| Source::is_generated(name);
    for name in list.scenes().into_iter().filter(generated) {
        Spec::parse(name).map_err(OpenError::from)?;
    }
    for run in &list.run {
        engines::families(&run.engines, &run.variants)?;
    }
    let context = Context::now();
    context.warn(console);
    let schedule = Schedule {
        warmup: 1,
        runs: args.runs,
    };
    let mut harness = Harness::new(schedule, console.progress());
    let mut rows: Vec<Row> = Vec::new();
    for run in &list.run {
        let (camera, scene) = (CameraArgs::default(), SceneArgs::default());
        let open = |name: &String| subjects::open(name, &camera, &scene, (64, 64), console);
        let subjects: Vec<Subject> = run.scenes.iter().map(open).collect::<Result<_, _>>()?;
        let families = engines::families(&run.engines, &run.variants)?;
        let measured = reproduce::rows(run, &subjects, &families, &mut harness);
        rows.extend(measured?);
    }
    let tables = rows.chunk_by(|a, b| a.get("table") == b.get("table"));
    let tables: Vec<&[Row]> = tables.collect();
    let title = |rows: &[Row]| rows[0].text("table");
    let fields = context.json(schedule, &SetupOptions::default());
    let printed = tables
        .iter()
        .map(|rows| reproduce::table(&title(rows), rows));
    let printed = printed.collect();
    let charts = tables
        .iter()
        .filter_map(|rows| reproduce::chart(&title(rows), rows));
    let results = Results::of_rows("reproduce", fields, &rows, printed, charts.collect());
    export::write(&results, &export, console)
}
