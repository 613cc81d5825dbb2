//! Sums of a [`Counter`]'s counts.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::AddAssign;

use serde::{Deserialize, Serialize};

use super::counter::{CountRow, Counter, LEVELS, READS, SETS, SHORT, SIZED, WRITES};
use crate::Stage;
use crate::probe::{Memory, OpClass};

/// Number of operations of one kind at one place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[expect(missing_docs, reason = "names of the other fields say what they are")]
pub struct OpCount {
    pub class: OpClass,
    /// Width of its operands.
    pub bits: u32,
    pub stage: Stage,
    /// Octree level, 0 = root, at most 63.
    pub level: u32,
    /// At least 1.
    pub times: u64,
}

/// Numbers of accesses.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize,
)]
#[expect(missing_docs, reason = "names of the fields say what they are")]
pub struct Accesses {
    pub reads: u64,
    pub writes: u64,
}

impl AddAssign for Accesses {
    fn add_assign(&mut self, other: Self) {
        self.reads += other.reads;
        self.writes += other.writes;
    }
}

/// Accesses to one memory from one place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[expect(missing_docs, reason = "as in `OpCount`")]
pub struct AccessCount {
    pub memory: Memory,
    pub stage: Stage,
    pub level: u32,
    /// Not both zero.
    pub accesses: Accesses,
}

impl Counter {
    /// Operations of one class in one stage.
    pub fn ops_at(&self, stage: impl Into<Stage>, class: OpClass) -> u64 {
        let stage = stage.into();
        self.sum(|cell| cell.stage == stage && cell.class == class)
    }

    /// Operations of one class in all stages.
    pub fn ops_of(&self, class: OpClass) -> u64 {
        self.sum(|cell| cell.class == class)
    }

    /// All operations.
    pub fn ops(&self) -> u64 {
        self.sum(|_| true)
    }

    fn sum(&self, wanted: impl Fn(&OpCount) -> bool) -> u64 {
        let cells = self.cells().filter(wanted);
        cells.map(|cell| cell.times).sum()
    }

    /// Operations added up by any key, such as `|cell| (cell.class, cell.bits)`.
    pub fn sum_by<K: Ord>(&self, key: impl Fn(&OpCount) -> K) -> BTreeMap<K, u64> {
        let mut sums = BTreeMap::new();
        for cell in self.cells() {
            *sums.entry(key(&cell)).or_default() += cell.times;
        }
        sums
    }

    /// Accesses added up by any key.
    pub fn accesses_by<K: Ord>(&self, key: impl Fn(&AccessCount) -> K) -> BTreeMap<K, Accesses> {
        let mut sums = BTreeMap::<K, Accesses>::new();
        for cell in self.accesses() {
            *sums.entry(key(&cell)).or_default() += cell.accesses;
        }
        sums
    }

    /// Reads of one memory.
    pub fn reads(&self, memory: Memory) -> u64 {
        self.accesses_of(memory).reads
    }

    /// Writes of one memory.
    pub fn writes(&self, memory: Memory) -> u64 {
        self.accesses_of(memory).writes
    }

    fn accesses_of(&self, memory: Memory) -> Accesses {
        let sums = self.accesses_by(|cell| cell.memory);
        sums.get(&memory).copied().unwrap_or_default()
    }

    /// Records that had their turn.
    pub fn records(&self) -> u64 {
        self.records.iter().sum()
    }

    /// Records that had their turn, by octree level.
    pub fn records_by_level(&self) -> impl Iterator<Item = (u32, u64)> + '_ {
        let levels = (0u32..).zip(self.records);
        levels.filter(|(_, records)| *records > 0)
    }

    /// Bits of the widest operation; 0 without operations.
    pub fn widest(&self) -> u32 {
        self.cells().map(|cell| cell.bits).max().unwrap_or(0)
    }

    /// All cells that are not zero, by width, then level, stage and class.
    pub fn cells(&self) -> impl Iterator<Item = OpCount> + '_ {
        let widths = self.tables.keys().copied().chain(self.widths);
        let widths: BTreeSet<u32> = widths.chain(0..8).collect();
        widths.into_iter().flat_map(|bits| self.cells_of(bits))
    }

    fn cells_of(&self, bits: u32) -> impl Iterator<Item = OpCount> + '_ {
        let table = self.tables.get(&bits);
        let sized = SIZED.into_iter().zip(self.widths);
        let sized: Vec<usize> = sized.filter(|row| row.1 == bits).map(|row| row.0).collect();
        let places = (0..LEVELS).flat_map(|level| self.stages.map(|stage| (level, stage)));
        let cells = places.flat_map(move |(level, stage)| {
            let mut row = table.map_or([0; 8], |table| table[level][stage.number()]);
            for first in &sized {
                add(&mut row, &self.row(level, first + stage.number()));
            }
            if bits < 8 {
                let logic = self.row(level, SHORT + stage.number())[bits as usize];
                row[OpClass::Logic as usize] += logic;
            }
            OpClass::ALL.map(|class| OpCount {
                class,
                bits,
                stage,
                level: level as u32,
                times: row[class as usize],
            })
        });
        cells.filter(|cell| cell.times > 0)
    }

    /// All accesses, by level, then stage and memory.
    pub fn accesses(&self) -> impl Iterator<Item = AccessCount> + '_ {
        let places = (0..LEVELS).flat_map(|level| self.stages.map(|stage| (level, stage)));
        let cells = places.flat_map(move |(level, stage)| {
            let [reads, writes] =
                [READS, WRITES].map(|first| self.row(level, first + stage.number()));
            Memory::ALL.map(|memory| AccessCount {
                memory,
                stage,
                level: level as u32,
                accesses: Accesses {
                    reads: reads[memory as usize],
                    writes: writes[memory as usize],
                },
            })
        });
        cells.filter(|cell| cell.accesses != Accesses::default())
    }

    fn row(&self, level: usize, row: usize) -> CountRow {
        let mut sum = self.settled[level][row];
        let set = level % SETS;
        if level == self.levels[set] {
            add(&mut sum, &self.fresh[set][row]);
        }
        sum
    }
}

fn add(sums: &mut CountRow, row: &CountRow) {
    for (sum, count) in sums.iter_mut().zip(row) {
        *sum += count;
    }
}

impl PartialEq for Counter {
    fn eq(&self, other: &Self) -> bool {
        self.records == other.records
            && self.cells().eq(other.cells())
            && self.accesses().eq(other.accesses())
    }
}

impl Eq for Counter {}
