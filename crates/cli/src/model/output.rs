//! What the model found, to stdout and to files.

use std::path::Path;

use hwmodel::memory::RecordKind;
use hwmodel::statistics::{Statistics, Value as Figure};
use serde_json::{Value, json};

use super::args::ModelArgs;
use super::findings::Findings;
use super::summary::{long_tables, short_tables, summary};
use super::{page, trace};
use crate::console::Console;
use crate::error::{CliError, Kind};
use crate::experiment::context::Context;
use crate::experiment::export::{self, Results};
use crate::report;
use shiftvox::picture::png;
use shiftvox::whole;
use shiftvox_lab::model::{caches, cost, fill_bits, floor, heat, plots, record, statistics};
use shiftvox_lab::report::plot::Panel;
use shiftvox_lab::report::{Cell, Table};

/// Fails before the work where a file would be replaced without `--force`.
pub(super) fn check(args: &ModelArgs) -> Result<(), CliError> {
    let files = &args.files;
    let others = [&files.html, &files.stats, &files.heat, &files.trace];
    export::check_with(&args.export, others.into_iter().flatten())?;
    if let Some(trace) = &files.trace {
        trace::kind(trace)?;
    }
    Ok(())
}

fn file(path: &Path, bytes: &[u8], force: bool, console: &Console) -> Result<(), CliError> {
    whole::write(path, bytes, force)?;
    console.note(format!("{}: written", path.display()));
    Ok(())
}

/// Writes all files, then prints.
pub(super) fn write(found: &Findings, args: &ModelArgs, console: &Console) -> Result<(), CliError> {
    let force = args.export.force;
    let list = statistics::of(
        &found.counted,
        &found.simulated,
        &found.cost,
        &found.area,
        Some(&found.ray_caster),
    );
    let panels = panels(found);
    if let Some(path) = &args.files.stats {
        file(path, list.to_stats_txt().as_bytes(), force, console)?;
    }
    let (map, most) = heat::map(&found.counted.frame);
    let heat_png = png::encode(found.setup.width, found.setup.height, &map)
        .map_err(|e| CliError::new(Kind::Run, e))?;
    if let Some(path) = &args.files.heat {
        file(path, &heat_png, force, console)?;
    }
    if let Some(path) = &args.files.html {
        let html = page::html(found, &panels, &heat_png, most)?;
        file(path, html.as_bytes(), force, console)?;
    }
    let mut printed = vec![summary(found)];
    printed.extend(short_tables(found));
    let results = Results {
        document: document(found, &list),
        rows: rows(&list),
        tables: printed,
        more_tables: long_tables(found),
        preface: Context::now().command_line() + "\n",
        panels,
    };
    export::write(&results, &args.export, console)
}

/// Statistics as rows.
fn rows(list: &Statistics) -> Table {
    let mut table = Table::new("Statistics", &["name", "value", "unit", "description"]);
    for statistic in list.iter() {
        let value = match statistic.value {
            Figure::Count(count) => Cell::from(count),
            Figure::Measure(measure) => Cell::Number(measure, 6),
        };
        table.rows.push(vec![
            Cell::Text(statistic.name.clone()),
            value,
            Cell::Text(statistic.unit.clone()),
            Cell::Text(statistic.description.clone()),
        ]);
    }
    table
}

/// All plots.
fn panels(found: &Findings) -> Vec<Panel> {
    let cycles = &found.simulated.cycles;
    let mut panels = vec![
        plots::operations(&found.counted),
        plots::cycles(cycles),
        plots::roofline(&found.counted, cycles, &found.hardware),
        plots::energy(&found.cost, Some(&found.ray_caster.cost)),
        plots::miss_curve(&found.counted),
    ];
    if !found.lanes.is_empty() {
        panels.push(plots::lanes(&found.lanes));
    }
    if !found.caches.is_empty() {
        panels.push(plots::caches(&found.caches));
    }
    if !found.formats.is_empty() {
        panels.push(plots::formats(&found.formats));
    }
    panels
}

fn document(found: &Findings, list: &Statistics) -> Value {
    let record: Vec<Value> = found
        .counted
        .fields
        .iter()
        .map(|f| json!({ "field": f.name, "bits": f.bits, "held": format!("{:?}", f.held) }))
        .collect();
    let by_kind: Vec<Value> = RecordKind::ALL
        .into_iter()
        .map(|kind| {
            let records = &found.counted.records;
            let accesses = records.of(kind);
            json!({ "kind": kind, "bits": records.bits().of(kind), "popped": accesses.reads, "pushed": accesses.writes })
        })
        .collect();
    let cells: Vec<_> = found.counted.counter.cells().collect();
    let curve: Vec<_> = found
        .counted
        .memory
        .curves()
        .iter()
        .map(|(memory, curve)| {
            json!({ "memory": memory.name(), "line_bytes": curve.line_bytes(), "points": curve.points() })
        })
        .collect();
    report::document(
        "model",
        json!({
            "scene": found.name,
            "voxels": found.subject.graph.voxels,
            "nodes": found.subject.graph.len(),
            "width": found.setup.width,
            "height": found.setup.height,
            "camera": report::camera(&found.subject.camera),
            "word": {
                "bits": found.setup.format.bits(),
                "screen_fraction_bits": found.setup.format.frac(),
                "clip_fraction_bits": found.setup.clip_frac,
            },
            "hardware": found.hardware,
            "record_bits": record::record_bits(&found.counted.fields),
            "shifts": found.counted.shifts.sites(),
            "record": record,
            "records_by_kind": by_kind,
            "stack_bits": cost::stack_bits(&found.hardware, found.counted.record_bits()),
            "fill_vector_bits": fill_bits::fill_store_bits(&found.setup, &found.hardware),
            "accumulator_bits": cost::accumulator_bits(&found.setup),
            "operations": cells,
            "miss_curves": curve,
            "simulated": found.simulated,
            "same_picture": found.differing == 0,
            "differing_samples": found.differing,
            "coverage_error": found.wrong,
            "cost": found.cost,
            "area": found.area,
            "comparison": found.comparison,
            "clock": found.clock,
            "clock_says": found.clock.sentence(),
            "ray_caster": found.ray_caster,
            "claims": found.claims,
            "rules": found.rules,
            "formats": found.formats,
            "lanes": found.lanes,
            "caches": found.caches,
            "caches_say": (!found.caches.is_empty()).then(|| caches::sentence(&found.caches)),
            "floor": found.floor,
            "halves": found.halves,
            "halves_say": (!found.halves.is_empty()).then(|| floor::sentence(&found.halves, &found.floor)),
            "steps": found.steps,
            "numbers": found.numbers,
            "growing_pictures": found.pictures,
            "growing_objects": found.objects,
            "statistics": list,
        }),
    )
}
