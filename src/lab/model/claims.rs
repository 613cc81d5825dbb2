//! The paper's claims, one by one, against what was counted.

use hwmodel::{OpClass, Stage};
use serde::Serialize;

use super::frame::Counted;
use super::growth::GrowthRow;
use crate::machine::Simulated;
use crate::project::{Coverage, FrameSetup};

/// A claim and what the counts say.
#[derive(Debug, Clone, Serialize)]
pub struct Claim {
    /// What the paper says.
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

/// The claims that one frame can tell of.
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
    let each = ordering.checked_div(subdivided).unwrap_or(0);
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
            holds: Some(ordering == each * subdivided && each > 0),
            evidence: format!(
                "{each} operations (3 compares, 8 exclusive ors of 3 bits) in stage octant and order for each of \
                 {subdivided} subdivided records: {ordering} in all"
            ),
        },
    ]
}

/// The claim that cost follows the picture: exponents of operations over
/// pixels, and over voxels.
#[must_use]
pub fn of_growth(pictures: &[GrowthRow], objects: &[GrowthRow]) -> Vec<Claim> {
    let exponent = |rows: &[GrowthRow], x: fn(&GrowthRow) -> u64| -> Option<f64> {
        let (first, last) = (rows.first()?, rows.last()?);
        let ratio = |a: u64, b: u64| libm::log(b as f64 / a as f64);
        let across = ratio(x(first), x(last));
        (across > 0.0).then(|| ratio(first.operations, last.operations) / across)
    };
    let mut claims = Vec::new();
    if let Some(e) = exponent(pictures, |row| row.pixels) {
        claims.push(Claim {
            claim: "cost follows the picture's pixels",
            holds: None,
            evidence: format!(
                "operations grow as pixels to the power {e:.2}, smallest to largest picture"
            ),
        });
    }
    // Before that, voxels are larger than pixels and every one costs.
    let fine = objects.iter().filter(|row| row.voxels >= row.pixels);
    let fine: Vec<GrowthRow> = fine.cloned().collect();
    if let Some(e) = exponent(&fine, |row| row.voxels) {
        claims.push(Claim {
            claim: "cost does not follow the object's voxels",
            holds: None,
            evidence: format!(
                "operations grow as voxels to the power {e:.2}, over objects with more voxels than the picture has pixels"
            ),
        });
    }
    claims
}

/// The claim that children of one class of the order are independent.
#[must_use]
pub fn of_hardware(simulated: &Simulated, same_picture: bool, setup: &FrameSetup) -> Vec<Claim> {
    let report = &simulated.cycles;
    let bound = setup.options.coverage == Coverage::Exact && setup.options.tolerance_px == 0.0;
    vec![Claim {
        claim: "children of one class of the order are independent",
        // Elsewhere two children may claim a sample, and the first draws it.
        holds: bound.then_some(same_picture),
        evidence: format!(
            "drawn on {} contexts with independence `{:?}`: the picture is {}; work over span {:.1}. What \
             must hold (exact coverage, tolerance 0) {} this frame's settings",
            u64::from(report.lanes) * u64::from(report.contexts),
            report.independence,
            if same_picture {
                "the same as the serial machine's"
            } else {
                "not the same"
            },
            report.parallelism,
            if bound { "is" } else { "is not" },
        ),
    }]
}
