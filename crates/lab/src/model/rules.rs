//! Both cages, the drawing rules and tolerances side by side: what exact
//! perspective costs over the image-order paper's midpoints.

use hwmodel::cycles::{Hardware, NoObserver};
use hwmodel::{OpClass, Overflow};
use rayon::prelude::*;
use serde::Serialize;

use super::ModelError;
use super::area::{self, LightFrame};
use super::cost::{self, Prices};
use super::frame;
use super::record::{record_bits, record_fields};
use crate::measure::CoverageError;
use shiftvox::graph::{Graph, Progress};
use shiftvox::machine::SimulateError;
use shiftvox::project::{CageKind, Camera, Coverage, EngineError, FrameSetup, SetupOptions};

/// Tolerances of the table, pixels, of a rule: `exact` has none but 0.
#[must_use]
pub fn tolerances(coverage: Coverage) -> &'static [f64] {
    const OF_SAMPLES: [f64; 3] = [0.0, 1.0 / 8.0, f64::INFINITY];
    if coverage.draws_outlines() {
        &OF_SAMPLES[..1]
    } else {
        &OF_SAMPLES
    }
}

/// A way to draw, and what it costs.
#[derive(Debug, Clone, Serialize)]
pub struct RuleRow {
    /// How records hold their vertices.
    pub cage: CageKind,
    /// Which samples a voxel draws.
    pub coverage: Coverage,
    /// Largest deviation in pixels; infinity as the word `inf`.
    #[serde(serialize_with = "crate::model::infinity_as_word")]
    pub tolerance_px: f64,
    /// Bits of a record on the stack.
    pub record_bits: u32,
    /// What became of the frame.
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// What became of a frame.
#[derive(Debug, Clone, Serialize)]
#[serde(tag = "outcome", rename_all = "snake_case")]
pub enum Outcome {
    /// It was drawn.
    Drawn(Box<Costs>),
    /// A word overflowed.
    Trapped {
        /// Where.
        trap: String,
    },
    /// There is no such frame.
    Refused {
        /// Why.
        reason: String,
    },
}

/// What a frame cost, and how far it is from the exact one.
#[derive(Debug, Clone, Serialize)]
pub struct Costs {
    /// Records that had their turn.
    pub records: u64,
    /// Operations, but for shifts.
    pub operations: u64,
    /// Shifts, most of them wires.
    pub shifts: u64,
    /// Steps of the restoring divide, among the operations.
    pub divide_steps: u64,
    /// Widest operation, bits.
    pub widest: u32,
    /// Cycles on the hardware.
    pub cycles: u64,
    /// Records of the deepest stack.
    pub deepest_stack: u64,
    /// Energy of the operations, pJ.
    pub energy_pj: f64,
    /// Area, NAND2 equivalents: middle of its range.
    pub area_nand2: f64,
    /// Of that, the units that compute.
    pub logic_nand2: f64,
    /// Coverage against exact rays of the camera at 64 bits.
    pub error: CoverageError,
}

/// Draws one frame and adds up what it costs. `exact`: the true picture.
///
/// # Errors
/// When the cost tables lack a figure, or the hardware cannot go on.
pub fn measure(
    graph: &Graph,
    setup: Result<FrameSetup, shiftvox::project::SetupError>,
    hardware: &Hardware,
    prices: &Prices,
    exact: &shiftvox::frame::Frame,
) -> Result<(u32, Outcome), ModelError> {
    let setup = match setup {
        Ok(setup) => setup,
        Err(error) => {
            let reason = error.to_string();
            return Ok((0, Outcome::Refused { reason }));
        }
    };
    let bits = record_bits(&record_fields(&setup, graph.len(), hardware.organisation));
    let (view, overflow) = (graph.view(), Overflow::Trap);
    let trapped = |trap: String| Ok((bits, Outcome::Trapped { trap }));
    let drawn = frame::count_priced(&view, &setup, hardware.organisation, overflow);
    let (frame, counter, shifts, stats) = match drawn {
        Ok(drawn) => drawn,
        Err(EngineError::Trap(trap)) => return trapped(trap.to_string()),
        Err(error) => return Err(error.into()),
    };
    let simulated = frame::simulate(&view, &setup, hardware, overflow, &mut NoObserver);
    let simulated = match simulated {
        Ok((_, simulated)) => simulated,
        Err(ModelError::Simulate(SimulateError::Workload(EngineError::Trap(trap)))) => {
            return trapped(trap.to_string());
        }
        Err(error) => return Err(error),
    };
    let all_shifts = counter.ops_of(OpClass::Shift);
    let deepest = stats.iter().find(|(name, _)| *name == "deepest_stack");
    let energy = cost::operations_energy(&counter, &shifts, prices)?;
    let used = LightFrame {
        counter: &counter,
        shifts: &shifts,
        cycles: &simulated.cycles,
        setup: &setup,
        record_bits: bits,
    };
    let area = area::light(used, hardware, prices)?;
    let costs = Costs {
        records: counter.records(),
        operations: counter.ops() - all_shifts,
        shifts: all_shifts,
        divide_steps: counter.ops_of(OpClass::DivideStep),
        widest: counter.widest(),
        cycles: simulated.cycles.cycles,
        deepest_stack: deepest.map_or(0, |&(_, depth)| depth),
        energy_pj: energy.total,
        area_nand2: area.total,
        logic_nand2: area.units.total,
        error: frame::error(&frame, exact),
    };
    Ok((bits, Outcome::Drawn(Box::new(costs))))
}

/// The table for a view. `base` has everything that the table does not vary.
///
/// # Errors
/// When the camera sees nothing, or the cost tables lack a figure.
pub fn table(
    graph: &Graph,
    camera: &Camera,
    base: &SetupOptions,
    hardware: &Hardware,
    prices: &Prices,
    progress: &dyn Progress,
) -> Result<Vec<RuleRow>, ModelError> {
    let exact = frame::reference(&graph.view(), &true_setup(graph, camera, base)?)?;
    let cages = [CageKind::Corners, CageKind::Frame];
    let mut ways = Vec::new();
    for cage in cages {
        for coverage in Coverage::UNBLENDED.into_iter().rev() {
            ways.extend(tolerances(coverage).iter().map(|&px| (cage, coverage, px)));
        }
    }
    progress.begin("cages, rules and tolerances", ways.len() as u64);
    let row = |(cage, coverage, tolerance_px)| {
        let options = SetupOptions {
            cage,
            coverage,
            tolerance_px,
            ..*base
        };
        let setup = FrameSetup::new(camera, &graph.placement, graph.depth, &options);
        let (record_bits, outcome) = measure(graph, setup, hardware, prices, &exact)?;
        progress.advance(1);
        Ok(RuleRow {
            cage,
            coverage,
            tolerance_px,
            record_bits,
            outcome,
        })
    };
    let rows = ways.into_par_iter().map(row).collect();
    progress.end();
    rows
}

/// The view that errors are measured against: 64 bits, the exact rule.
///
/// # Errors
/// When the camera sees nothing.
pub fn true_setup(
    graph: &Graph,
    camera: &Camera,
    base: &SetupOptions,
) -> Result<FrameSetup, ModelError> {
    let options = SetupOptions {
        aa_log2: base.aa_log2,
        ..SetupOptions::default()
    };
    let setup = FrameSetup::new(camera, &graph.placement, graph.depth, &options)?;
    Ok(setup)
}
