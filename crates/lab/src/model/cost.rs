//! Energy of a frame, by the cost tables.

use std::collections::BTreeMap;
use std::sync::Arc;

use hwmodel::cost::{
    Breakdown, CostError, CostTable, Estimator, Goal, Store, energy_of_tallies, memory_energy_of,
    operation_of, tallies,
};
use hwmodel::count::{Accesses, Counter, OpCount};
use hwmodel::cycles::{CycleReport, Hardware};
use hwmodel::memory::{ACCUMULATOR_BITS, PIXEL_BITS, RecordKind, RecordProbe, Widths};
use hwmodel::shifts::ShiftProbe;
use hwmodel::{Memory, OpClass};
use serde::Serialize;

use super::fill_bits::fill_store_bits;
use super::frame::Counted;
use shiftvox::machine::RecordStage;
use shiftvox::project::FrameSetup;

/// The tables, and choices that do not follow from counts.
#[derive(Debug, Clone)]
pub struct Prices {
    pub table: CostTable,
    pub goal: Goal,
    /// Prices the actions of components instead of the tables.
    pub estimator: Option<Arc<dyn Estimator>>,
}

impl Prices {
    /// The tables that ship, for a small area.
    pub fn shipped() -> Result<Self, CostError> {
        Ok(Self {
            table: CostTable::load_shipped()?,
            goal: Goal::Area,
            estimator: None,
        })
    }
}

#[derive(Debug, Clone, Default, Serialize)]
pub struct FrameCost {
    pub operations: Breakdown,
    /// Accesses to memories on the chip.
    pub on_chip: Breakdown,
    pub leakage: Breakdown,
    pub clock: Breakdown,
    pub outer: Breakdown,
    pub traffic: OuterTraffic,
}

impl FrameCost {
    /// The cost of a design's work without leakage and clock. Pixels are written to outer memory. Misses of caches fetch
    /// lines from there. Spilled records are written there and read back.
    pub fn of_work(
        counter: &Counter,
        shifts: &ShiftProbe,
        on_chip: Breakdown,
        cycles: &CycleReport,
        prices: &Prices,
    ) -> Result<Self, CostError> {
        let traffic = OuterTraffic {
            node_bits: 8 * cycles.node_cache.bytes_in,
            attribute_bits: 8 * cycles.attribute_cache.bytes_in,
            spilled_bits: cycles.stack.spilled_bits,
            pixel_bits: counter.writes(Memory::Pixel) * u64::from(PIXEL_BITS),
        };
        Ok(Self {
            operations: operations_energy(counter, shifts, prices)?,
            on_chip,
            outer: outer_energy(&traffic, &prices.table)?,
            traffic,
            ..Self::default()
        })
    }

    pub fn parts(&self) -> [&Breakdown; 5] {
        let [operations, memories, leakage, clock] = self.chip();
        [operations, memories, leakage, clock, &self.outer]
    }

    /// The parts on the chip.
    pub fn chip(&self) -> [&Breakdown; 4] {
        [&self.operations, &self.on_chip, &self.leakage, &self.clock]
    }

    /// Energy on the chip, pJ.
    pub fn chip_total(&self) -> f64 {
        self.chip().map(|part| part.total).into_iter().sum()
    }

    /// Energy of the frame, pJ.
    pub fn total(&self) -> f64 {
        self.parts().map(|part| part.total).into_iter().sum()
    }
}

pub fn stack_bits(hardware: &Hardware, record_bits: u32) -> u64 {
    u64::from(hardware.stacks()) * u64::from(hardware.stack.entries) * u64::from(record_bits)
}

/// Bits of the accumulators of a frame: none where no voxel is blended.
pub fn accumulator_bits(setup: &FrameSetup) -> u64 {
    if !setup.options.coverage.blends() {
        return 0;
    }
    u64::from(setup.width) * u64::from(setup.height) * u64::from(ACCUMULATOR_BITS)
}

/// Traffic to outer memory, bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct OuterTraffic {
    pub node_bits: u64,
    pub attribute_bits: u64,
    /// Records without an entry on the stack: written, and read as many.
    pub spilled_bits: u64,
    pub pixel_bits: u64,
}

impl OuterTraffic {
    pub fn bits(&self) -> u64 {
        self.node_bits + self.attribute_bits + 2 * self.spilled_bits + self.pixel_bits
    }
}

/// Bits of a word of outer memory. Neighbours share words.
const OUTER_WORD_BITS: u32 = 64;

fn outer_energy(traffic: &OuterTraffic, table: &CostTable) -> Result<Breakdown, CostError> {
    let mut sum = Breakdown::default();
    for (name, operation, bits) in [
        ("lines of nodes", "dram_read", traffic.node_bits),
        ("lines of attributes", "dram_read", traffic.attribute_bits),
        ("spilled records", "dram_write", traffic.spilled_bits),
        ("spilled records", "dram_read", traffic.spilled_bits),
        ("pixels", "dram_write", traffic.pixel_bits),
    ] {
        let each = table.energy(operation, OUTER_WORD_BITS)?;
        let words = bits.div_ceil(u64::from(OUTER_WORD_BITS));
        sum.push(name, operation, OUTER_WORD_BITS, words, each);
    }
    Ok(sum)
}

/// Energy of a frame on the light hardware without leakage and clock.
pub fn frame_cost(
    counted: &Counted,
    cycles: &CycleReport,
    widths: &Widths,
    setup: &FrameSetup,
    hardware: &Hardware,
    prices: &Prices,
) -> Result<FrameCost, CostError> {
    let table = &prices.table;
    let bytes = |bits: u64| Store::Sram {
        bytes: bits.div_ceil(8).max(1),
    };
    let stack = u64::from(hardware.stack.entries) * u64::from(widths.stack_bits);
    let store = |memory| match memory {
        Memory::Stack => bytes(stack),
        Memory::Node => bytes(8 * u64::from(hardware.node_cache.bytes)),
        Memory::Attribute => bytes(8 * u64::from(hardware.attribute_cache.bytes)),
        Memory::FillVector => {
            bytes(fill_store_bits(setup, hardware) / u64::from(hardware.fill_vectors.banks))
        }
        Memory::Pixel => Store::Dram,
        // As many as samples, on the chip: neighbours come again and again.
        Memory::Accumulator => bytes(accumulator_bits(setup)),
    };
    let counter = &counted.counter;
    let mut accesses: BTreeMap<Memory, Accesses> = counter.accesses_by(|cell| cell.memory);
    // Billed by their bits, and as outer memory.
    accesses.retain(|memory, _| ![Memory::Stack, Memory::Pixel].contains(memory));
    let mut on_chip = stack_energy(&counted.records, stack.div_ceil(8).max(1), table)?;
    for of in memory_energy_of(&accesses, widths, store, table)?.lines {
        on_chip.push(&of.name, &of.operation, of.width, of.times, of.each);
        on_chip.of_bytes(of.bytes);
    }
    FrameCost::of_work(counter, &counted.shifts, on_chip, cycles, prices)
}

/// Energy of a stack of `bytes`, pJ. A record moves the bits that it holds:
/// the stack is taken to be written and read field by field, in parallel.
fn stack_energy(
    records: &RecordProbe,
    bytes: u64,
    table: &CostTable,
) -> Result<Breakdown, CostError> {
    let mut sum = Breakdown::default();
    for kind in RecordKind::ALL {
        let (bits, accesses) = (records.bits().of(kind), records.of(kind));
        let (reads, writes) = (accesses.reads, accesses.writes);
        for (operation, times) in [("sram_read", reads), ("sram_write", writes)] {
            if times > 0 {
                let each = table.memory_energy(operation, bytes, bits)?;
                let name = format!("stack, {}", kind.name());
                sum.push(&name, operation, bits, times, each);
                sum.of_bytes(Some(bytes));
            }
        }
    }
    Ok(sum)
}

/// Exclusive ors of the stage *order* with constants: one inversion of the octant, and wires.
const ORDERED_OCTANTS: u64 = 8;

/// The operation of the table for a cell of a counter, and how often.
fn priced(cell: &OpCount) -> (&'static str, u64) {
    if cell.stage == RecordStage::Order && cell.class == OpClass::Logic {
        return ("invert", cell.times.div_ceil(ORDERED_OCTANTS));
    }
    (operation_of(cell.class), cell.times)
}

/// Energy of the operations, pJ: those of the counter, and of its shifts those
/// that are no wires.
fn operations_energy(
    counter: &Counter,
    shifts: &ShiftProbe,
    prices: &Prices,
) -> Result<Breakdown, CostError> {
    let mut sum = energy_of_tallies(&tallies(counter, priced), &prices.table)?;
    let mut by_bits = BTreeMap::<u32, u64>::new();
    for ((_, bits), times) in shifts.variable() {
        *by_bits.entry(bits).or_default() += times;
    }
    for (bits, times) in by_bits {
        let each = prices.table.energy("shift_var", bits)?;
        sum.push("shifts that are no wires", "shift_var", bits, times, each);
    }
    Ok(sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use hwmodel::memory::RecordBits;
    use hwmodel::{Datapath, Format, Overflow, Probe, StageLevel};

    /// Rows: a shifter of 32 bits takes 0.1334 pJ, an adder 0.1.
    #[test]
    fn shifts_that_vary_are_billed_and_wires_are_not() {
        let mut probes = (Counter::new(), ShiftProbe::new());
        let format = Format::new(32, 8).unwrap();
        let mut dp = Datapath::new(format, Overflow::Trap, &mut probes);
        dp.stage(RecordStage::QuadtreeFit);
        let word = dp.load(3);
        for places in 1..=5 {
            dp.shl(word, 1); // wires
            dp.shr(word, places); // a shifter
        }
        dp.add(word, word);
        let prices = Prices::shipped().unwrap();
        let sum = operations_energy(&probes.0, &probes.1, &prices).unwrap();
        let expected = 0.1 + 5.0 * 0.1334;
        assert!((sum.total - expected).abs() < 1e-9, "{}", sum.total);
    }

    /// 64 bits from 8 KB are 10 pJ, and so is writing them.
    #[test]
    fn records_move_the_bits_that_they_hold() {
        let mut records = RecordProbe::new(RecordBits {
            clip: 640,
            screen: 320,
            finest: 64,
            finest_level: Some(1),
        });
        let place = StageLevel {
            stage: RecordStage::Push.into(),
            level: 0,
        };
        records.write(Memory::Stack, 0, place); // the object, in clip space
        records.record(0, 0);
        records.read(Memory::Stack, 0, place);
        for address in 0..3 {
            records.write(Memory::Stack, address, place); // finest voxels
        }
        records.record(1, 1);
        records.read(Memory::Stack, 2, place);
        let sum = stack_energy(&records, 8192, &CostTable::load_shipped().unwrap()).unwrap();
        // Of the object 100 pJ twice; of the voxels 10 pJ three times and once.
        assert!((sum.total - (200.0 + 40.0)).abs() < 1e-9, "{}", sum.total);
    }
}
