//! Energy of counted operations and accesses, line by line.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{Cost, CostError, CostTable};
use crate::count::{Accesses, Counter, OpCount};
use crate::memory::Widths;
use crate::{Memory, OpClass};

/// The operation of a table for a class. Logic is priced as `xor`, and shifts as wires; those that need a shifter are
/// `shift_var` ([`ShiftProbe`](crate::shifts::ShiftProbe)).
pub const fn operation_of(class: OpClass) -> &'static str {
    match class {
        OpClass::Add => "add",
        OpClass::Sub => "sub",
        OpClass::Compare => "less",
        OpClass::MinMax => "min",
        OpClass::Select => "select",
        OpClass::Shift => "shift_wires",
        OpClass::Logic => "xor",
        OpClass::DivideStep => "divide_step",
    }
}

/// The operation of a table for a unit of a class.
pub const fn unit_of(class: OpClass) -> &'static str {
    match class {
        OpClass::Shift => "shift_var",
        other => operation_of(other),
    }
}

/// A number of operations of one kind.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[expect(missing_docs, reason = "names of the other fields say what they are")]
pub struct Tally {
    /// As in the cost table, such as `add` or `float_multiply`.
    pub operation: String,
    /// In bits.
    pub width: u32,
    pub times: u64,
}

/// One line of a sum.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the other fields are as in `Tally`")]
pub struct Line {
    /// A unit's or a memory's name, or the operation.
    pub name: String,
    pub operation: String,
    pub width: u32,
    /// Of a memory on the chip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bytes: Option<u64>,
    /// Number of operations, accesses or units.
    pub times: u64,
    /// Cost of one.
    pub each: Cost,
    /// `times` times its value.
    pub total: f64,
}

/// A sum, line by line.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[expect(missing_docs, reason = "names of the other fields say what they are")]
pub struct Breakdown {
    /// In order of operation and width, or of the bill.
    pub lines: Vec<Line>,
    pub total: f64,
}

impl Breakdown {
    /// Adds a line of `times` times `each`.
    pub fn push(&mut self, name: &str, operation: &str, width: u32, times: u64, each: Cost) {
        let factor = times as f64;
        self.total += factor * each.value;
        self.lines.push(Line {
            name: name.to_owned(),
            operation: operation.to_owned(),
            width,
            bytes: None,
            times,
            total: factor * each.value,
            each,
        });
    }

    /// Notes the size of the last line's memory.
    pub fn of_bytes(&mut self, bytes: Option<u64>) {
        if let Some(line) = self.lines.last_mut() {
            line.bytes = bytes;
        }
    }
}

/// Operations added up. For a cell, `priced` returns an operation of the table and its number.
pub fn tallies(counter: &Counter, priced: impl Fn(&OpCount) -> (&'static str, u64)) -> Vec<Tally> {
    let mut sums = BTreeMap::<(&str, u32), u64>::new();
    for cell in counter.cells() {
        let (operation, times) = priced(&cell);
        *sums.entry((operation, cell.bits)).or_default() += times;
    }
    let tally = |((operation, width), times): ((&str, u32), u64)| Tally {
        operation: operation.to_owned(),
        width,
        times,
    };
    sums.into_iter().map(tally).collect()
}

/// Energy of all counted operations, in picojoules.
///
/// ```
/// use hwmodel::cost::{CostTable, energy_of};
/// use hwmodel::count::Counter;
/// use hwmodel::{OpClass, Probe, Stage, StageLevel};
///
/// let mut counter = Counter::new();
/// let place = StageLevel { stage: Stage::new(0, "blur"), level: 0 };
/// counter.op(OpClass::Add, 32, place, 1000);
/// counter.op(OpClass::Shift, 33, place, 1000); // wires
/// let energy = energy_of(&counter, &CostTable::load_shipped()?)?;
/// assert!((energy.total - 100.0).abs() < 1e-9); // pJ
/// # Ok::<(), hwmodel::cost::CostError>(())
/// ```
pub fn energy_of(counter: &Counter, table: &CostTable) -> Result<Breakdown, CostError> {
    let tallies = tallies(counter, |cell| (operation_of(cell.class), cell.times));
    energy_of_tallies(&tallies, table)
}

/// Energy of operations of any kind, in picojoules.
pub fn energy_of_tallies(tallies: &[Tally], table: &CostTable) -> Result<Breakdown, CostError> {
    let mut sum = Breakdown::default();
    for tally in tallies {
        let (operation, width) = (&tally.operation, tally.width);
        let each = table.energy(operation, width)?;
        sum.push(operation, operation, width, tally.times, each);
    }
    Ok(sum)
}

/// The technology of a memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Store {
    /// SRAM: rows `sram_read` and `sram_write`.
    Sram {
        /// Its size, at least 1.
        bytes: u64,
    },
    /// DRAM: rows `dram_read` and `dram_write`.
    Dram,
}

/// Energy of accesses, in picojoules.
pub fn memory_energy_of(
    accesses: &BTreeMap<Memory, Accesses>,
    widths: &Widths,
    store: impl Fn(Memory) -> Store,
    table: &CostTable,
) -> Result<Breakdown, CostError> {
    let mut sum = Breakdown::default();
    for (&memory, accesses) in accesses {
        let width = widths.of(memory);
        for (way, times) in [("read", accesses.reads), ("write", accesses.writes)] {
            if times == 0 {
                continue;
            }
            let (sram, dram) = (format!("sram_{way}"), format!("dram_{way}"));
            let (operation, size, each) = match store(memory) {
                Store::Sram { bytes } => {
                    let each = table.memory_energy(&sram, bytes, width)?;
                    (&sram, Some(bytes), each)
                }
                Store::Dram => (&dram, None, table.energy(&dram, width)?),
            };
            sum.push(memory.name(), operation, width, times, each);
            sum.of_bytes(size);
        }
    }
    Ok(sum)
}
