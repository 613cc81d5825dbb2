//! A frame of the [rival], priced by the same tables.

use hwmodel::Memory;
use hwmodel::cost::{Breakdown, CostError, CostTable};
use hwmodel::count::{AccessCount, OpCount};
use hwmodel::cycles::{CycleReport, Hardware};
use serde::Serialize;

use super::ModelError;
use super::area::{self, DesignArea};
use super::cost::{FrameCost, Prices};
use crate::measure::CoverageError;
use crate::rival::{self, Cast, Rival};
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::project::FrameSetup;

/// The design's name in files of other programs.
pub const RAY_CASTER: &str = "ray_caster";

/// A ray caster's frame and its cost.
#[derive(Debug, Clone, Serialize)]
pub struct RayCasterReport {
    pub rival: Rival,
    /// Rays and their steps.
    pub records: u64,
    pub operations: u64,
    /// By stage, level, class and width.
    pub operation_counts: Vec<OpCount>,
    pub accesses: Vec<AccessCount>,
    pub cost: FrameCost,
    pub cycles: CycleReport,
    pub area: DesignArea,
    pub error: CoverageError,
}

/// Casts and prices a frame's rays beside a design. `exact`: the true picture.
pub fn measure(
    graph: &Graph,
    setup: &FrameSetup,
    (rival, design): (&Rival, &Hardware),
    prices: &Prices,
    exact: &Frame,
) -> Result<RayCasterReport, ModelError> {
    let hardware = rival.beside(design);
    let cast = rival::cast(graph, setup, rival, &hardware)?;
    Ok(price(&cast, (rival, &hardware), prices, exact)?)
}

/// Prices a frame of rays.
pub fn price(
    cast: &Cast,
    (rival, hardware): (&Rival, &Hardware),
    prices: &Prices,
    exact: &Frame,
) -> Result<RayCasterReport, CostError> {
    let (counter, cycles) = (&cast.counter, &cast.cycles);
    let on_chip = on_chip(cast, rival, hardware, &prices.table)?;
    let cost = FrameCost::of_work(counter, &cast.shifts, on_chip, cycles, prices)?;
    let area = area::of_rays(cast, rival, hardware, prices)?;
    let pace = (cycles.cycles, hardware.clock_mhz);
    Ok(RayCasterReport {
        rival: rival.clone(),
        records: cycles.records,
        operations: counter.ops(),
        operation_counts: counter.cells().collect(),
        accesses: counter.accesses().collect(),
        cost: cost.whole(RAY_CASTER, &area, pace, prices)?,
        cycles: cycles.clone(),
        area,
        error: CoverageError::between(&cast.frame.voxel, &exact.voxel),
    })
}

fn on_chip(
    cast: &Cast,
    rival: &Rival,
    hardware: &Hardware,
    table: &CostTable,
) -> Result<Breakdown, CostError> {
    let mut sum = Breakdown::default();
    let mut push = |name: &str, operation: &str, bytes: u64, bits: u32, times: u64| {
        let each = table.memory_energy(operation, bytes, bits)?;
        sum.push(name, operation, bits, times, each);
        sum.of_bytes(Some(bytes));
        Ok(())
    };
    let counter = &cast.counter;
    let first = counter.records_by_level().next();
    let rays = first.map_or(0, |(_, rays)| rays);
    let sums = 6 * cast.format.wide().bits();
    let bytes = (cast.steps * u64::from(sums)).div_ceil(8).max(1);
    push("steps of the sums", "sram_read", bytes, sums, rays / 2)?;
    let (nodes, attributes) = (&hardware.node_cache, &hardware.attribute_cache);
    let reads = counter.reads(Memory::Node);
    let (bits, times) = match (&hardware.node_buffer, cast.cycles.node_buffer) {
        (Some(buffer), Some(report)) => {
            let bytes = u64::from(buffer.bytes);
            let line = 8 * buffer.line_bytes;
            let entry = 8 * buffer.entry_bytes;
            push("node buffer", "sram_read", bytes, entry, reads)?;
            push("node buffer", "sram_write", bytes, line, report.misses)?;
            (line, report.misses)
        }
        _ => (8 * nodes.entry_bytes, reads),
    };
    let bytes = u64::from(nodes.bytes);
    push(Memory::Node.name(), "sram_read", bytes, bits, times)?;
    let reads = counter.reads(Memory::Attribute);
    let (bytes, bits) = (u64::from(attributes.bytes), 8 * attributes.entry_bytes);
    push(Memory::Attribute.name(), "sram_read", bytes, bits, reads)?;
    let (reads, writes) = (counter.reads(Memory::Stack), counter.writes(Memory::Stack));
    let (bytes, bits) = (rival.stack_bytes(), rival.stack.entry_bits);
    push(Memory::Stack.name(), "sram_read", bytes, bits, reads)?;
    push(Memory::Stack.name(), "sram_write", bytes, bits, writes)?;
    Ok(sum)
}
