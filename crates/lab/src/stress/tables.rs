//! What a sweep found, as tables.

use super::check::STRICT_TOLERANCE;
use super::findings::{Findings, Key, Tally};
use super::outcome::Check;
use super::sweep::{SweepPlan, TOLERANCES};
use super::vertex::{Hold, Worst};
use crate::report::{Cell, Table};
use shiftvox::project::Coverage;

/// A tolerance in short.
fn tolerance_name(tolerance: f64) -> String {
    if tolerance == 0.0 || tolerance.is_infinite() {
        return format!("{tolerance}");
    }
    format!("1/{}", libm::round(1.0 / tolerance) as u32)
}

fn added<'f>(findings: &'f Findings, wanted: impl Fn(&Key) -> bool + 'f) -> Tally {
    let mut sum = Tally::default();
    for (key, tally) in &findings.tallies {
        if wanted(key) {
            sum.merge(tally);
        }
    }
    sum
}

/// A row for each scene, width and rule.
#[must_use]
pub fn rows(plan: &SweepPlan, findings: &Findings) -> Table {
    let columns = "scene bits coverage tolerance_px cases drawn trapped refused cut_off failed \
        most_records inside holes order covered extra missing";
    let mut table = Table::of("Outcomes", columns);
    for (key, tally) in &findings.tallies {
        let mut row: Vec<Cell> = vec![
            Cell::Text(plan.scenes[key.scene].to_string()),
            u64::from(key.bits).into(),
            Coverage::UNBLENDED[key.coverage].name().into(),
            Cell::Text(TOLERANCES[key.tolerance].to_string()),
        ];
        row.extend(counts(tally).map(Cell::from));
        table.rows.push(row);
    }
    table
}

fn counts(tally: &Tally) -> [u64; 13] {
    [
        tally.cases,
        tally.drawn,
        tally.trapped,
        tally.refused,
        tally.cut_off,
        tally.failed,
        tally.most_records,
        tally.inside,
        tally.holes,
        tally.order,
        tally.covered,
        tally.extra,
        tally.missing,
    ]
}

/// The tables for people.
#[must_use]
pub fn tables(plan: &SweepPlan, findings: &Findings) -> Vec<Table> {
    let scenes = plan.scenes.iter().enumerate();
    let by_scene = scenes.map(|(scene, name)| {
        let sum = added(findings, |key| key.scene == scene);
        (Cell::Text(name.to_string()), sum)
    });
    let viewpoints = findings.viewpoints.iter();
    let by_viewpoint = viewpoints.map(|(name, tally)| (Cell::from(*name), tally.clone()));
    let mut tables = vec![
        frames("By scene", "scene", by_scene),
        by_rule(findings),
        vertices(findings),
        frames("By viewpoint", "viewpoint", by_viewpoint),
        checks(findings),
    ];
    let counted = [
        ("Traps, by operation and stage", &findings.traps),
        ("Views that the set-up refused", &findings.refusals),
    ];
    for (title, counts) in counted {
        let mut table = Table::new(title, &["what", "frames"]);
        for (what, count) in counts {
            table
                .rows
                .push(vec![Cell::Text(what.clone()), (*count).into()]);
        }
        tables.push(table);
    }
    tables
}

/// Frames and their ends, a row for each name.
fn frames<'n>(
    title: &str,
    what: &'static str,
    tallies: impl Iterator<Item = (Cell, Tally)> + 'n,
) -> Table {
    let columns = [
        what,
        "frames",
        "drawn",
        "trapped",
        "refused",
        "cut_off",
        "failed",
        "most_records",
    ];
    let mut table = Table::new(title, &columns);
    for (name, tally) in tallies {
        let mut row = vec![name];
        row.extend(counts(&tally)[..7].iter().map(|&c| Cell::from(c)));
        table.rows.push(row);
    }
    table
}

fn by_rule(findings: &Findings) -> Table {
    let columns = "coverage tolerance frames_drawn samples_inside_closed holes one_in must_be_0 \
        order covered extra missing failed";
    let mut table = Table::of(
        "By rule: holes in closed surfaces, order, coverage against the oracle",
        columns,
    );
    for (coverage, rule) in Coverage::UNBLENDED.iter().enumerate() {
        for (tolerance, px) in TOLERANCES.iter().enumerate() {
            if rule.draws_outlines() && *px != 0.0 {
                continue;
            }
            let sum = added(findings, |key| {
                (key.coverage, key.tolerance) == (coverage, tolerance)
            });
            let one_in = (sum.holes > 0).then(|| sum.inside / sum.holes);
            table.rows.push(vec![
                rule.name().into(),
                Cell::Text(tolerance_name(*px)),
                sum.drawn.into(),
                sum.inside.into(),
                sum.holes.into(),
                one_in.into(),
                match (rule.draws_outlines(), *px <= STRICT_TOLERANCE) {
                    (true, _) => "yes",
                    (_, true) => "but at the level bound",
                    _ => "listed",
                }
                .into(),
                sum.order.into(),
                sum.covered.into(),
                sum.extra.into(),
                sum.missing.into(),
                sum.failed.into(),
            ]);
        }
    }
    table
}

fn vertices(findings: &Findings) -> Table {
    let columns = "held_in bits vertices worst_seen_px its_bound_px seen_over_bound \
        nearest_to_a_bound";
    let mut table = Table::of(
        "Vertex error: worst seen in the picture beside its bound; greatest quotient of error and \
         bound anywhere",
        columns,
    );
    for (place, hold) in Hold::ALL.iter().enumerate() {
        let of_hold = findings.worst.iter().filter(|((h, _), _)| *h == place);
        let mut all = Worst::default();
        let row = |bits: Cell, worst: &Worst| {
            let quotient = (worst.bound_px > 0.0).then(|| worst.error_px / worst.bound_px);
            vec![
                hold.name().into(),
                bits,
                worst.vertices.into(),
                Cell::Text(format!("{:.2e}", worst.error_px)),
                Cell::Text(format!("{:.2e}", worst.bound_px)),
                quotient.map_or(Cell::None, Cell::ratio),
                Cell::ratio(worst.tightest),
            ]
        };
        for ((_, bits), worst) in of_hold {
            all.merge(worst);
            table.rows.push(row(u64::from(*bits).into(), worst));
        }
        if all.vertices > 0 {
            table.rows.push(row("all".into(), &all));
        }
    }
    table
}

fn checks(findings: &Findings) -> Table {
    let mut table = Table::new("Checks", &["check", "failures", "what_it_says"]);
    for check in Check::ALL {
        let count = findings.failures.get(&check).copied().unwrap_or(0);
        table.rows.push(vec![
            check.name().into(),
            count.into(),
            check.about().into(),
        ]);
    }
    table
}
