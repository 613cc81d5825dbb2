//! The probe of memory traffic.

use serde::{Deserialize, Serialize};

use crate::count::Accesses;
use crate::hash::NumberMap;
use crate::{Memory, OpClass, Operand, Probe, StageLevel};

const MEMORIES: usize = Memory::ALL.len();

/// Bits of a blended pixel's accumulator: nine of transmittance, 24 of each colour.
pub const ACCUMULATOR_BITS: u32 = 9 + 3 * 24;

/// Bits of a pixel: red, green and blue.
pub const PIXEL_BITS: u32 = 24;

/// Bits per access of each memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[expect(missing_docs, reason = "names of the other fields say what they are")]
pub struct Widths {
    /// Of a record.
    pub stack_bits: u32,
    pub node_bits: u32,
    /// Colour and normal of a node.
    pub attribute_bits: u32,
    /// One per quarter of a picture node.
    pub fill_vector_bits: u32,
    pub pixel_bits: u32,
}

impl Widths {
    /// Bits of an access of a memory.
    pub const fn of(&self, memory: Memory) -> u32 {
        match memory {
            Memory::Stack => self.stack_bits,
            Memory::Node => self.node_bits,
            Memory::Attribute => self.attribute_bits,
            Memory::FillVector => self.fill_vector_bits,
            Memory::Pixel => self.pixel_bits,
            Memory::Accumulator => ACCUMULATOR_BITS,
        }
    }
}

/// A probe of the traffic to the memories.
#[derive(Debug, Clone)]
pub struct MemoryProbe {
    widths: Widths,
    accesses: [Accesses; MEMORIES],
    touched: [Touched; MEMORIES],
    deepest: u64,
}

impl MemoryProbe {
    /// A probe without records.
    pub fn new(widths: Widths) -> Self {
        Self {
            widths,
            accesses: Default::default(),
            touched: Default::default(),
            deepest: 0,
        }
    }

    /// Reads of a memory.
    pub fn reads(&self, memory: Memory) -> u64 {
        self.accesses[memory as usize].reads
    }

    /// Writes of a memory.
    pub fn writes(&self, memory: Memory) -> u64 {
        self.accesses[memory as usize].writes
    }

    /// Bits read from a memory.
    pub fn read_bits(&self, memory: Memory) -> u64 {
        self.reads(memory) * u64::from(self.widths.of(memory))
    }

    /// Bits written to a memory.
    pub fn written_bits(&self, memory: Memory) -> u64 {
        self.writes(memory) * u64::from(self.widths.of(memory))
    }

    /// Number of different addresses.
    pub fn distinct(&self, memory: Memory) -> u64 {
        self.touched[memory as usize].distinct
    }

    /// Most records on the stack.
    pub fn deepest_stack(&self) -> u64 {
        self.deepest
    }
}

impl Probe for MemoryProbe {
    #[inline(always)]
    fn op(&mut self, _: OpClass, _: u32, _: StageLevel, _: u32) {}

    #[inline(always)]
    fn op_on(&mut self, _: Operand, _: OpClass, _: u32, _: StageLevel) {}

    fn read(&mut self, memory: Memory, address: u64, _: StageLevel) {
        self.accesses[memory as usize].reads += 1;
        self.touched[memory as usize].touch(address);
    }

    fn write(&mut self, memory: Memory, address: u64, _: StageLevel) {
        self.accesses[memory as usize].writes += 1;
        if memory == Memory::Stack {
            self.deepest = self.deepest.max(address.saturating_add(1));
        }
        self.touched[memory as usize].touch(address);
    }
}

/// A set of addresses, one bit each in pages of 4096.
#[derive(Debug, Clone, Default)]
struct Touched {
    pages: NumberMap<u64, Box<[u64; 64]>>,
    distinct: u64,
}

impl Touched {
    fn touch(&mut self, address: u64) {
        let page = self
            .pages
            .entry(address >> 12)
            .or_insert_with(|| Box::new([0; 64]));
        let word = &mut page[(address >> 6) as usize % 64];
        let bit = 1 << (address % 64);
        self.distinct += u64::from(*word & bit == 0);
        *word |= bit;
    }
}
