//! What the model found, to stdout and to files.

use std::path::Path;

use hwmodel::cycles::{Hardware, Recorder};
use hwmodel::statistics::{Statistics, Value as Figure};
use serde_json::{Value, json};

use super::{Findings, ModelArgs, page};
use crate::cli::bench::context::Context;
use crate::cli::bench::export::{self, Results};
use crate::cli::console::Console;
use crate::cli::error::CliError;
use crate::cli::report;
use crate::lab::model::{cost, heat, plots, record, statistics, tables};
use crate::picture::{png, store};
use crate::report::plot::Panel;
use crate::report::{Cell, Table, grouped, plot};

/// Fails before the work where a file would be replaced without `--force`.
pub(super) fn check(args: &ModelArgs) -> Result<(), CliError> {
    export::check(&args.export)?;
    let files = &args.files;
    for path in [&files.html, &files.stats, &files.heat, &files.trace]
        .into_iter()
        .flatten()
    {
        store::check_free(path, args.export.force)?;
        let others = [&files.html, &files.stats, &files.heat, &files.trace];
        if others
            .iter()
            .filter(|other| other.as_ref() == Some(path))
            .count()
            > 1
        {
            return Err(CliError::usage(format!(
                "{}: two outputs to one file",
                path.display()
            )));
        }
    }
    if let Some(trace) = &files.trace {
        trace_kind(trace)?;
    }
    Ok(())
}

#[derive(Clone, Copy)]
enum TraceKind {
    Events,
    Waves,
}

fn trace_kind(path: &Path) -> Result<TraceKind, CliError> {
    match path.extension().and_then(|e| e.to_str()) {
        Some("json") => Ok(TraceKind::Events),
        Some("vcd") => Ok(TraceKind::Waves),
        _ => Err(CliError::usage(format!(
            "{}: a trace is .json (Perfetto) or .vcd (waveforms)",
            path.display()
        ))),
    }
}

/// Writes a trace.
pub(super) fn write_trace(
    path: &Path,
    recorder: &Recorder,
    hardware: &Hardware,
    force: bool,
    console: &Console,
) -> Result<(), CliError> {
    let mut text = Vec::new();
    match trace_kind(path)? {
        TraceKind::Events => recorder.write_chrome(hardware, &mut text)?,
        TraceKind::Waves => recorder.write_vcd(hardware, &mut text)?,
    }
    file(path, &text, force, console)
}

fn file(path: &Path, bytes: &[u8], force: bool, console: &Console) -> Result<(), CliError> {
    store::write(path, bytes, force)?;
    console.note(format!("{}: written", path.display()));
    Ok(())
}

/// Writes all files, then prints.
pub(super) fn write(found: &Findings, args: &ModelArgs, console: &Console) -> Result<(), CliError> {
    let force = args.export.force;
    let list = statistics::of(
        &found.counted,
        &found.simulated,
        &found.host,
        &found.cost,
        found.area.total,
        Some(&found.rival),
    );
    let panels = panels(found);
    if let Some(path) = &args.files.stats {
        file(path, list.to_stats_txt().as_bytes(), force, console)?;
    }
    let (map, most) = heat::map(&found.counted.frame);
    let heat_png = png::encode(found.setup.width, found.setup.height, &map)
        .map_err(|e| CliError::new(crate::cli::error::Kind::Run, e))?;
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

/// What matters most, in words.
pub(super) fn summary(found: &Findings) -> Table {
    let mut table = Table::new(
        format!(
            "{}, {} x {}, on hardware `{}`: {}",
            found.name,
            found.setup.width,
            found.setup.height,
            found.hardware.name,
            found.simulated.cycles.bottleneck.sentence
        ),
        &["what", "figure"],
    );
    let cycles = &found.simulated.cycles;
    let (energy, low, high) = found.cost.total();
    let ray = found.rival.cost.total().0;
    let bits = found.counted.record_bits();
    let mut row = |what: &str, figure: String| {
        table.rows.push(vec![Cell::from(what), Cell::Text(figure)]);
    };
    row("records", grouped(found.counted.counter.records()));
    row(
        "operations",
        format!(
            "{}, {:.0} a record; none is a multiplication or a division; widest {} bits",
            grouped(found.counted.counter.ops()),
            found.counted.operations_per_record(),
            found.counted.counter.widest()
        ),
    );
    row("the host's set-up", host_in_words(found));
    row(
        "cycles",
        format!(
            "{}: {:.1} a record, {:.1} a pixel; {:.1} frames a second at {} MHz",
            grouped(cycles.cycles),
            cycles.cycles_per_record,
            cycles.cycles_per_pixel,
            cycles.frames_per_second,
            cycles.clock_mhz
        ),
    );
    row(
        "parallelism",
        format!(
            "work {} over span {}: {:.1} contexts could be kept busy; here there are {} (lanes {}, contexts {})",
            grouped(cycles.work),
            grouped(cycles.span),
            cycles.parallelism,
            cycles.lanes * cycles.contexts,
            cycles.lanes,
            cycles.contexts
        ),
    );
    row(
        "records beyond the serial machine's",
        format!(
            "{} ({})",
            cycles.records as i64 - found.counted.counter.records() as i64,
            match found.differing {
                0 => "the picture is the same".to_owned(),
                some => format!(
                    "the picture differs at {}: under this rule, children of one class may claim the same sample",
                    samples(some)
                ),
            },
        ),
    );
    row(
        "stack",
        format!(
            "{bits} bits a record, {} deep at most on a lane here: {} bits ({} in the serial machine); {} entries a lane are {} kbit",
            cycles.stack.deepest,
            grouped(u64::from(bits) * cycles.stack.deepest),
            found.counted.memory.deepest_stack(),
            found.hardware.stack.entries,
            grouped(cost::stack_bits(&found.hardware, bits) / 1024)
        ),
    );
    row(
        "fill vectors",
        format!(
            "{} kbit",
            grouped(cost::fill_vector_bits(&found.setup) / 1024)
        ),
    );
    let accumulators = cost::accumulator_bits(&found.setup);
    if accumulators > 0 {
        row(
            "accumulators",
            format!("{} kbit", grouped(accumulators / 1024)),
        );
    }
    row(
        "node cache",
        format!("{:.1} % hits", 100.0 * cycles.node_cache.hit_rate),
    );
    row(
        "area of the units",
        format!(
            "{:.0} NAND2 equivalents, of those that this frame uses (memories, pipeline registers and control are not in it)",
            found.area.total
        ),
    );
    row(
        "energy",
        format!(
            "{:.1} uJ ({:.1} to {:.1}); a ray caster in float {:.1} uJ: {}",
            energy / 1e6,
            low / 1e6,
            high / 1e6,
            ray / 1e6,
            if energy <= ray {
                format!("{:.2} times as much", ray / energy)
            } else {
                format!("the light hardware needs {:.2} times as much", energy / ray)
            }
        ),
    );
    row(
        "wrong pixels (coverage)",
        format!(
            "{} of {}; the ray caster {}",
            found.wrong.extra + found.wrong.missing,
            grouped(found.wrong.covered),
            found.rival.error.extra + found.rival.error.missing
        ),
    );
    table
}

/// What the host did, beside what the machine did.
fn host_in_words(found: &Findings) -> String {
    let host = &found.host;
    let energy = &host.energy;
    format!(
        "{} steps apart from these, {} multiplies and {} divides among them: {:.2} a record, {:.2} a pixel written; {:.3} uJ ({:.3} to {:.3}, without {} steps that have no row), {:.2} % of what the machine's operations take, {:.2} % of the frame's energy, in which it is not",
        grouped(host.steps),
        grouped(host.multiplies),
        grouped(host.divides),
        host.steps_per_record,
        host.steps_per_pixel,
        energy.total / 1e6,
        energy.low / 1e6,
        energy.high / 1e6,
        grouped(host.unpriced),
        100.0 * energy.total / found.cost.operations.total,
        100.0 * energy.total / found.cost.total().0
    )
}

fn samples(count: u64) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{} sample{plural}", grouped(count))
}

/// The tables that are printed.
pub(super) fn short_tables(found: &Findings) -> Vec<Table> {
    let cycles = &found.simulated.cycles;
    let mut all = vec![
        tables::stages(&found.counted, cycles),
        tables::memories(&found.counted, &found.widths, cycles),
        tables::bounds(cycles),
        tables::host(&found.host),
        tables::side_by_side(&found.counted, &found.wrong, &found.cost, &found.rival),
        tables::claims(&found.claims),
    ];
    if !found.rules.is_empty() {
        all.push(tables::rules(&found.rules));
    }
    if !found.formats.is_empty() {
        all.push(tables::formats(&found.formats));
    }
    if !found.lanes.is_empty() {
        all.push(tables::lanes(&found.lanes));
    }
    if !found.pictures.is_empty() {
        all.push(tables::growth(
            "Growing pictures of one object",
            &found.pictures,
        ));
        all.push(tables::growth(
            "Growing objects in one picture",
            &found.objects,
        ));
    }
    all
}

/// The tables that only files hold.
pub(super) fn long_tables(found: &Findings) -> Vec<Table> {
    vec![
        tables::classes(&found.counted),
        tables::levels(&found.counted),
        tables::record(&found.counted.fields),
        tables::miss_curve(&found.counted),
        tables::host_parts(&found.host),
        tables::breakdown("Energy of the host's set-up", "pj", &found.host.energy),
        tables::breakdown("Energy of the operations", "pj", &found.cost.operations),
        tables::breakdown(
            "Energy of the memories on the chip",
            "pj",
            &found.cost.on_chip,
        ),
        tables::breakdown("Energy of outer memory", "pj", &found.cost.outer),
        tables::breakdown("Area of the units", "nand2", &found.area),
        tables::breakdown(
            "Energy of the ray caster's operations",
            "pj",
            &found.rival.cost.operations,
        ),
        tables::breakdown(
            "Energy of the ray caster's memories on the chip",
            "pj",
            &found.rival.cost.on_chip,
        ),
        tables::breakdown(
            "Energy of the ray caster's outer memory",
            "pj",
            &found.rival.cost.outer,
        ),
    ]
}

/// All plots.
fn panels(found: &Findings) -> Vec<Panel> {
    let cycles = &found.simulated.cycles;
    let mut panels = vec![
        plots::operations(&found.counted),
        plots::cycles(cycles),
        plots::roofline(&found.counted, cycles, &found.hardware),
        plots::energy(&found.cost, Some(&found.rival.cost)),
        plots::miss_curve(&found.counted),
    ];
    if !found.lanes.is_empty() {
        panels.push(plots::lanes(&found.lanes));
    }
    if !found.formats.is_empty() {
        panels.push(plots::formats(&found.formats));
    }
    panels
}

/// One plot as SVG text.
pub(super) fn svg(panel: &Panel) -> Result<String, CliError> {
    Ok(plot::svg(std::slice::from_ref(panel))?)
}

fn document(found: &Findings, list: &Statistics) -> Value {
    let record: Vec<Value> = found
        .counted
        .fields
        .iter()
        .map(|f| json!({ "field": f.name, "bits": f.bits, "held": format!("{:?}", f.held) }))
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
            "record": record,
            "stack_bits": cost::stack_bits(&found.hardware, found.counted.record_bits()),
            "fill_vector_bits": cost::fill_vector_bits(&found.setup),
            "accumulator_bits": cost::accumulator_bits(&found.setup),
            "operations": cells,
            "host": found.host,
            "miss_curves": curve,
            "simulated": found.simulated,
            "same_picture": found.differing == 0,
            "differing_samples": found.differing,
            "coverage_error": found.wrong,
            "cost": found.cost,
            "area": found.area,
            "ray_caster": found.rival,
            "claims": found.claims,
            "rules": found.rules,
            "formats": found.formats,
            "lanes": found.lanes,
            "growing_pictures": found.pictures,
            "growing_objects": found.objects,
            "statistics": list,
        }),
    )
}
