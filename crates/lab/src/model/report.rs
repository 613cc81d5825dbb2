//! Everything that the model finds of one frame on one hardware: what `shiftvox model --json` prints.

use std::collections::BTreeMap;

use hwmodel::cost::Technology;
use hwmodel::count::{Accesses, Counter, OpCount};
use hwmodel::cycles::Hardware;
use hwmodel::memory::{RecordKind, Widths};
use hwmodel::{Memory, OpClass, Stage};
use serde::Serialize;
use serde_json::{Value, json};

use super::ModelError;
use super::cost::{self, Prices};
use super::design::LightDesign;
use super::fill_bits;
use super::frame::{self, Counted};
use super::ray_caster::RayCasterReport;
use super::record::{self, NumberWidths, RecordField};
use super::verdict::{self, ComparedLine};
use crate::measure::CoverageError;
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::Simulated;
use shiftvox::project::FrameSetup;

#[derive(Debug, Serialize)]
pub struct Report {
    pub hardware: Hardware,
    word: Value,
    /// Of an entry of the stack.
    pub record_bits: u32,
    record: Vec<RecordField>,
    records_by_kind: Vec<Value>,
    numbers: Vec<NumberWidths>,
    counters: BTreeMap<&'static str, u64>,
    levels: Vec<Value>,
    operations: Vec<OpCount>,
    operations_by_stage: Vec<Value>,
    memories: Vec<Value>,
    /// Of all stacks.
    pub stack_bits: u64,
    pub fill_vector_bits: u64,
    pub accumulator_bits: u64,
    pub simulated: Simulated,
    same_picture: bool,
    /// Samples that differ from the serial machine's.
    pub differing_samples: u64,
    pub coverage_error: CoverageError,
    #[serde(flatten)]
    pub light: LightDesign,
    pub clock_says: String,
    /// Of the energies.
    pub technology: Technology,
    pub technology_says: String,
    comparison: Vec<ComparedLine>,
    pub ray_caster: RayCasterReport,
}

#[derive(Debug)]
pub struct Drawn<'a> {
    pub graph: &'a Graph,
    pub setup: &'a FrameSetup,
    pub counted: &'a Counted,
    pub simulated: Simulated,
    /// The hardware's picture.
    pub picture: &'a Frame,
    pub exact: &'a Frame,
    pub ray_caster: RayCasterReport,
}

impl Report {
    pub fn new(drawn: Drawn<'_>, hardware: Hardware, prices: &Prices) -> Result<Self, ModelError> {
        let (graph, setup, counted) = (drawn.graph, drawn.setup, drawn.counted);
        let (rays, cycles) = (&drawn.ray_caster, &drawn.simulated.cycles);
        let light = LightDesign::price(graph, setup, counted, cycles, &hardware, prices)?;
        let rival = (&rays.cost, &rays.area, &rays.cycles);
        let comparison = verdict::lines((&light.cost, &light.area, cycles), rival, prices);
        let differing_samples = counted.differing(drawn.picture);
        let counter = &counted.counter;
        Ok(Self {
            word: json!({
                "bits": setup.format.bits(),
                "screen_fraction_bits": setup.format.frac(),
                "clip_fraction_bits": setup.clip_frac,
            }),
            record_bits: counted.record_bits(),
            record: counted.fields.clone(),
            records_by_kind: records_by_kind(counted),
            numbers: record::number_widths(graph, setup, hardware.organisation)?,
            counters: counted.stats.iter().copied().collect(),
            levels: levels(counter),
            operations: counter.cells().collect(),
            operations_by_stage: operations_by_stage(counter),
            memories: memories(counted, &frame::widths(setup, graph, &hardware)),
            stack_bits: cost::stack_bits(&hardware, counted.record_bits()),
            fill_vector_bits: fill_bits::fill_store_bits(setup, &hardware),
            accumulator_bits: cost::accumulator_bits(setup),
            same_picture: differing_samples == 0,
            differing_samples,
            coverage_error: CoverageError::between(&counted.frame.voxel, &drawn.exact.voxel),
            clock_says: light.clock.sentence(),
            hardware,
            simulated: drawn.simulated,
            light,
            technology: prices.table.technology(),
            technology_says: prices.table.technology().sentence(),
            comparison,
            ray_caster: drawn.ray_caster,
        })
    }
}

fn records_by_kind(counted: &Counted) -> Vec<Value> {
    let records = &counted.records;
    let row = |kind| {
        json!({
            "kind": kind,
            "bits": records.bits().of(kind),
            "popped": records.of(kind).reads,
            "pushed": records.of(kind).writes,
        })
    };
    RecordKind::ALL.into_iter().map(row).collect()
}

fn levels(counter: &Counter) -> Vec<Value> {
    let operations = counter.sum_by(|cell| cell.level);
    let row = |(level, records)| {
        let operations = operations.get(&level).copied().unwrap_or(0);
        json!({ "level": level, "records": records, "operations": operations })
    };
    counter.records_by_level().map(row).collect()
}

fn operations_by_stage(counter: &Counter) -> Vec<Value> {
    let mut stages = BTreeMap::<Stage, BTreeMap<OpClass, u64>>::new();
    for ((stage, class), times) in counter.sum_by(|cell| (cell.stage, cell.class)) {
        stages.entry(stage).or_default().insert(class, times);
    }
    let row = |(stage, operations)| json!({ "stage": stage, "operations": operations });
    stages.into_iter().map(row).collect()
}

/// Accesses of the memories that a frame uses.
fn memories(counted: &Counted, widths: &Widths) -> Vec<Value> {
    let accesses = counted.counter.accesses_by(|cell| cell.memory);
    let row = |(memory, of): (Memory, Accesses)| {
        let bits = u64::from(widths.of(memory));
        let (read_bits, written_bits) = match memory {
            // Records differ in their bits.
            Memory::Stack => (counted.records.read_bits(), counted.records.written_bits()),
            _ => (of.reads * bits, of.writes * bits),
        };
        json!({
            "memory": memory.name(),
            "reads": of.reads,
            "writes": of.writes,
            "read_bits": read_bits,
            "written_bits": written_bits,
        })
    };
    accesses.into_iter().map(row).collect()
}
