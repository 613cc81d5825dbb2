//! Energy of counted operations and accesses, line by line.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{Cost, CostError, CostTable};
use crate::count::{Accesses, Counter};
use crate::memory::Widths;
use crate::{Memory, OpClass, Stage};

/// Implementation of shifts by a constant or by a level's number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ShiftUnits {
    /// Wires, by the row `shift_wires`.
    #[default]
    Wires,
    /// Shifters, by the rows of `shift_var`.
    Variable,
}

/// Choices that the counts leave open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
pub struct Costing {
    /// Implementation of shifts.
    pub shifts: ShiftUnits,
}

/// The operation of a table for a class. Logic is priced as `xor`.
pub const fn operation_of(class: OpClass, shifts: ShiftUnits) -> &'static str {
    match class {
        OpClass::Add => "add",
        OpClass::Sub => "sub",
        OpClass::Compare => "less",
        OpClass::MinMax => "min",
        OpClass::Select => "select",
        OpClass::Shift => match shifts {
            ShiftUnits::Wires => "shift_wires",
            ShiftUnits::Variable => "shift_var",
        },
        OpClass::Logic => "xor",
        OpClass::DivideStep => "divide_step",
    }
}

/// Exclusive ors of the stage *order* with constants, which are one inversion of the octant and wires.
const ORDERED_OCTANTS: u64 = 8;

/// A number of operations of one kind.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Tally {
    /// Operation of the cost table, such as `add` or `float_multiply`.
    pub operation: String,
    /// Width, in bits.
    pub width: u32,
    /// Number of operations.
    pub times: u64,
}

/// One line of a sum.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// A unit's or a memory's name, or the operation.
    pub name: String,
    /// Operation of the cost table.
    pub operation: String,
    /// Width, in bits.
    pub width: u32,
    /// Number of operations, accesses or units.
    pub times: u64,
    /// Cost of one.
    pub each: Cost,
    /// `times` times its value.
    pub total: f64,
}

/// A sum, line by line.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Breakdown {
    /// The lines, in order of operation and width, or of the bill.
    pub lines: Vec<Line>,
    /// Sum of the values.
    pub total: f64,
    /// Sum of the low ends.
    pub low: f64,
    /// Sum of the high ends.
    pub high: f64,
}

impl Breakdown {
    /// Adds a line of `times` times `each`.
    pub fn push(&mut self, name: &str, operation: &str, width: u32, times: u64, each: Cost) {
        let factor = times as f64;
        self.total += factor * each.value;
        self.low += factor * each.low;
        self.high += factor * each.high;
        self.lines.push(Line {
            name: name.to_owned(),
            operation: operation.to_owned(),
            width,
            times,
            total: factor * each.value,
            each,
        });
    }
}

/// Counted operations as operations of a cost table, by operation and width.
pub fn tallies(counter: &Counter, costing: Costing) -> Vec<Tally> {
    let mut sums = BTreeMap::<(&str, u32), u64>::new();
    let cells = counter.sum_by(|cell| (cell.stage, cell.class, cell.bits));
    for ((stage, class, bits), times) in cells {
        let (operation, times) = match (stage, class) {
            (Stage::Order, OpClass::Logic) => ("invert", times.div_ceil(ORDERED_OCTANTS)),
            _ => (operation_of(class, costing.shifts), times),
        };
        *sums.entry((operation, bits)).or_default() += times;
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
/// use hwmodel::cost::{CostTable, Costing, energy_of};
/// use hwmodel::count::Counter;
/// use hwmodel::{OpClass, Probe, Stage, StageLevel};
///
/// let mut counter = Counter::new();
/// let place = StageLevel { stage: Stage::Centre, level: 0 };
/// counter.op(OpClass::Add, 32, place, 1000);
/// counter.op(OpClass::Shift, 33, place, 1000); // wires
/// let energy = energy_of(&counter, &CostTable::load_shipped()?, Costing::default())?;
/// assert!((energy.total - 100.0).abs() < 1e-9); // pJ
/// # Ok::<(), hwmodel::cost::CostError>(())
/// ```
///
/// # Errors
/// When an operation has no row.
pub fn energy_of(
    counter: &Counter,
    table: &CostTable,
    costing: Costing,
) -> Result<Breakdown, CostError> {
    energy_of_tallies(&tallies(counter, costing), table)
}

/// Energy of operations of any kind, in picojoules.
///
/// # Errors
/// When an operation has no row.
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
///
/// # Errors
/// When a row is missing, or a memory is far larger than all rows.
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
            let (operation, each) = match store(memory) {
                Store::Sram { bytes } => {
                    let operation = format!("sram_{way}");
                    let each = table.memory_energy(&operation, bytes, width);
                    (operation, each)
                }
                Store::Dram => {
                    let operation = format!("dram_{way}");
                    let each = table.energy(&operation, width);
                    (operation, each)
                }
            };
            sum.push(memory.name(), &operation, width, times, each?);
        }
    }
    Ok(sum)
}
