//! Everything that the model finds of one frame on one hardware: what `shiftvox model --json` prints.

use std::collections::BTreeMap;

use hwmodel::count::{Counter, OpCount};
use hwmodel::cycles::Hardware;
use hwmodel::memory::{MissPoint, RecordKind};
use hwmodel::shifts::ShiftSite;
use hwmodel::{Memory, OpClass, Stage};
use serde::Serialize;

use super::ModelError;
use super::area::DesignArea;
use super::clock::ClockCheck;
use super::compare::{self, ComparedLine, Design};
use super::cost::{self, FrameCost, Prices};
use super::design::LightDesign;
use super::fill_bits;
use super::floor::{self, Floor};
use super::frame::{self, Counted};
use super::ray_caster::RayCasterReport;
use super::record::{self, NumberWidths, RecordField};
use crate::measure::CoverageError;
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::Simulated;
use shiftvox::project::FrameSetup;

/// The report.
#[derive(Debug, Serialize)]
pub struct Report {
    /// The hardware.
    pub hardware: Hardware,
    /// The word format.
    pub word: WordFormat,
    /// Bits of a record on the stack.
    pub record_bits: u32,
    /// The fields of a record.
    pub record: Vec<RecordField>,
    /// Records on the stack by kind.
    pub records_by_kind: Vec<KindTraffic>,
    /// Bits of a record's numbers: seen, proven and used.
    pub numbers: Vec<NumberWidths>,
    /// The machine's counters.
    pub counters: BTreeMap<&'static str, u64>,
    /// Records by octree level.
    pub levels: Vec<LevelRecords>,
    /// Operations by class, width, stage and level.
    pub operations: Vec<OpCount>,
    /// Operations by stage and class.
    pub operations_by_stage: Vec<StageOperations>,
    /// Source lines that shift, and by how many places.
    pub shifts: Vec<ShiftSite>,
    /// Traffic by memory.
    pub memories: Vec<MemoryTraffic>,
    /// Misses of caches of every size.
    pub miss_curves: Vec<MissCurve>,
    /// Bits of all stacks.
    pub stack_bits: u64,
    /// Bits of the fill vectors on the chip.
    pub fill_vector_bits: u64,
    /// Bits of the accumulators.
    pub accumulator_bits: u64,
    /// Cycles.
    pub simulated: Simulated,
    /// Whether the hardware's picture is the serial machine's.
    pub same_picture: bool,
    /// Samples that differ from the serial machine's.
    pub differing_samples: u64,
    /// Coverage against exact rays.
    pub coverage_error: CoverageError,
    /// Energy.
    pub cost: FrameCost,
    /// Area.
    pub area: DesignArea,
    /// The units against the clock.
    pub clock: ClockCheck,
    /// The same in words.
    pub clock_says: String,
    /// Both designs line by line.
    pub comparison: Vec<ComparedLine>,
    /// The ray caster.
    pub ray_caster: RayCasterReport,
    /// Lower bound on the energy of every design.
    pub floor: Floor,
}

/// Bits of a word.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct WordFormat {
    /// Its width.
    pub bits: u32,
    /// Fraction bits of screen positions.
    pub screen_fraction_bits: u32,
    /// Fraction bits of clip vectors.
    pub clip_fraction_bits: u32,
}

/// Stack traffic of records of one kind.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct KindTraffic {
    /// The kind.
    pub kind: RecordKind,
    /// Bits of a record.
    pub bits: u32,
    /// Records popped.
    pub popped: u64,
    /// Records pushed.
    pub pushed: u64,
}

/// Records of an octree level.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct LevelRecords {
    /// The level.
    pub level: u32,
    /// The records that had their turn.
    pub records: u64,
    /// Their operations.
    pub operations: u64,
}

/// Operations of a stage.
#[derive(Debug, Clone, Serialize)]
pub struct StageOperations {
    /// The stage.
    pub stage: Stage,
    /// Operations by class.
    pub operations: BTreeMap<OpClass, u64>,
}

/// Traffic of a memory.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct MemoryTraffic {
    /// The memory.
    pub memory: &'static str,
    /// Reads.
    pub reads: u64,
    /// Writes.
    pub writes: u64,
    /// Bits read.
    pub read_bits: u64,
    /// Bits written.
    pub written_bits: u64,
    /// Distinct addresses.
    pub distinct: u64,
}

/// Misses of fully associative caches of every size.
#[derive(Debug, Clone, Serialize)]
pub struct MissCurve {
    /// The memory.
    pub memory: &'static str,
    /// Bytes of a line.
    pub line_bytes: u32,
    /// Misses by size.
    pub points: Vec<MissPoint>,
}

/// A frame drawn by the serial machine, by the hardware, and by rays.
#[derive(Debug)]
pub struct Drawn<'a> {
    /// The scene.
    pub graph: &'a Graph,
    /// The view.
    pub setup: &'a FrameSetup,
    /// The serial machine's frame.
    pub counted: &'a Counted,
    /// The hardware's cycles.
    pub simulated: Simulated,
    /// The hardware's picture.
    pub picture: &'a Frame,
    /// The exact picture.
    pub exact: &'a Frame,
    /// The ray caster.
    pub ray_caster: RayCasterReport,
}

impl Report {
    /// Prices a frame and collects its counts.
    ///
    /// # Errors
    /// When the cost tables lack a figure.
    pub fn new(drawn: Drawn<'_>, hardware: Hardware, prices: &Prices) -> Result<Self, ModelError> {
        let Drawn {
            graph,
            setup,
            counted,
            simulated,
            picture,
            exact,
            ray_caster,
        } = drawn;
        let cycles = &simulated.cycles;
        let LightDesign { cost, area, clock } =
            LightDesign::price(graph, setup, counted, cycles, &hardware, prices)?;
        let light = Design {
            cost: &cost,
            area: &area,
            cycles: cycles.cycles,
            frames_per_second: cycles.frames_per_second,
        };
        let rival = Design {
            cost: &ray_caster.cost,
            area: &ray_caster.area,
            cycles: ray_caster.cycles.cycles,
            frames_per_second: ray_caster.cycles.frames_per_second,
        };
        let comparison = compare::lines(light, rival);
        let floor = floor::floor(graph, exact, &hardware, &prices.table)?;
        let differing_samples = counted.differing(picture);
        let counter = &counted.counter;
        Ok(Self {
            word: WordFormat {
                bits: setup.format.bits(),
                screen_fraction_bits: setup.format.frac(),
                clip_fraction_bits: setup.clip_frac,
            },
            record_bits: counted.record_bits(),
            record: counted.fields.clone(),
            records_by_kind: records_by_kind(counted),
            numbers: record::number_widths(graph, setup, hardware.organisation)?,
            counters: counted.stats.iter().copied().collect(),
            levels: levels(counter),
            operations: counter.cells().collect(),
            operations_by_stage: operations_by_stage(counter),
            shifts: counted.shifts.sites(),
            memories: Memory::ALL.map(|memory| traffic(counted, memory)).into(),
            miss_curves: miss_curves(counted),
            stack_bits: cost::stack_bits(&hardware, counted.record_bits()),
            fill_vector_bits: fill_bits::fill_store_bits(setup, &hardware),
            accumulator_bits: cost::accumulator_bits(setup),
            same_picture: differing_samples == 0,
            differing_samples,
            coverage_error: frame::error(&counted.frame, exact),
            clock_says: clock.sentence(),
            hardware,
            simulated,
            cost,
            area,
            clock,
            comparison,
            ray_caster,
            floor,
        })
    }
}

fn records_by_kind(counted: &Counted) -> Vec<KindTraffic> {
    let records = &counted.records;
    let kinds = RecordKind::ALL.into_iter();
    kinds
        .map(|kind| KindTraffic {
            kind,
            bits: records.bits().of(kind),
            popped: records.of(kind).reads,
            pushed: records.of(kind).writes,
        })
        .collect()
}

fn levels(counter: &Counter) -> Vec<LevelRecords> {
    let operations = counter.sum_by(|cell| cell.level);
    counter
        .records_by_level()
        .map(|(level, records)| LevelRecords {
            level,
            records,
            operations: operations.get(&level).copied().unwrap_or(0),
        })
        .collect()
}

fn operations_by_stage(counter: &Counter) -> Vec<StageOperations> {
    let mut stages = BTreeMap::<Stage, BTreeMap<OpClass, u64>>::new();
    for ((stage, class), times) in counter.sum_by(|cell| (cell.stage, cell.class)) {
        stages.entry(stage).or_default().insert(class, times);
    }
    let row = |(stage, operations)| StageOperations { stage, operations };
    stages.into_iter().map(row).collect()
}

fn traffic(counted: &Counted, memory: Memory) -> MemoryTraffic {
    let probe = &counted.memory;
    let (read_bits, written_bits) = match memory {
        // Records differ in their bits.
        Memory::Stack => (counted.records.read_bits(), counted.records.written_bits()),
        _ => (probe.read_bits(memory), probe.written_bits(memory)),
    };
    MemoryTraffic {
        memory: memory.name(),
        reads: probe.reads(memory),
        writes: probe.writes(memory),
        read_bits,
        written_bits,
        distinct: probe.distinct(memory),
    }
}

fn miss_curves(counted: &Counted) -> Vec<MissCurve> {
    let curves = counted.memory.curves().iter();
    curves
        .map(|(memory, curve)| MissCurve {
            memory: memory.name(),
            line_bytes: curve.line_bytes(),
            points: curve.points(),
        })
        .collect()
}
