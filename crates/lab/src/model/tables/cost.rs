//! What a frame costs, and what the ray caster does.

use hwmodel::cost::{Breakdown, Fit};
use hwmodel::cycles::CycleReport;
use hwmodel::{Memory, OpClass};

use super::{micro, number};
use crate::float_rays::FloatStep;
use crate::measure::CoverageError;
use crate::model::area::DesignArea;
use crate::model::clock::ClockCheck;
use crate::model::compare::ComparedLine;
use crate::model::cost::FrameCost;
use crate::model::frame::Counted;
use crate::model::ray_caster::RayCasterReport;
use crate::report::{Cell, Table};

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
            "low",
            "high",
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
            number(line.times as f64 * each.low, 1),
            number(line.times as f64 * each.high, 1),
            Cell::Text(figure),
            Cell::Text(each.rows.clone()),
            Cell::Text(each.source.clone()),
        ]);
    }
    table
}

/// Area, part by part and line by line.
#[must_use]
pub fn area(title: &str, area: &DesignArea) -> Table {
    let mut all = Breakdown::default();
    for (part, of) in area.parts() {
        for line in &of.lines {
            let name = format!("{part}: {}", line.name);
            let (operation, each) = (&line.operation, line.each.clone());
            all.push(&name, operation, line.width, line.times, each);
        }
    }
    breakdown(title, "nand2", &all)
}

/// Both designs line by line, with the ends of every range.
#[must_use]
pub fn comparison(lines: &[ComparedLine]) -> Table {
    let mut table = Table::of(
        "Both designs, middle, low and high end; of what leaks nothing is known",
        "what unit light_hardware low high ray_caster its_low its_high less",
    );
    for line in lines {
        let mut row = vec![Cell::from(line.what), Cell::from(line.unit)];
        for range in [&line.light, &line.ray_caster] {
            let digits = if range.value >= 1000.0 { 0 } else { 3 };
            row.extend([range.value, range.low, range.high].map(|v| number(v, digits)));
        }
        row.push(Cell::from(if line.overlap {
            "the ranges overlap"
        } else {
            line.less.name()
        }));
        table.rows.push(row);
    }
    table
}

/// Units against the clock.
#[must_use]
pub fn clock(check: &ClockCheck) -> Table {
    let mut table = Table::of(
        format!(
            "Units against the clock of {:.2} ns: {}",
            check.period_ps / 1e3,
            check.sentence()
        ),
        "stage class bits delay_ns pipeline_depth depth_needed meets rows source",
    );
    for unit in &check.units {
        table.rows.push(vec![
            Cell::from(unit.stage.name()),
            Cell::from(unit.class.name()),
            Cell::from(u64::from(unit.width)),
            number(unit.delay_ps / 1e3, 2),
            Cell::from(u64::from(unit.depth)),
            Cell::from(u64::from(unit.depth_needed)),
            Cell::from(if unit.meets() { "yes" } else { "no" }),
            Cell::Text(unit.rows.clone()),
            Cell::Text(unit.source.clone()),
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
    cycles: &CycleReport,
    ray_caster: &RayCasterReport,
) -> Table {
    let mut table = Table::new(
        "The light hardware beside a ray caster in 32-bit floating point, same view",
        &["what", "light_hardware", "ray_caster"],
    );
    let counter = &counted.counter;
    let by_class = counter.sum_by(|cell| cell.class);
    let of = |class: OpClass| by_class.get(&class).copied().unwrap_or(0);
    let counts = &ray_caster.counts;
    let mut row = |what: &str, light: Cell, ray: Cell| {
        table.rows.push(vec![Cell::from(what), light, ray]);
    };
    row(
        "multiplies",
        Cell::from(0),
        Cell::from(counts.of(FloatStep::FloatMultiply)),
    );
    row(
        "divides",
        Cell::from(0),
        Cell::from(counts.of(FloatStep::FloatDivide)),
    );
    row(
        "divide steps (subtract and select)",
        Cell::from(of(OpClass::DivideStep)),
        Cell::None,
    );
    row(
        "adds and subtracts (integer; float)",
        Cell::from(of(OpClass::Add) + of(OpClass::Sub)),
        Cell::from(counts.of(FloatStep::FloatAdd)),
    );
    row(
        "compares, minima, maxima",
        Cell::from(of(OpClass::Compare) + of(OpClass::MinMax)),
        Cell::from(counts.of(FloatStep::FloatCompare) + counts.of(FloatStep::FloatMinMax)),
    );
    row("selects", Cell::from(of(OpClass::Select)), Cell::None);
    row(
        "logic, integer adds, variable shifts",
        Cell::from(of(OpClass::Logic)),
        Cell::from(
            counts.of(FloatStep::Logic)
                + counts.of(FloatStep::IntegerAdd)
                + counts.of(FloatStep::Shift),
        ),
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
        Cell::from(counts.of(FloatStep::NodeRead)),
    );
    row(
        "attribute reads",
        Cell::from(counter.reads(Memory::Attribute)),
        Cell::from(counts.of(FloatStep::AttributeRead)),
    );
    row(
        "order of rays",
        Cell::None,
        Cell::from(ray_caster.order.name()),
    );
    row(
        "cycles (simulated; no fewer than)",
        Cell::from(cycles.cycles),
        Cell::from(ray_caster.cycles.cycles),
    );
    row(
        "frames a second (simulated; at most)",
        number(cycles.frames_per_second, 1),
        number(ray_caster.cycles.frames_per_second, 1),
    );
    row(
        "energy of operations, uJ",
        micro(cost.operations.total),
        micro(ray_caster.cost.operations.total),
    );
    row(
        "energy of memories on the chip, uJ",
        micro(cost.on_chip.total),
        micro(ray_caster.cost.on_chip.total),
    );
    row(
        "energy of outer memory, uJ",
        micro(cost.outer.total),
        micro(ray_caster.cost.outer.total),
    );
    let (light, ray) = (cost.total(), ray_caster.cost.total());
    row("energy, uJ", micro(light.0), micro(ray.0));
    row("  low end", micro(light.1), micro(ray.1));
    row("  high end", micro(light.2), micro(ray.2));
    row(
        "wrong pixels (coverage)",
        Cell::from(wrong.extra + wrong.missing),
        Cell::from(ray_caster.error.extra + ray_caster.error.missing),
    );
    table
}
