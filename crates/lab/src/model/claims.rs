//! The image-order paper's claims, one by one, against what was counted.

use hwmodel::cycles::Independence;
use hwmodel::{OpClass, Stage};
use serde::Serialize;

use super::frame::Counted;
use super::growth::GrowthRow;
use crate::bench::PowerLaw;
use shiftvox::machine::Simulated;
use shiftvox::project::{Coverage, FrameSetup};

/// A claim and the counts that support or refute it.
#[derive(Debug, Clone, Serialize)]
pub struct Claim {
    /// The image-order paper's statement.
    pub claim: &'static str,
    /// Whether it holds for what was measured; `None`: figures alone, for the reader to judge.
    pub holds: Option<bool>,
    /// The figures.
    pub evidence: String,
}

/// Classes of operation that a hardware without multiplier has. All there
/// are: the datapath has no others, so this fails when one is added.
const LIGHT: [OpClass; 8] = [
    OpClass::Add,
    OpClass::Sub,
    OpClass::Compare,
    OpClass::MinMax,
    OpClass::Select,
    OpClass::Shift,
    OpClass::Logic,
    OpClass::DivideStep,
];

/// The claims that one frame can support or refute.
#[must_use]
pub fn of_frame(counted: &Counted) -> Vec<Claim> {
    let by_class = counted.counter.sum_by(|cell| cell.class);
    let listed: Vec<String> = by_class
        .iter()
        .map(|(class, times)| format!("{} {times}", class.name()))
        .collect();
    let light = by_class.keys().all(|class| LIGHT.contains(class));
    let ordering = counted.counter.sum(|cell| cell.stage == Stage::Order);
    let subdivided = counted.stat("subdivided");
    let [compares, logic] =
        [OpClass::Compare, OpClass::Logic].map(|class| counted.counter.ops_at(Stage::Order, class));
    // One exclusive or for each child. A parent that comes back from the stack is ordered again.
    let orderings = logic / 8;
    let is_constant =
        compares == 3 * orderings && ordering == 11 * orderings && orderings >= subdivided;
    vec![
        Claim {
            claim: "only adds, shifts, logic and compares",
            holds: Some(light),
            evidence: format!(
                "operations executed: {}. The divide steps (a trial subtraction and a select each) are our \
                 change to screen space; the paper's own settings have them for the root's vertices alone",
                listed.join(", ")
            ),
        },
        Claim {
            claim: "children are ordered in constant time",
            holds: Some(is_constant && orderings > 0),
            evidence: format!(
                "{} operations ({} compares, 8 exclusive ors of 3 bits) in stage octant and order for each of \
                 {orderings} orderings of {subdivided} subdivided records: {ordering} in all",
                ordering.checked_div(orderings).unwrap_or(0),
                compares.checked_div(orderings).unwrap_or(0),
            ),
        },
    ]
}

/// The claim that cost follows the picture: how operations grow with pixels,
/// and with voxels, in each family of objects.
#[must_use]
pub fn of_growth(pictures: &[GrowthRow], objects: &[GrowthRow]) -> Vec<Claim> {
    let mut claims = Vec::new();
    if let Some(power) = power(pictures, |row| row.pixels) {
        claims.push(Claim {
            claim: "cost follows the picture's pixels",
            holds: None,
            evidence: format!("operations grow as pixels to the power {power}"),
        });
    }
    let mut families = Vec::new();
    for rows in objects.chunk_by(|a, b| family(a) == family(b)) {
        let Some(all) = power(rows, |row| row.voxels) else {
            continue;
        };
        // Before that, voxels are larger than pixels and every one costs.
        let fine = rows.iter().filter(|row| row.voxels >= row.pixels);
        let fine: Vec<GrowthRow> = fine.cloned().collect();
        let fine = power(&fine, |row| row.voxels).map_or_else(String::new, |power| {
            format!("; of those with no fewer voxels than the picture has pixels: {power}")
        });
        families.push(format!("{}: {all}{fine}", family(&rows[0])));
    }
    if !families.is_empty() {
        claims.push(Claim {
            claim: "cost does not follow the object's voxels",
            holds: None,
            evidence: format!(
                "operations grow as voxels to the power. {}",
                families.join(". ")
            ),
        });
    }
    claims
}

/// What objects of growing depth have in common: their name up to its settings.
fn family(row: &GrowthRow) -> &str {
    row.object.split(',').next().unwrap_or_default()
}

/// The exponent of operations over `x`, how far it is from the rows, and that
/// of each step from one row to the next: a single figure would hide a bend.
fn power(rows: &[GrowthRow], x: fn(&GrowthRow) -> u64) -> Option<String> {
    let point = |row: &GrowthRow| (x(row) as f64, row.operations as f64);
    let points: Vec<(f64, f64)> = rows.iter().map(point).collect();
    let law = PowerLaw::fit(&points)?;
    let exponent = law.exponent;
    if points.len() == 2 {
        return Some(format!("{exponent:.2} (two points)"));
    }
    let steps: Vec<String> = points
        .windows(2)
        .filter_map(PowerLaw::fit)
        .map(|step| format!("{:.2}", step.exponent))
        .collect();
    Some(format!(
        "{exponent:.2} (fitted to {} points, at most {:.2} times off; step by step {})",
        points.len(),
        law.worst_ratio,
        steps.join(", ")
    ))
}

/// The claim that children of one class of the order are independent.
/// `differing`: samples that the hardware's picture shows otherwise than the serial machine's.
#[must_use]
pub fn of_hardware(simulated: &Simulated, differing: u64, setup: &FrameSetup) -> Vec<Claim> {
    let report = &simulated.cycles;
    let bound = setup.options.coverage == Coverage::Exact;
    let by_classes = matches!(
        report.independence,
        Independence::Classes | Independence::Both
    );
    vec![Claim {
        claim: "children of one class of the order are independent",
        // Elsewhere two children may claim a sample, and the first draws it. What keeps the serial order shows nothing.
        holds: (bound && by_classes).then_some(differing == 0),
        evidence: format!(
            "drawn on {} contexts with independence `{:?}`: the picture is {}; work over span {:.1}. What \
             must hold (exact coverage) {} this frame's settings",
            u64::from(report.lanes) * u64::from(report.contexts),
            report.independence,
            match differing {
                0 => "the same as the serial machine's".to_owned(),
                some => format!("not the same, at {some} samples"),
            },
            report.parallelism,
            if bound { "is" } else { "is not" },
        ),
    }]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(object: &str, voxels: u64, pixels: u64, operations: u64) -> GrowthRow {
        GrowthRow {
            object: object.to_owned(),
            voxels,
            pixels,
            drawn: 1,
            records: 1,
            operations,
            node_reads: 1,
            order_operations: 11.0,
        }
    }

    /// First and last lie on a line of slope 1; between them cost jumps and stays.
    #[test]
    fn a_bend_is_told() {
        let pictures = [(1, 1), (4, 16), (16, 16)].map(|(x, y)| row("a", 9, x, y));
        let claims = of_growth(&pictures, &[]);
        assert_eq!(claims.len(), 1);
        assert_eq!(
            claims[0].evidence,
            "operations grow as pixels to the power 1.00 (fitted to 3 points, at most 2.52 times off; \
             step by step 2.00, 0.00)"
        );
    }

    #[test]
    fn families_of_objects_are_kept_apart() {
        let objects = [
            row("gen:a,depth=1", 10, 100, 10),
            row("gen:a,depth=2", 100, 100, 100),
            row("gen:a,depth=3", 1000, 100, 100),
            row("gen:b,depth=1", 10, 100, 7),
            row("gen:b,depth=2", 1000, 100, 700),
            row("gen:c,depth=2", 1000, 100, 700),
        ];
        let claims = of_growth(&[], &objects);
        assert_eq!(claims.len(), 1);
        assert_eq!(
            claims[0].evidence,
            "operations grow as voxels to the power. \
             gen:a: 0.50 (fitted to 3 points, at most 2.15 times off; step by step 1.00, 0.00); \
             of those with no fewer voxels than the picture has pixels: 0.00 (two points). \
             gen:b: 1.00 (two points)"
        );
    }
}
