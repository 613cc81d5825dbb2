//! A probe that counts: operations by class and stage, accesses by memory.

use crate::probe::{Memory, OpClass, Place, Probe, Stage};

const CLASSES: usize = OpClass::ALL.len();
const STAGES: usize = Stage::ALL.len();
const MEMORIES: usize = Memory::ALL.len();

/// Counts of one or more frames.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Counter {
    ops: [[u64; CLASSES]; STAGES],
    reads: [u64; MEMORIES],
    writes: [u64; MEMORIES],
    records: u64,
    widest: u32,
}

impl Counter {
    /// A counter at zero.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Operations of one class in one stage.
    #[must_use]
    pub fn ops_at(&self, stage: Stage, class: OpClass) -> u64 {
        self.ops[stage as usize][class as usize]
    }

    /// Operations of one class in all stages.
    #[must_use]
    pub fn ops_of(&self, class: OpClass) -> u64 {
        self.ops.iter().map(|stage| stage[class as usize]).sum()
    }

    /// All operations.
    #[must_use]
    pub fn ops(&self) -> u64 {
        self.ops.iter().flatten().sum()
    }

    /// Reads of one memory.
    #[must_use]
    pub fn reads(&self, memory: Memory) -> u64 {
        self.reads[memory as usize]
    }

    /// Writes of one memory.
    #[must_use]
    pub fn writes(&self, memory: Memory) -> u64 {
        self.writes[memory as usize]
    }

    /// Records that had their turn.
    #[must_use]
    pub fn records(&self) -> u64 {
        self.records
    }

    /// Width of the widest operation, in bits.
    #[must_use]
    pub fn widest(&self) -> u32 {
        self.widest
    }
}

impl Probe for Counter {
    #[inline]
    fn op(&mut self, class: OpClass, bits: u32, place: Place, times: u32) {
        self.ops[place.stage as usize][class as usize] += u64::from(times);
        self.widest = self.widest.max(bits);
    }

    #[inline]
    fn read(&mut self, memory: Memory, _address: u64, _place: Place) {
        self.reads[memory as usize] += 1;
    }

    #[inline]
    fn write(&mut self, memory: Memory, _address: u64, _place: Place) {
        self.writes[memory as usize] += 1;
    }

    #[inline]
    fn record(&mut self, _index: u64, _level: u32) {
        self.records += 1;
    }
}
