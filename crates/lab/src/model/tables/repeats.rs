//! A frame drawn in many ways: rules, word formats, lanes, sizes; and claims.

use hwmodel::cycles::ScalingRow;

use super::{micro, number, percent};
use crate::model::caches::{self, CacheRow};
use crate::model::claims::Claim;
use crate::model::floor::{self, Floor, HalfRow};
use crate::model::growth::GrowthRow;
use crate::model::rules::{Costs, Outcome, RuleRow};
use crate::model::steps::StepRow;
use crate::model::sweep::FormatRow;
use crate::report::{Cell, Table};

/// Both designs with node caches of growing size; who needs less stands above it.
#[must_use]
pub fn caches(rows: &[CacheRow]) -> Table {
    let mut table = Table::of(
        caches::sentence(rows),
        "node_cache design energy_uj low_uj high_uj cycles node_misses needs_less_energy",
    );
    for row in rows {
        for point in std::iter::once(&row.light).chain(&row.ray_caster) {
            let design = match point.order {
                None => "light hardware".to_owned(),
                Some(order) => format!("ray caster, {}", order.name()),
            };
            table.rows.push(vec![
                Cell::Text(caches::size(row.bytes)),
                Cell::Text(design),
                micro(point.energy_pj.value),
                micro(point.energy_pj.low),
                micro(point.energy_pj.high),
                Cell::from(point.cycles),
                Cell::from(point.node_misses),
                if point.order.is_some() && point.order == row.best.order {
                    Cell::from(row.winner.name())
                } else {
                    Cell::None
                },
            ]);
        }
    }
    table
}

/// Half of the ray caster's energy, and what every design must move.
#[must_use]
pub fn halves(rows: &[HalfRow], floor: &Floor) -> Table {
    let mut table = Table::of(
        floor::sentence(rows, floor),
        "node_cache half_uj floor_uj light_of_ray_caster_percent \
         floor_of_ray_caster_percent half_is",
    );
    for row in rows {
        table.rows.push(vec![
            Cell::Text(caches::size(row.bytes)),
            micro(row.half_pj.value),
            micro(row.floor_pj.value),
            percent(row.light_share),
            percent(row.floor_share),
            Cell::from(if row.is_impossible {
                "impossible"
            } else {
                "not excluded"
            }),
        ]);
    }
    table
}

/// What each setting of an organisation gives.
#[must_use]
pub fn steps(rows: &[StepRow]) -> Table {
    let mut table = Table::of(
        "What each setting of the organisation gives: alone, then on top of those before it",
        "setting with_those_before stack_entry_bits node_reads node_misses fill_kbit \
         fill_accesses operations_uj on_chip_uj outer_uj all_uj ray_caster_uj area_nand2 \
         cycles",
    );
    for row in rows {
        table.rows.push(vec![
            Cell::from(row.step),
            Cell::from(if row.with_those_before { "yes" } else { "no" }),
            Cell::from(u64::from(row.stack_entry_bits)),
            Cell::from(row.node_reads),
            Cell::from(row.node_misses),
            number(row.fill_bits as f64 / 1024.0, 1),
            Cell::from(row.fill_accesses),
            micro(row.operations_pj.value),
            micro(row.on_chip_pj.value),
            micro(row.outer_pj.value),
            micro(row.energy_pj.value),
            micro(row.ray_caster_pj.value),
            number(row.area.value, 0),
            Cell::from(row.cycles),
        ]);
    }
    table
}

/// What became of a frame, as cells: the figures that are requested, in their
/// order, and a note where there are none.
fn outcome(outcome: &Outcome, figures: &[fn(&Costs) -> Cell]) -> (Vec<Cell>, Cell) {
    let none = || vec![Cell::None; figures.len()];
    match outcome {
        Outcome::Drawn(costs) => (figures.iter().map(|of| of(costs)).collect(), Cell::None),
        Outcome::Trapped { trap } => (none(), Cell::Text(trap.clone())),
        Outcome::Refused { reason } => (none(), Cell::Text(reason.clone())),
    }
}

/// Energy, area and errors: what both tables of costs end with.
const LAST: [fn(&Costs) -> Cell; 5] = [
    |c| micro(c.energy_pj),
    |c| number(c.area_nand2, 0),
    |c| Cell::from(c.error.extra),
    |c| Cell::from(c.error.missing),
    |c| Cell::from(c.error.wrong_voxel),
];

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
    let mut table = Table::of(
        "Cages, drawing rules and tolerances side by side: operations without shifts, deepest stack of the serial machine",
        "cage coverage tolerance records operations divide_steps cycles record_bits \
         deepest_stack energy_uj area_nand2 extra missing other_voxel note",
    );
    let figures: [fn(&Costs) -> Cell; 4] = [
        |c| Cell::from(c.records),
        |c| Cell::from(c.operations),
        |c| Cell::from(c.divide_steps),
        |c| Cell::from(c.cycles),
    ];
    let deepest: [fn(&Costs) -> Cell; 1] = [|c| Cell::from(c.deepest_stack)];
    for row in rows {
        let (work, note) = outcome(&row.outcome, &figures);
        let mut cells = vec![
            Cell::Text(format!("{:?}", row.cage).to_lowercase()),
            Cell::Text(format!("{:?}", row.coverage).to_lowercase()),
            tolerance(row.tolerance_px),
        ];
        cells.extend(work);
        cells.push(Cell::from(u64::from(row.record_bits)));
        cells.extend(outcome(&row.outcome, &deepest).0);
        cells.extend(outcome(&row.outcome, &LAST).0);
        cells.push(note);
        table.rows.push(cells);
    }
    table
}

/// Word formats.
#[must_use]
pub fn formats(rows: &[FormatRow]) -> Table {
    let mut table = Table::of(
        "Word formats",
        "bits fraction_clip fraction_screen headroom rounding_px record_bits records cycles \
         energy_uj area_nand2 extra missing other_voxel safe_depth safe_picture near_voxels \
         note",
    );
    let work: [fn(&Costs) -> Cell; 2] = [|c| Cell::from(c.records), |c| Cell::from(c.cycles)];
    for row in rows {
        let (work, note) = outcome(&row.outcome, &work);
        let mut cells = vec![
            Cell::from(u64::from(row.bits)),
            Cell::from(row.fraction_bits.map(|f| u64::from(f.0))),
            Cell::from(row.fraction_bits.map(|f| u64::from(f.1))),
            Cell::from(if row.has_headroom { "yes" } else { "no" }),
            number(row.rounding_px, 4),
            Cell::from(u64::from(row.record_bits)),
        ];
        cells.extend(work);
        cells.extend(outcome(&row.outcome, &LAST).0);
        cells.extend([
            Cell::from(row.safe.depth.map(u64::from)),
            Cell::from(row.safe.picture.map(u64::from)),
            row.safe
                .near_voxels
                .map_or(Cell::None, |near| number(near, 4)),
            note,
        ]);
        table.rows.push(cells);
    }
    table
}

/// Scaling with lanes.
#[must_use]
pub fn lanes(rows: &[ScalingRow]) -> Table {
    let mut table = Table::of(
        "By number of lanes",
        "lanes cycles speed_up efficiency_percent records work_over_span what_limits",
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

/// Growing pictures, or growing objects.
#[must_use]
pub fn growth(title: &str, rows: &[GrowthRow]) -> Table {
    let mut table = Table::of(
        title,
        "object voxels pixels drawn records operations operations_a_pixel_drawn node_reads \
         order_operations_a_record",
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
