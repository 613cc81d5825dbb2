//! An operation is one addition at a nearly constant address, so the compiler combines neighbouring counts. Only the level
//! is unknown at compile time: each of a few sets has the counts of one level, and is settled when it changes to another.

use std::collections::BTreeMap;

use crate::probe::{Memory, OpClass, Operand, Probe, StageLevel};
use crate::{Format, MAX_STAGES, Stage};

/// Octree levels; deeper ones count as the last.
pub const LEVELS: usize = 64;

const CLASSES: usize = OpClass::ALL.len();
const STAGES: usize = MAX_STAGES;
const MEMORIES: usize = Memory::ALL.len();

/// Counts of one stage: operations by class, short operands by number of bits, or accesses by memory.
pub(super) type CountRow = [u64; 8];

/// First rows, each of one row per stage: words, words with carry, wide words, wide words with carry.
pub(super) const SIZED: [usize; 4] = [0, STAGES, 2 * STAGES, 3 * STAGES];
/// Logic on fewer than eight bits, by their number.
pub(super) const SHORT: usize = 4 * STAGES;
pub(super) const READS: usize = 5 * STAGES;
pub(super) const WRITES: usize = 6 * STAGES;
const ROWS: usize = 7 * STAGES;

/// Sets of fresh counts, 6 KB each: level `l` counts in set `l % SETS`.
pub(super) const SETS: usize = 16;

const _: () = assert!(CLASSES <= 8 && MEMORIES <= 8);

type Table = Vec<[[u64; CLASSES]; STAGES]>;

/// Counts of one or more frames.
#[derive(Debug, Clone)]
pub struct Counter {
    /// By set. 94 KB would fill small stacks.
    pub(super) fresh: Box<[[CountRow; ROWS]; SETS]>,
    pub(super) levels: [usize; SETS],
    set: usize,
    pub(super) widths: [u32; 4],
    pub(super) settled: Vec<[CountRow; ROWS]>,
    pub(super) tables: BTreeMap<u32, Table>,
    pub(super) records: [u64; LEVELS],
    /// With the names under which they were entered.
    pub(super) stages: [Stage; STAGES],
}

impl Default for Counter {
    fn default() -> Self {
        let fresh = vec![[CountRow::default(); ROWS]; SETS].into_boxed_slice();
        Self {
            fresh: fresh
                .try_into()
                .unwrap_or_else(|_| unreachable!("as many as it says")),
            levels: std::array::from_fn(|set| set),
            set: 0,
            widths: [0; 4],
            settled: vec![[CountRow::default(); ROWS]; LEVELS],
            tables: BTreeMap::new(),
            records: [0; LEVELS],
            stages: std::array::from_fn(|number| Stage::new(number as u8, "unnamed")),
        }
    }
}

fn clamped(level: u32) -> usize {
    (level as usize).min(LEVELS - 1)
}

impl Counter {
    /// A counter at zero.
    pub fn new() -> Self {
        Self::default()
    }

    fn table(&mut self, bits: u32) -> &mut Table {
        let empty = || vec![Default::default(); LEVELS];
        self.tables.entry(bits).or_insert_with(empty)
    }

    #[cold]
    #[inline(never)]
    fn settle(&mut self, set: usize) {
        let settled = &mut self.settled[self.levels[set]];
        for (sums, row) in settled.iter_mut().zip(&mut self.fresh[set]) {
            if row.iter().fold(0, |bits, count| bits | count) != 0 {
                add_and_clear(sums, row);
            }
        }
    }

    fn keep_widths(&mut self) {
        for set in 0..SETS {
            self.settle(set);
        }
        for (first, bits) in SIZED.into_iter().zip(self.widths) {
            for level in 0..LEVELS {
                for stage in 0..STAGES {
                    let row = std::mem::take(&mut self.settled[level][first + stage]);
                    if row != CountRow::default() {
                        add_and_clear(&mut self.table(bits)[level][stage], &mut { row });
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn count_fresh(&mut self, row: usize, column: usize) {
        // The remainder gives the compiler the bound.
        self.fresh[self.set % SETS][row][column] += 1;
    }

    /// Counts operations whose kind of operand is not known at compile time.
    #[inline(never)]
    fn count(&mut self, class: OpClass, bits: u32, place: StageLevel, times: u32) {
        self.stages[place.stage.number()] = place.stage;
        let counts = &mut self.table(bits)[clamped(place.level)];
        counts[place.stage.number()][class as usize] += u64::from(times);
    }
}

#[inline(always)]
fn add_and_clear<const N: usize>(sums: &mut [u64; N], row: &mut [u64; N]) {
    for (sum, count) in sums.iter_mut().zip(row) {
        *sum += std::mem::take(count);
    }
}

impl Probe for Counter {
    fn begin(&mut self, format: Format) {
        let (word, wide) = (format.bits(), format.wide().bits());
        let widths = [word, word + 1, wide, wide + 1];
        if self.widths != widths {
            self.keep_widths();
            self.widths = widths;
        }
    }

    #[inline(always)]
    fn stage(&mut self, stage: Stage) {
        self.stages[stage.number()] = stage;
    }

    #[inline]
    fn op(&mut self, class: OpClass, bits: u32, place: StageLevel, times: u32) {
        self.count(class, bits, place, times);
    }

    #[inline(always)]
    fn op_on(&mut self, operand: Operand, class: OpClass, bits: u32, place: StageLevel) {
        let stage = place.stage.number();
        let first = match operand {
            Operand::Word => SIZED[0],
            Operand::Carry => SIZED[1],
            Operand::Wide => SIZED[2],
            Operand::WideCarry => SIZED[3],
            Operand::Short if class == OpClass::Logic && bits < 8 => {
                return self.count_fresh(SHORT + stage, bits as usize);
            }
            Operand::Short | Operand::Control | Operand::Other => {
                return self.count(class, bits, place, 1);
            }
        };
        self.count_fresh(first + stage, class as usize);
    }

    #[inline(always)]
    fn read(&mut self, memory: Memory, _address: u64, place: StageLevel) {
        self.count_fresh(READS + place.stage.number(), memory as usize);
    }

    #[inline(always)]
    fn write(&mut self, memory: Memory, _address: u64, place: StageLevel) {
        self.count_fresh(WRITES + place.stage.number(), memory as usize);
    }

    #[inline(always)]
    fn record(&mut self, _index: u64, level: u32) {
        let level = clamped(level);
        self.set = level % SETS;
        if level != self.levels[self.set] {
            self.settle(self.set);
            self.levels[self.set] = level;
        }
        self.records[level] += 1;
    }
}
