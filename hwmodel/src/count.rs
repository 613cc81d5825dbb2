//! A probe that counts: operations by class, width, stage and octree level,
//! accesses by memory, stage and level, records by level.
//!
//! An operation is counted by one addition to a place in memory that is known
//! when the program is compiled, so that the compiler adds up what stands in a
//! row. That place is good for one level; when a record of another level has
//! its turn, what was touched since is added to the tables.

mod sums;

pub use sums::{AccessCount, Accesses, OpCount};

use crate::Format;
use crate::probe::{Memory, OpClass, Operand, Place, Probe, Stage};

/// Octree levels that are told apart, 0..=63; deeper ones count as the last.
pub const LEVELS: usize = 64;

const CLASSES: usize = OpClass::ALL.len();
const STAGES: usize = Stage::ALL.len();
const MEMORIES: usize = Memory::ALL.len();

/// Kinds of operand whose width the format says.
const SIZED: usize = 4;
/// Operands of fewer bits than this have a place by their number of bits.
const SHORT: usize = 8;

/// Counts of the operations of one width.
#[derive(Debug, Clone)]
struct Table {
    bits: u32,
    /// By level, stage and class; on the heap, for there may be many tables.
    counts: Vec<[[u64; CLASSES]; STAGES]>,
}

/// Counts since the level last changed.
#[derive(Debug, Clone, Default)]
struct Fresh {
    /// By kind of operand (those that the format sizes), stage and class.
    sized: [[[u64; CLASSES]; STAGES]; SIZED],
    /// Logic on few bits, by stage and number of bits.
    short: [[u64; SHORT]; STAGES],
    /// By stage; reads by memory, then writes by memory.
    accesses: [[[u64; MEMORIES]; 2]; STAGES],
    /// Which rows of `sized` may differ from zero: bit `kind * STAGES + stage`.
    sized_touched: u64,
    /// Which rows of `short` (low half) and `accesses` (high half).
    others_touched: u64,
}

/// Counts of one or more frames.
#[derive(Debug, Clone)]
pub struct Counter {
    fresh: Fresh,
    /// Level at which `fresh` counts, 0..LEVELS.
    level: usize,
    /// Where in `tables` the kinds of operand go that the format sizes.
    sized: [usize; SIZED],
    /// One for each width, in the order in which they were met.
    tables: Vec<Table>,
    /// By level and stage; reads by memory, then writes by memory.
    accesses: Vec<[[[u64; MEMORIES]; 2]; STAGES]>,
    records: [u64; LEVELS],
}

impl Default for Counter {
    fn default() -> Self {
        let mut counter = Self {
            fresh: Fresh::default(),
            level: 0,
            sized: [0; SIZED],
            tables: Vec::new(),
            accesses: vec![Default::default(); LEVELS],
            records: [0; LEVELS],
        };
        // The tables of short operands stand first, by their number of bits.
        for bits in 0..SHORT as u32 {
            counter.table_of(bits);
        }
        counter
    }
}

fn clamped(level: u32) -> usize {
    (level as usize).min(LEVELS - 1)
}

impl Counter {
    /// A counter at zero.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Where in `tables` a width is; a table is made for one not met before.
    fn table_of(&mut self, bits: u32) -> usize {
        let known = self.tables.iter().position(|table| table.bits == bits);
        known.unwrap_or_else(|| {
            let counts = vec![Default::default(); LEVELS];
            self.tables.push(Table { bits, counts });
            self.tables.len() - 1
        })
    }

    /// Adds the fresh counts to the tables.
    #[cold]
    #[inline(never)]
    fn settle(&mut self) {
        let fresh = &mut self.fresh;
        let mut touched = std::mem::take(&mut fresh.sized_touched);
        while touched != 0 {
            let row = touched.trailing_zeros() as usize;
            touched &= touched - 1;
            let (kind, stage) = (row / STAGES, row % STAGES);
            let counts = &mut self.tables[self.sized[kind]].counts[self.level][stage];
            add_and_clear(counts, &mut fresh.sized[kind][stage]);
        }
        let mut touched = std::mem::take(&mut fresh.others_touched);
        while touched != 0 {
            let row = touched.trailing_zeros() as usize;
            touched &= touched - 1;
            let stage = row % 32;
            if row < 32 {
                for (bits, times) in fresh.short[stage].iter_mut().enumerate() {
                    let counts = &mut self.tables[bits].counts[self.level][stage];
                    counts[OpClass::Logic as usize] += std::mem::take(times);
                }
            } else {
                let [reads, writes] = &mut self.accesses[self.level][stage];
                add_and_clear(reads, &mut fresh.accesses[stage][0]);
                add_and_clear(writes, &mut fresh.accesses[stage][1]);
            }
        }
    }

    /// Counts operations whose kind of operand is not known beforehand.
    #[inline(never)]
    fn count(&mut self, class: OpClass, bits: u32, place: Place, times: u32) {
        let table = self.table_of(bits);
        let counts = &mut self.tables[table].counts[clamped(place.level)];
        counts[place.stage as usize][class as usize] += u64::from(times);
    }
}

/// Adds a row of counts to another, and sets it to zero.
#[inline(always)]
fn add_and_clear<const N: usize>(sums: &mut [u64; N], row: &mut [u64; N]) {
    for (sum, count) in sums.iter_mut().zip(row) {
        *sum += std::mem::take(count);
    }
}

impl Probe for Counter {
    fn begin(&mut self, format: Format) {
        self.settle();
        let (word, wide) = (format.bits(), format.wide().bits());
        self.sized = [word, word + 1, wide, wide + 1].map(|bits| self.table_of(bits));
    }

    #[inline]
    fn op(&mut self, class: OpClass, bits: u32, place: Place, times: u32) {
        self.count(class, bits, place, times);
    }

    #[inline(always)]
    fn op_on(&mut self, operand: Operand, class: OpClass, bits: u32, place: Place) {
        let (stage, class_at) = (place.stage as usize, class as usize);
        let kind = match operand {
            Operand::Word => 0,
            Operand::Carry => 1,
            Operand::Wide => 2,
            Operand::WideCarry => 3,
            Operand::Short if class == OpClass::Logic && (bits as usize) < SHORT => {
                self.fresh.short[stage][bits as usize] += 1;
                self.fresh.others_touched |= 1 << stage;
                return;
            }
            Operand::Short | Operand::Other => return self.count(class, bits, place, 1),
        };
        self.fresh.sized[kind][stage][class_at] += 1;
        self.fresh.sized_touched |= 1 << (kind * STAGES + stage);
    }

    #[inline(always)]
    fn read(&mut self, memory: Memory, _address: u64, place: Place) {
        self.fresh.accesses[place.stage as usize][0][memory as usize] += 1;
        self.fresh.others_touched |= 1 << (32 + place.stage as usize);
    }

    #[inline(always)]
    fn write(&mut self, memory: Memory, _address: u64, place: Place) {
        self.fresh.accesses[place.stage as usize][1][memory as usize] += 1;
        self.fresh.others_touched |= 1 << (32 + place.stage as usize);
    }

    #[inline(always)]
    fn record(&mut self, _index: u64, level: u32) {
        let level = clamped(level);
        if level != self.level {
            self.settle();
            self.level = level;
        }
        self.records[level] += 1;
    }
}
