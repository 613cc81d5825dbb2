//! `model --coherent`: films whose frames draw first what the last one showed.

use clap::{Args, ValueEnum};
use serde_json::json;

use super::args::ModelArgs;
use crate::console::Console;
use crate::error::CliError;
use crate::experiment::export::{self, Results};
use crate::experiment::subjects;
use shiftvox::project::{FrameSetup, SetupError};
use shiftvox_lab::model::coherent::{Film, Sums, WAYS, film};
use shiftvox_lab::quality::Motion;
use shiftvox_lab::report::{Cell, Row, Table};

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Path {
    /// The same frame again.
    Still,
    /// Half a degree around the target per frame.
    Turntable,
    /// A hundredth of the way towards the target per frame.
    Walk,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Time coherency")]
pub(super) struct CoherentArgs {
    /// Draw films in which each frame begins with the voxels that the last one showed
    #[arg(long, value_enum, value_name = "LIST", value_delimiter = ',',
          conflicts_with_all = ["explore", "rival", "vectors", "export_ramulator", "export_accelergy", "export_ert"])]
    coherent: Vec<Path>,
    /// Frames of a film after its first
    #[arg(long, value_name = "N", requires = "coherent", default_value_t = 8,
          value_parser = clap::value_parser!(u32).range(1..=1000))]
    frames: u32,
}

impl CoherentArgs {
    pub(super) fn is_asked(&self) -> bool {
        !self.coherent.is_empty()
    }
}

pub(super) fn run(name: &str, args: &ModelArgs, console: &Console) -> Result<(), CliError> {
    export::check(&args.export, [])?;
    let (hardware, prices) = (args.hardware()?, args.hardware.prices()?);
    let (options, overflow) = (args.setup_options(), args.rules.overflow());
    let size = args.size.pair();
    let scene = args.rules.scene_args(&args.scene);
    let subject = subjects::open(name, &args.camera, &scene, size, console)?;
    let graph = &subject.graph;
    let films = &args.coherent.coherent;
    let mut rows = Vec::new();
    console.progress().begin("films", films.len() as u64);
    for path in films {
        let (path, motion) = match path {
            Path::Still => ("still", Motion::Pan(0.0)),
            Path::Turntable => ("turntable", Motion::ALL[0]),
            Path::Walk => ("walk", Motion::ALL[1]),
        };
        let setup = |frame| -> Result<FrameSetup, CliError> {
            let camera = motion
                .after(&subject.camera, frame)
                .map_err(SetupError::from)?;
            let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, &options)?;
            Ok(setup)
        };
        let setups = (0..=args.coherent.frames).map(setup);
        let setups = setups.collect::<Result<Vec<_>, _>>()?;
        let film = film(graph, &setups, &hardware, overflow, &prices)?;
        for (drawing, sums) in WAYS.into_iter().zip(&film.sums) {
            rows.push(row(path, drawing, &film, sums));
        }
        console.progress().advance(1);
    }
    console.progress().end();
    let title = format!(
        "{name}, {} x {}, on hardware `{}`: means of {} frames",
        size.0, size.1, hardware.name, args.coherent.frames
    );
    let fields = json!({ "scene": name, "hardware": hardware });
    let table = Table::collect(title, &rows);
    let results = Results::of_rows("model", fields, &rows, vec![table], Vec::new());
    export::write(&results, &args.export, console)
}

/// Means of a film's frames; ratios to the same film in order.
fn row(path: &str, drawing: &str, film: &Film, sums: &Sums) -> Row {
    let frames = film.frames as f64;
    let mean = |sum: u64| Cell::Number(sum as f64 / frames, 0);
    let ratio = |of: fn(&Sums) -> f64| Cell::Number(of(sums) / of(&film.sums[0]), 3);
    let mut row = Row::default();
    row.put("path", Cell::Text(path.to_owned()));
    row.put("drawing", Cell::Text(drawing.to_owned()));
    row.put("records", mean(sums.records));
    row.put("node_reads", mean(sums.node_reads));
    row.put("node_misses", mean(sums.node_misses));
    row.put("cycles", mean(sums.cycles));
    row.put("energy_uj", Cell::Number(sums.energy_uj / frames, 2));
    row.put("area", Cell::Number(sums.area, 0));
    row.put("records_ratio", ratio(|of| of.records as f64));
    row.put("node_reads_ratio", ratio(|of| of.node_reads as f64));
    row.put("misses_ratio", ratio(|of| of.node_misses as f64));
    row.put("cycles_ratio", ratio(|of| of.cycles as f64));
    row.put("energy_ratio", ratio(|of| of.energy_uj));
    row.put("area_ratio", ratio(|of| of.area));
    row.put("listed", mean(film.listed));
    row.put("differing_samples", Cell::Count(sums.differing_samples));
    row
}
