//! The model's results as tables.

use std::collections::BTreeMap;

use hwmodel::cost::{Breakdown, Fit};
use hwmodel::cycles::{Cause, CycleReport, ScalingRow};
use hwmodel::memory::Widths;
use hwmodel::{Memory, OpClass, Stage};

use super::claims::Claim;
use super::cost::FrameCost;
use super::frame::Counted;
use super::growth::GrowthRow;
use super::record::{Held, RecordField};
use super::rival::Rival;
use super::rules::{Costs, Outcome, RuleRow};
use super::sweep::FormatRow;
use crate::lab::float_rays::Step;
use crate::measure::CoverageError;
use crate::report::{Cell, Table};

/// A number with some digits after the point.
fn number(value: f64, digits: usize) -> Cell {
    if value.is_finite() {
        Cell::Number(value, digits)
    } else {
        Cell::None
    }
}

fn percent(share: f64) -> Cell {
    number(100.0 * share, 1)
}

/// Picojoules as microjoules.
fn micro(pj: f64) -> Cell {
    number(pj / 1e6, 3)
}

/// Operations and cycles by stage.
#[must_use]
pub fn stages(counted: &Counted, cycles: &CycleReport) -> Table {
    let mut table = Table::new(
        "By stage: operations by class, and cycles of its blocks",
        &[
            "stage",
            "visits",
            "add",
            "subtract",
            "compare",
            "min_max",
            "select",
            "shift",
            "logic",
            "divide_step",
            "busy",
            "held",
            "used_percent",
            "stall",
            "stalls_most_for",
        ],
    );
    let counts = counted.counter.sum_by(|cell| (cell.stage, cell.class));
    for stage in &cycles.stages {
        let mut row = vec![Cell::from(stage.stage.name()), Cell::from(stage.visits)];
        row.extend(
            OpClass::ALL
                .iter()
                .map(|&class| Cell::from(counts.get(&(stage.stage, class)).copied())),
        );
        let worst = Cause::ALL
            .into_iter()
            .rev()
            .max_by_key(|&c| stage.stalls.of(c));
        let worst = worst.filter(|&cause| stage.stalls.of(cause) > 0);
        row.extend([
            Cell::from(stage.busy),
            Cell::from(stage.held),
            percent(stage.utilisation),
            Cell::from(stage.stalls.total()),
            worst.map_or(Cell::None, |cause| Cell::from(cause.name())),
        ]);
        table.rows.push(row);
    }
    table
}

/// Operations by class and width.
#[must_use]
pub fn classes(counted: &Counted) -> Table {
    let mut table = Table::new(
        "Operations by class and width",
        &["class", "bits", "operations", "a_record"],
    );
    let records = counted.counter.records().max(1) as f64;
    for ((class, bits), times) in counted.counter.sum_by(|cell| (cell.class, cell.bits)) {
        table.rows.push(vec![
            Cell::from(class.name()),
            Cell::from(u64::from(bits)),
            Cell::from(times),
            number(times as f64 / records, 2),
        ]);
    }
    table
}

/// Records and operations by octree level.
#[must_use]
pub fn levels(counted: &Counted) -> Table {
    let mut table = Table::new(
        "By octree level",
        &[
            "level",
            "records",
            "operations",
            "node_reads",
            "fill_vector_reads",
            "pixels",
        ],
    );
    let counter = &counted.counter;
    let operations = counter.sum_by(|cell| cell.level);
    let accesses = counter.accesses_by(|cell| (cell.level, cell.memory));
    for (level, records) in counter.records_by_level() {
        let of = |memory: Memory| accesses.get(&(level, memory)).copied().unwrap_or_default();
        table.rows.push(vec![
            Cell::from(u64::from(level)),
            Cell::from(records),
            Cell::from(operations.get(&level).copied().unwrap_or(0)),
            Cell::from(of(Memory::Node).reads),
            Cell::from(of(Memory::FillVector).reads),
            Cell::from(of(Memory::Pixel).writes),
        ]);
    }
    table
}

/// The fields of a record.
#[must_use]
pub fn record(fields: &[RecordField]) -> Table {
    let mut table = Table::new("A record on the stack", &["field", "bits", "held"]);
    for field in fields.iter().filter(|field| field.bits > 0) {
        let held = match field.held {
            Held::Always => "always",
            Held::InClipSpace => "in clip space",
            Held::InScreenSpace => "in screen space",
        };
        table.rows.push(vec![
            Cell::from(field.name),
            Cell::from(u64::from(field.bits)),
            Cell::from(held),
        ]);
    }
    table
}

/// Traffic by memory.
#[must_use]
pub fn memories(counted: &Counted, widths: &Widths, cycles: &CycleReport) -> Table {
    let mut table = Table::new(
        "Memories",
        &[
            "memory",
            "reads",
            "writes",
            "bits_an_access",
            "kilobytes",
            "different_addresses",
            "cache_hits_percent",
            "outer_kilobytes",
        ],
    );
    let probe = &counted.memory;
    let kilobytes = |bits: u64| number(bits as f64 / 8192.0, 1);
    for memory in Memory::ALL {
        let cache = match memory {
            Memory::Node => Some(&cycles.node_cache),
            Memory::Attribute => Some(&cycles.attribute_cache),
            _ => None,
        };
        table.rows.push(vec![
            Cell::from(memory.name()),
            Cell::from(probe.reads(memory)),
            Cell::from(probe.writes(memory)),
            Cell::from(u64::from(widths.of(memory))),
            kilobytes(probe.read_bits(memory) + probe.written_bits(memory)),
            Cell::from(probe.distinct(memory)),
            cache.map_or(Cell::None, |cache| percent(cache.hit_rate)),
            cache.map_or(Cell::None, |cache| kilobytes(8 * cache.bytes_in)),
        ]);
    }
    table
}

/// The miss curve of nodes, at powers of two.
#[must_use]
pub fn miss_curve(counted: &Counted) -> Table {
    let mut table = Table::new(
        "Misses of node caches of every size (fully associative, one pass)",
        &["bytes", "lines", "misses", "miss_percent"],
    );
    for (_, curve) in counted.memory.curves() {
        let line = u64::from(curve.line_bytes());
        let accesses = curve.accesses().max(1) as f64;
        let mut lines = 1;
        loop {
            let misses = curve.misses(lines);
            table.rows.push(vec![
                Cell::from(lines * line),
                Cell::from(lines),
                Cell::from(misses),
                percent(misses as f64 / accesses),
            ]);
            if lines >= curve.distinct_lines() {
                break;
            }
            lines *= 2;
        }
    }
    table
}

/// What no frame on this hardware goes below, and what the contexts did.
#[must_use]
pub fn bounds(cycles: &CycleReport) -> Table {
    let mut table = Table::new(
        "What limits: cycles below which each resource does not go",
        &["resource", "cycles", "percent_of_the_frame"],
    );
    for bound in &cycles.bounds {
        table.rows.push(vec![
            Cell::Text(bound.resource.clone()),
            Cell::from(bound.cycles),
            percent(bound.share),
        ]);
    }
    table
}

/// Scaling with lanes.
#[must_use]
pub fn lanes(rows: &[ScalingRow]) -> Table {
    let mut table = Table::new(
        "By number of lanes",
        &[
            "lanes",
            "cycles",
            "speed_up",
            "efficiency_percent",
            "records",
            "work_over_span",
            "what_limits",
        ],
    );
    for row in rows {
        table.rows.push(vec![
            Cell::from(u64::from(row.lanes)),
            Cell::from(row.cycles),
            number(row.speedup, 2),
            percent(row.efficiency),
            Cell::from(row.records),
            number(row.parallelism, 1),
            Cell::Text(row.bottleneck.clone()),
        ]);
    }
    table
}

/// A sum of costs line by line, each with its rows and source.
#[must_use]
pub fn breakdown(title: &str, unit: &'static str, sum: &Breakdown) -> Table {
    let mut table = Table::new(
        title,
        &[
            "for",
            "operation",
            "bits",
            "times",
            "each",
            unit,
            "figure",
            "rows",
            "source",
        ],
    );
    for line in sum.lines.iter().filter(|line| line.times > 0) {
        let each = &line.each;
        let mut figure = match each.fit {
            Fit::Row => "row",
            Fit::Interpolated => "interpolated",
            Fit::Extrapolated => "extrapolated",
        }
        .to_owned();
        if each.derived {
            figure += ", derived";
        }
        if each.is_range() {
            figure += &format!(", {:.3} to {:.3}", each.low, each.high);
        }
        table.rows.push(vec![
            Cell::Text(line.name.clone()),
            Cell::Text(line.operation.clone()),
            Cell::from(u64::from(line.width)),
            Cell::from(line.times),
            number(each.value, 4),
            number(line.total, 1),
            Cell::Text(figure),
            Cell::Text(each.rows.clone()),
            Cell::Text(each.source.clone()),
        ]);
    }
    table
}

/// The light hardware and the ray caster, side by side.
#[must_use]
pub fn side_by_side(
    counted: &Counted,
    wrong: &CoverageError,
    cost: &FrameCost,
    rival: &Rival,
) -> Table {
    let mut table = Table::new(
        "The light hardware beside a ray caster in 32-bit floating point, same view",
        &["what", "light_hardware", "ray_caster"],
    );
    let counter = &counted.counter;
    let by_class = counter.sum_by(|cell| cell.class);
    let of = |class: OpClass| by_class.get(&class).copied().unwrap_or(0);
    let counts = &rival.counts;
    let mut row = |what: &str, light: Cell, ray: Cell| {
        table.rows.push(vec![Cell::from(what), light, ray]);
    };
    row(
        "multiplies",
        Cell::from(0),
        Cell::from(counts.of(Step::FloatMultiply)),
    );
    row(
        "divides",
        Cell::from(0),
        Cell::from(counts.of(Step::FloatDivide)),
    );
    row(
        "divide steps (subtract and select)",
        Cell::from(of(OpClass::DivideStep)),
        Cell::None,
    );
    row(
        "adds and subtracts (integer; float)",
        Cell::from(of(OpClass::Add) + of(OpClass::Sub)),
        Cell::from(counts.of(Step::FloatAdd)),
    );
    row(
        "compares, minima, maxima",
        Cell::from(of(OpClass::Compare) + of(OpClass::MinMax)),
        Cell::from(counts.of(Step::FloatCompare) + counts.of(Step::FloatMinMax)),
    );
    row("selects", Cell::from(of(OpClass::Select)), Cell::None);
    row(
        "logic, integer adds, variable shifts",
        Cell::from(of(OpClass::Logic)),
        Cell::from(counts.of(Step::Logic) + counts.of(Step::IntegerAdd) + counts.of(Step::Shift)),
    );
    row(
        "shifts by constants (wires)",
        Cell::from(of(OpClass::Shift)),
        Cell::None,
    );
    row(
        "records; cells that rays looked at",
        Cell::from(counter.records()),
        Cell::from(counts.cells),
    );
    row(
        "node reads",
        Cell::from(counter.reads(Memory::Node)),
        Cell::from(counts.of(Step::NodeRead)),
    );
    row(
        "energy of operations, uJ",
        micro(cost.operations.total),
        micro(rival.cost.operations.total),
    );
    row(
        "energy of memories on the chip, uJ",
        micro(cost.on_chip.total),
        micro(rival.cost.on_chip.total),
    );
    row(
        "energy of outer memory, uJ",
        micro(cost.outer.total),
        micro(rival.cost.outer.total),
    );
    let (light, ray) = (cost.total(), rival.cost.total());
    row("energy, uJ", micro(light.0), micro(ray.0));
    row("  low end", micro(light.1), micro(ray.1));
    row("  high end", micro(light.2), micro(ray.2));
    row(
        "wrong pixels (coverage)",
        Cell::from(wrong.extra + wrong.missing),
        Cell::from(rival.error.extra + rival.error.missing),
    );
    table
}

fn outcome<'o>(outcome: &'o Outcome, note: &mut Cell) -> Option<&'o Costs> {
    match outcome {
        Outcome::Drawn(costs) => Some(costs),
        Outcome::Trapped { trap } => {
            *note = Cell::Text(trap.clone());
            None
        }
        Outcome::Refused { reason } => {
            *note = Cell::Text(reason.clone());
            None
        }
    }
}

fn tolerance(px: f64) -> Cell {
    if px.is_infinite() {
        return Cell::from("inf");
    }
    let part = 1.0 / px;
    if px > 0.0 && part >= 2.0 && part == libm::round(part) {
        Cell::Text(format!("1/{part}"))
    } else {
        Cell::Text(px.to_string())
    }
}

/// Cages, rules and tolerances.
#[must_use]
pub fn rules(rows: &[RuleRow]) -> Table {
    let mut table = Table::new(
        "Cages, drawing rules and tolerances side by side",
        &[
            "cage",
            "coverage",
            "tolerance",
            "records",
            "operations",
            "divide_steps",
            "cycles",
            "record_bits",
            "deepest_stack",
            "energy_uj",
            "area_nand2",
            "extra",
            "missing",
            "other_voxel",
            "note",
        ],
    );
    for row in rows {
        let mut note = Cell::None;
        let costs = outcome(&row.outcome, &mut note);
        let count = |of: fn(&Costs) -> u64| costs.map_or(Cell::None, |c| Cell::from(of(c)));
        table.rows.push(vec![
            Cell::Text(format!("{:?}", row.cage).to_lowercase()),
            Cell::Text(format!("{:?}", row.coverage).to_lowercase()),
            tolerance(row.tolerance_px),
            count(|c| c.records),
            count(|c| c.operations),
            count(|c| c.divide_steps),
            count(|c| c.cycles),
            Cell::from(u64::from(row.record_bits)),
            count(|c| c.deepest_stack),
            costs.map_or(Cell::None, |c| micro(c.energy_pj)),
            costs.map_or(Cell::None, |c| number(c.area_nand2, 0)),
            count(|c| c.error.extra),
            count(|c| c.error.missing),
            count(|c| c.error.wrong_voxel),
            note,
        ]);
    }
    table
}

/// Word formats.
#[must_use]
pub fn formats(rows: &[FormatRow]) -> Table {
    let mut table = Table::new(
        "Word formats",
        &[
            "bits",
            "fraction_clip",
            "fraction_screen",
            "headroom",
            "rounding_px",
            "record_bits",
            "records",
            "cycles",
            "energy_uj",
            "area_nand2",
            "extra",
            "missing",
            "other_voxel",
            "safe_depth",
            "safe_picture",
            "near_voxels",
            "note",
        ],
    );
    for row in rows {
        let mut note = Cell::None;
        let costs = outcome(&row.outcome, &mut note);
        let count = |of: fn(&Costs) -> u64| costs.map_or(Cell::None, |c| Cell::from(of(c)));
        table.rows.push(vec![
            Cell::from(u64::from(row.bits)),
            Cell::from(row.fraction_bits.map(|f| u64::from(f.0))),
            Cell::from(row.fraction_bits.map(|f| u64::from(f.1))),
            Cell::from(if row.has_headroom { "yes" } else { "no" }),
            number(row.rounding_px, 4),
            Cell::from(u64::from(row.record_bits)),
            count(|c| c.records),
            count(|c| c.cycles),
            costs.map_or(Cell::None, |c| micro(c.energy_pj)),
            costs.map_or(Cell::None, |c| number(c.area_nand2, 0)),
            count(|c| c.error.extra),
            count(|c| c.error.missing),
            count(|c| c.error.wrong_voxel),
            Cell::from(row.safe.depth.map(u64::from)),
            Cell::from(row.safe.picture.map(u64::from)),
            row.safe
                .near_voxels
                .map_or(Cell::None, |near| number(near, 4)),
            note,
        ]);
    }
    table
}

/// Growing pictures, or growing objects.
#[must_use]
pub fn growth(title: &str, rows: &[GrowthRow]) -> Table {
    let mut table = Table::new(
        title,
        &[
            "object",
            "voxels",
            "pixels",
            "drawn",
            "records",
            "operations",
            "operations_a_pixel_drawn",
            "node_reads",
            "order_operations_a_record",
        ],
    );
    for row in rows {
        table.rows.push(vec![
            Cell::Text(row.object.clone()),
            Cell::from(row.voxels),
            Cell::from(row.pixels),
            Cell::from(row.drawn),
            Cell::from(row.records),
            Cell::from(row.operations),
            number(row.operations as f64 / row.drawn.max(1) as f64, 1),
            Cell::from(row.node_reads),
            number(row.order_operations, 3),
        ]);
    }
    table
}

/// Claims and evidence.
#[must_use]
pub fn claims(claims: &[Claim]) -> Table {
    let mut table = Table::new("The paper's claims", &["claim", "holds", "evidence"]);
    for claim in claims {
        let holds = match claim.holds {
            Some(true) => "yes",
            Some(false) => "NO",
            None => "see",
        };
        table.rows.push(vec![
            Cell::from(claim.claim),
            Cell::from(holds),
            Cell::Text(claim.evidence.clone()),
        ]);
    }
    table
}

/// Operations by stage, a value for each class, in the order of [`OpClass::ALL`].
#[must_use]
pub fn operations_by_stage(counted: &Counted) -> BTreeMap<Stage, [u64; OpClass::ALL.len()]> {
    let mut stages = BTreeMap::new();
    for ((stage, class), times) in counted.counter.sum_by(|cell| (cell.stage, cell.class)) {
        stages.entry(stage).or_insert([0; OpClass::ALL.len()])[class as usize] = times;
    }
    stages
}
