//! What the model found, as tables.

use super::findings::Findings;
use shiftvox_lab::model::range::{Range, Winner};
use shiftvox_lab::model::{cost, fill_bits, tables};
use shiftvox_lab::report::{Cell, Table, grouped};

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
    let light = Range::new(found.cost.total()).times(1e-6);
    let ray = Range::new(found.ray_caster.cost.total()).times(1e-6);
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
            grouped(fill_bits::fill_store_bits(&found.setup, &found.hardware) / 1024)
        ),
    );
    let accumulators = cost::accumulator_bits(&found.setup);
    if accumulators > 0 {
        row(
            "accumulators",
            format!("{} kbit", grouped(accumulators / 1024)),
        );
    }
    let spilled = cycles.stack.spilled;
    if spilled > 0 {
        row(
            "spilled records",
            format!(
                "{}: {} kbit written to outer memory, and as many read back",
                grouped(spilled),
                grouped(cycles.stack.spilled_bits / 1024)
            ),
        );
    }
    row(
        "node cache",
        format!("{:.1} % hits", 100.0 * cycles.node_cache.hit_rate),
    );
    row(
        "clock",
        format!(
            "{} MHz: {}. As it is, {:.0} MHz at most",
            cycles.clock_mhz,
            found.clock.sentence(),
            found.clock.fastest_mhz
        ),
    );
    row(
        "area",
        format!(
            "{} NAND2 equivalents ({} to {}): {}; the ray caster {} ({} to {}). Wires are not in it",
            grouped(found.area.total as u64),
            grouped(found.area.low as u64),
            grouped(found.area.high as u64),
            found
                .area
                .parts()
                .map(|(part, of)| format!("{part} {}", grouped(of.total as u64)))
                .join(", "),
            grouped(found.ray_caster.area.total as u64),
            grouped(found.ray_caster.area.low as u64),
            grouped(found.ray_caster.area.high as u64),
        ),
    );
    row(
        "energy",
        format!(
            "{:.1} uJ ({:.1} to {:.1}); a ray caster in float {:.1} uJ ({:.1} to {:.1}): {}",
            light.value,
            light.low,
            light.high,
            ray.value,
            ray.low,
            ray.high,
            match Winner::by_ranges(light, ray) {
                Winner::Neither => "the ranges overlap, so that neither wins".to_owned(),
                Winner::Light => format!("{:.2} times as much", ray.value / light.value),
                Winner::RayCaster => format!(
                    "the light hardware needs {:.2} times as much",
                    light.value / ray.value
                ),
            }
        ),
    );
    row(
        "wrong pixels (coverage)",
        format!(
            "{} of {}; the ray caster {}",
            found.wrong.extra + found.wrong.missing,
            grouped(found.wrong.covered),
            found.ray_caster.error.extra + found.ray_caster.error.missing
        ),
    );
    table
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
        tables::side_by_side(
            &found.counted,
            &found.wrong,
            &found.cost,
            cycles,
            &found.ray_caster,
        ),
        tables::comparison(&found.comparison),
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
    if !found.caches.is_empty() {
        all.push(tables::caches(&found.caches));
        all.push(tables::halves(&found.halves, &found.floor));
    }
    if !found.steps.is_empty() {
        all.push(tables::steps(&found.steps));
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
        tables::numbers(&found.numbers),
        tables::records_by_kind(&found.counted),
        tables::miss_curve(&found.counted),
        tables::clock(&found.clock),
        tables::breakdown("Energy of the operations", "pj", &found.cost.operations),
        tables::breakdown(
            "Energy of the memories on the chip",
            "pj",
            &found.cost.on_chip,
        ),
        tables::breakdown("Energy of outer memory", "pj", &found.cost.outer),
        tables::area("Area of the light hardware", &found.area),
        tables::area("Area of the ray caster", &found.ray_caster.area),
        tables::shifts(&found.counted),
        tables::breakdown(
            "Energy of the ray caster's operations",
            "pj",
            &found.ray_caster.cost.operations,
        ),
        tables::breakdown(
            "Energy of the ray caster's memories on the chip",
            "pj",
            &found.ray_caster.cost.on_chip,
        ),
        tables::breakdown(
            "Energy of the ray caster's outer memory",
            "pj",
            &found.ray_caster.cost.outer,
        ),
    ]
}
