//! Area of a whole design without wires: units, registers, memories and control.
//!
//! Some hardware lists the units and registers that are [built](Built). Of other hardware:
//!
//! - *Units*: those of the hardware for every class of operation that the frame uses in a stage, but no more than any visit
//!   of the stage can use, and no wider than its widest operation. Shifts that are not wires have as many shifters as keep
//!   pace with the stage.
//! - *Registers*: a pipeline of latency `l` and interval `i` keeps `l / i` results, rounded up. A context keeps its record
//!   or ray.
//!
//! *Memories* are SRAM or registers, by their shape. *Control* is a share by the table: of registers if they are listed, else
//! of units and registers.

use std::collections::BTreeMap;

use hwmodel::cost::{Breakdown, CostError, MemoryShape, unit_of};
use hwmodel::count::Counter;
use hwmodel::cycles::{self, Built, Cache, CycleReport, Hardware, StageReport};
use hwmodel::memory::ACCUMULATOR_BITS;
use hwmodel::shifts::ShiftProbe;
use hwmodel::{OpClass, Stage};
use serde::Serialize;

use super::cost::{Prices, accumulator_bits, stack_bits};
use super::fill_bits::{fill_access_bits, fill_store_bits};
use super::frame::Counted;
use super::record::context_bits;
use crate::rival::{Cast, Rival};
use shiftvox::machine::RecordStage;
use shiftvox::project::{CageKind, FrameSetup};

/// Area of a design, NAND2 equivalents, line by line.
#[derive(Debug, Clone, Default, Serialize)]
pub struct DesignArea {
    pub units: Breakdown,
    pub registers: Breakdown,
    pub memories: Breakdown,
    pub control: Breakdown,
    pub total: f64,
}

impl DesignArea {
    pub fn parts(&self) -> [&Breakdown; 4] {
        [&self.units, &self.registers, &self.memories, &self.control]
    }

    fn finish(mut self, is_built: bool, prices: &Prices) -> Result<Self, CostError> {
        let (units, registers) = (self.units.total, self.registers.total);
        let (operation, of) = match is_built {
            true => ("state_control", registers),
            false => ("control", units + registers),
        };
        let share = prices.table.area(operation, 1, prices.goal)?;
        self.control
            .push("control", operation, 1, of.round() as u64, share);
        self.total = self.parts().map(|part| part.total).into_iter().sum();
        Ok(self)
    }

    /// Adds units with their pipelines: `depth` results on their way in each.
    fn units(
        &mut self,
        name: &str,
        (operation, width): (&str, u32),
        count: u64,
        depth: u64,
        prices: &Prices,
    ) -> Result<(), CostError> {
        let each = prices.table.area(operation, width, prices.goal)?;
        self.units.push(name, operation, width, count, each);
        if depth > 0 {
            let each = prices.table.area("register", width, prices.goal)?;
            let name = format!("{name}, pipeline of {operation}");
            self.registers
                .push(&name, "register", width, count * depth, each);
        }
        Ok(())
    }

    fn register_bits(&mut self, name: &str, bits: u64, prices: &Prices) -> Result<(), CostError> {
        let each = prices.table.area("register", REGISTER_BITS, prices.goal)?;
        let registers = bits.div_ceil(u64::from(REGISTER_BITS));
        self.registers
            .push(name, "register", REGISTER_BITS, registers, each);
        Ok(())
    }

    /// Adds a memory of so many bits, as equal parts.
    fn memory(
        &mut self,
        name: &str,
        bits: u64,
        (parts, width, ports): (u32, u32, u32),
        prices: &Prices,
    ) -> Result<(), CostError> {
        if bits > 0 {
            let words = bits.div_ceil(u64::from(parts) * u64::from(width));
            let shape = MemoryShape {
                words,
                width,
                ports,
            };
            let (operation, each) = prices.table.memory_area(shape, prices.goal)?;
            self.memories.push(name, operation, width, bits, each);
        }
        Ok(())
    }

    /// Ways are memories of their own, because they are read at the same time.
    fn cache(&mut self, name: &str, cache: &Cache, prices: &Prices) -> Result<(), CostError> {
        let (ways, ports) = (cache.ways, cache.ports);
        let data = (ways, 8 * cache.entry_bytes, ports);
        self.memory(name, 8 * u64::from(cache.bytes), data, prices)?;
        let bits = tag_bits(cache);
        let lines = u64::from(cache.sets()) * u64::from(ways);
        let tags = (ways, (bits / lines) as u32, ports);
        self.memory(&format!("{name}, tags"), bits, tags, prices)
    }
}

/// Registers of contexts are billed by bytes.
const REGISTER_BITS: u32 = 8;
const ADDRESS_BITS: u32 = 32;
/// Words of a ray in its context: the direction times the cell's side, and three comparisons of planes.
const RAY_WORDS: u64 = 6;
/// Its other bits: three places of the cell, its level, the mirrored axes, the entry, and the sample.
const RAY_BITS: u64 = 3 * 24 + 5 + 3 + 2 + 24;
const BRICK_BITS: u64 = 64 + 32;

/// Bits beside a cache's lines: the rest of the address, whether the line is
/// there, and its turn among its set's.
pub fn tag_bits(cache: &Cache) -> u64 {
    let lines = u64::from(cache.sets()) * u64::from(cache.ways);
    let found = cache.line_bytes.ilog2() + cache.sets().ilog2();
    let turn = u32::BITS - (cache.ways - 1).leading_zeros();
    lines * u64::from(ADDRESS_BITS.saturating_sub(found) + 1 + turn)
}

fn depth(unit: &cycles::Unit) -> u64 {
    u64::from(unit.latency.div_ceil(unit.interval.max(1)))
}

/// Area of the light hardware, as far as the frame uses it.
pub fn light(
    counted: &Counted,
    cycles: &CycleReport,
    setup: &FrameSetup,
    hardware: &Hardware,
    prices: &Prices,
) -> Result<DesignArea, CostError> {
    let record_bits = counted.record_bits();
    let mut area = match &hardware.built {
        Some(built) => self::built(built, setup, hardware, prices)?,
        None => {
            let (counter, shifts) = (&counted.counter, &counted.shifts);
            let mut area = units(counter, shifts, cycles, Some(setup), hardware, prices)?;
            let each = context_bits(setup, record_bits, hardware.organisation);
            let contexts = hardware.all_contexts() * each;
            area.register_bits("records of the contexts", contexts, prices)?;
            area
        }
    };
    // A state machine does not read and write in the same cycle.
    let ports = |ports: u32| if hardware.sequential { 1 } else { ports };
    let stack = (hardware.lanes, record_bits, ports(hardware.stack.ports));
    let fill = &hardware.fill_vectors;
    let of_tiles = if hardware.hands_out_tiles() {
        hardware.lanes
    } else {
        1
    };
    let fill = (
        fill.banks * of_tiles,
        fill_access_bits(setup, hardware.organisation),
        ports(fill.read_ports + fill.write_ports),
    );
    for (name, bits, shape) in [
        ("record stack", stack_bits(hardware, record_bits), stack),
        ("fill vectors", fill_store_bits(setup, hardware), fill),
        (
            "accumulators",
            accumulator_bits(setup),
            (1, ACCUMULATOR_BITS, 1),
        ),
    ] {
        area.memory(name, bits, shape, prices)?;
    }
    caches(area, hardware, prices)
}

/// The units and registers that are listed.
fn built(
    built: &Built,
    setup: &FrameSetup,
    hardware: &Hardware,
    prices: &Prices,
) -> Result<DesignArea, CostError> {
    let mut area = DesignArea::default();
    let (lanes, contexts) = (hardware.lanes, hardware.contexts);
    let (format, levels) = (setup.format, setup.levels);
    for (stage, units) in &built.units {
        let stage = stage.replace('_', " ");
        for (operation, sizes) in units {
            for (size, &count) in sizes {
                let kind = (operation.as_str(), size.bits(format, levels));
                let count = u64::from(lanes) * u64::from(count);
                area.units(&stage, kind, count, 0, prices)?;
            }
        }
    }
    let bits = built.register_bits(lanes, contexts, format, levels);
    area.register_bits("registers of the machine", bits, prices)?;
    Ok(area)
}

/// Whether an operand is always zero, so that a sign decides. Cages of edges have minima with zero, and exact coverage
/// tests only signs in the fit.
fn is_with_zero(setup: &FrameSetup, stage: Stage, class: OpClass) -> bool {
    let options = &setup.options;
    let is_exact = options.coverage.draws_outlines() && !options.coverage.blends();
    match class {
        _ if stage == RecordStage::OnePixel => false,
        OpClass::MinMax => is_exact && options.cage == CageKind::Frame,
        OpClass::Compare => is_exact && stage == RecordStage::QuadtreeFit,
        _ => false,
    }
}

/// The units of all stages, as far as a frame uses them. `setup`: of the light hardware.
fn units(
    counter: &Counter,
    shifts: &ShiftProbe,
    cycles: &CycleReport,
    setup: Option<&FrameSetup>,
    hardware: &Hardware,
    prices: &Prices,
) -> Result<DesignArea, CostError> {
    let mut area = DesignArea::default();
    let lanes = u64::from(hardware.lanes);
    let mut used = BTreeMap::<(Stage, OpClass), u32>::new();
    for cell in counter.cells() {
        let widest = used.entry((cell.stage, cell.class)).or_default();
        *widest = cell.bits.max(*widest);
    }
    let report_of = |stage: Stage| cycles.stages.iter().find(|of| of.stage == stage);
    for ((stage, class), widest) in used {
        let Some(unit) = hardware.unit(stage, class) else {
            continue;
        };
        let most = report_of(stage).map_or(u64::MAX, |of| of.most_passes[class as usize]);
        let (operation, count) = match (stage, class) {
            // Of eight constants: one inversion of the octant.
            (stage, OpClass::Logic) if stage == RecordStage::Order => ("invert", lanes),
            _ => (
                unit_of(class),
                lanes * u64::from(unit.count).min(most.max(1)),
            ),
        };
        let operation = match setup {
            Some(setup) if is_with_zero(setup, stage, class) => "and",
            _ => operation,
        };
        let kind = (operation, unit.width.min(widest));
        area.units(stage.name(), kind, count, depth(&unit), prices)?;
    }
    // Shifts that have shifters; of a sequential hardware by the stage in whose cycles they are done.
    let shifters = match hardware.sequential {
        true => shifts.variable_in_steps(),
        false => shifts.variable(),
    };
    for ((stage, width), times) in shifters {
        // A sequential hardware issues nothing at once: its operations take all of the stage's cycles.
        let cycles_of = |of: &StageReport| match hardware.sequential {
            true => of.alone,
            false => of.busy,
        };
        let busy = report_of(stage).map_or(1, cycles_of).max(1);
        let name = format!("{}, shifters", stage.name());
        let count = lanes * times.div_ceil(busy);
        area.units(&name, ("shift_var", width), count, 0, prices)?;
    }
    Ok(area)
}

pub fn of_rays(
    cast: &Cast,
    rival: &Rival,
    hardware: &Hardware,
    prices: &Prices,
) -> Result<DesignArea, CostError> {
    let (counter, shifts, cycles) = (&cast.counter, &cast.shifts, &cast.cycles);
    let mut area = units(counter, shifts, cycles, None, hardware, prices)?;
    let [word, wide] = [cast.format, cast.format.wide()].map(|of| u64::from(of.bits()));
    let lanes = u64::from(hardware.lanes);
    area.register_bits("sums of the rays", lanes * 6 * wide, prices)?;
    // A lane reads one sum at a time, and its contexts share a memory for their stacks. Both favour the ray caster.
    let sums = (hardware.lanes, cast.format.wide().bits(), 1);
    let bits = lanes * cast.steps * 6 * wide;
    area.memory("steps of the sums", bits, sums, prices)?;
    let node = 64 + BRICK_BITS * u64::from(hardware.organisation.bricks);
    let contexts = hardware.all_contexts() * (RAY_WORDS * word + RAY_BITS + node);
    area.register_bits("rays of the contexts", contexts, prices)?;
    let stacks = hardware.all_contexts() * 8 * rival.stack_bytes();
    let shape = (hardware.lanes, rival.stack.entry_bits, rival.stack.ports);
    area.memory("stacks of rays", stacks, shape, prices)?;
    if let Some(buffer) = &hardware.node_buffer {
        for _ in 0..hardware.lanes {
            area.cache("node buffer", buffer, prices)?;
        }
    }
    caches(area, hardware, prices)
}

fn caches(
    mut area: DesignArea,
    hardware: &Hardware,
    prices: &Prices,
) -> Result<DesignArea, CostError> {
    area.cache("node cache", &hardware.node_cache, prices)?;
    area.cache("attribute cache", &hardware.attribute_cache, prices)?;
    area.finish(hardware.built.is_some(), prices)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_by_hand() {
        let mut cache = Hardware::preset("paper").unwrap().node_cache;
        (cache.bytes, cache.ways, cache.line_bytes) = (16384, 4, 64);
        // 256 lines in 64 sets: 32 - 6 - 6 bits of address, one, and two for four ways.
        assert_eq!(tag_bits(&cache), 256 * (20 + 1 + 2));
        (cache.bytes, cache.ways) = (64, 1);
        assert_eq!(tag_bits(&cache), 26 + 1);
    }

    /// One unit and its pipeline, a context, a memory, control. In the table, an adder of 32 bits is 232.9, a register of 32
    /// bits 128, and one of 8 bits 32.
    #[test]
    fn parts_by_hand() {
        let prices = Prices::shipped().unwrap();
        let mut area = DesignArea::default();
        area.units("centre", ("add", 32), 3, 2, &prices).unwrap();
        area.register_bits("contexts", 20, &prices).unwrap();
        area.memory("stack", 4096, (1, 64, 1), &prices).unwrap();
        area.memory("nothing", 0, (1, 64, 1), &prices).unwrap();
        let area = area.finish(false, &prices).unwrap();
        assert_eq!(area.memories.lines.len(), 1);
        for (found, expected) in [
            (area.units.total, 3.0 * 232.9),
            (area.registers.total, 6.0 * 128.0 + 3.0 * 32.0),
            // 64 words of 64 bits: cells, rows, columns, and the corner.
            (
                area.memories.total,
                4096.0 * 0.4447 + 64.0 * 2.088 + 64.0 * 72.51 + 340.5,
            ),
            // 20 % of 698.7 + 864, rounded.
            (area.control.total, 312.6),
            (area.total, 698.7 + 864.0 + 6936.2632 + 312.6),
        ] {
            assert!((found - expected).abs() < 1e-6, "{found}, {expected}");
        }
    }
}
