//! The report, to stdout and to files.

use serde_json::{Value, json};

use super::Found;
use super::args::ModelArgs;
use crate::console::Console;
use crate::error::CliError;
use crate::experiment::export::{self, Results};
use crate::{document, report};
use shiftvox_lab::model::design::LIGHT;
use shiftvox_lab::model::ray_caster::RAY_CASTER;
use shiftvox_lab::model::{accelergy, tables};
use shiftvox_lab::report::{Cell, Table, grouped};

pub(super) fn check(args: &ModelArgs) -> Result<(), CliError> {
    let files = &args.files;
    let others = [
        &files.export_ramulator,
        &files.export_accelergy,
        &files.export_ert,
    ];
    export::check(&args.export, others.into_iter().flatten())
}

/// Files for Accelergy.
fn write_accelergy(found: &Found, args: &ModelArgs, console: &Console) -> Result<(), CliError> {
    let of = &found.report;
    let designs = [(LIGHT, &of.light.cost), (RAY_CASTER, &of.ray_caster.cost)];
    let force = args.export.force;
    if let Some(path) = &args.files.export_accelergy {
        console.write(path, accelergy::counts(&designs, of.technology), force)?;
    }
    if let Some(path) = &args.files.export_ert {
        console.write(path, accelergy::energies(&designs), force)?;
    }
    Ok(())
}

pub(super) fn write(found: &Found, args: &ModelArgs, console: &Console) -> Result<(), CliError> {
    write_accelergy(found, args, console)?;
    let document = describe(found);
    let long = tables::LONG.iter().filter(|_| console.verbose > 0);
    let tables = tables::SHORT.iter().chain(long);
    let tables = tables.map(|spec| spec.of(&document));
    let results = Results {
        rows: tables::figures(&document),
        tables: std::iter::once(summary(found)).chain(tables).collect(),
        charts: Vec::new(),
        document,
    };
    export::write(&results, &args.export, console)
}

fn summary(found: &Found) -> Table {
    let of = &found.report;
    let (cycles, counter) = (&of.simulated.cycles, &found.counted.counter);
    let title = format!(
        "{}, {} x {}, on hardware `{}`: {}",
        found.subject.name,
        found.setup.width,
        found.setup.height,
        of.hardware.name,
        cycles.bottleneck.sentence
    );
    let kilobits = |bits: u64| format!("{} kbit", grouped(bits / 1024));
    let rows = [
        ("records", grouped(counter.records())),
        (
            "operations",
            format!(
                "{}, {:.0} per record; none is a multiplication or a division; widest {} bits",
                grouped(counter.ops()),
                found.counted.operations_per_record(),
                counter.widest()
            ),
        ),
        (
            "cycles",
            format!(
                "{}: {:.1} for each of the {} records of {} contexts, {:.1} per pixel; {:.1} frames per second at {} MHz",
                grouped(cycles.cycles),
                cycles.cycles_per_record,
                grouped(cycles.records),
                cycles.contexts,
                cycles.cycles_per_pixel,
                cycles.frames_per_second,
                cycles.clock_mhz
            ),
        ),
        (
            "parallelism",
            format!(
                "work over span {:.1}; there are {} contexts on {} lanes",
                cycles.parallelism, cycles.contexts, cycles.lanes
            ),
        ),
        (
            "samples unlike the serial machine's",
            grouped(of.differing_samples),
        ),
        (
            "stack",
            format!(
                "{} bits per record, at most {} records deep; all entries take {}; {} records spilled",
                of.record_bits,
                cycles.stack.deepest,
                kilobits(of.stack_bits),
                grouped(cycles.stack.spilled)
            ),
        ),
        ("fill vectors", kilobits(of.fill_vector_bits)),
        ("accumulators", kilobits(of.accumulator_bits)),
        (
            "node cache",
            format!("{:.1} % hits", 100.0 * cycles.node_cache.hit_rate),
        ),
        (
            "clock",
            format!(
                "{}. The units allow {:.0} MHz at most",
                of.clock_says, of.light.clock.fastest_mhz
            ),
        ),
        ("technology of energies", of.technology_says.clone()),
        (
            "wrong pixels (coverage)",
            format!(
                "{} of {}; the ray caster {}",
                of.coverage_error.extra + of.coverage_error.missing,
                grouped(of.coverage_error.covered),
                of.ray_caster.error.extra + of.ray_caster.error.missing
            ),
        ),
    ];
    let mut table = Table::new(title, &["what", "figure"]);
    let rows = rows.map(|(what, figure)| vec![what.into(), Cell::Text(figure)]);
    table.rows.extend(rows);
    table
}

fn describe(found: &Found) -> Value {
    let mut fields = json!(found.report);
    let graph = &found.subject.graph;
    for (key, value) in [
        ("scene", json!(found.subject.name)),
        ("voxels", json!(graph.voxels)),
        ("nodes", json!(graph.len())),
        ("width", json!(found.setup.width)),
        ("height", json!(found.setup.height)),
        ("camera", report::camera(&found.subject.camera)),
    ] {
        fields[key] = value;
    }
    document::document("model", fields)
}
