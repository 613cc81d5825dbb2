//! The probe that sees addresses.

use serde::{Deserialize, Serialize};

use super::MissCurve;
use super::touched::Touched;
use crate::{Memory, OpClass, Operand, Probe, StageLevel};

const MEMORIES: usize = Memory::ALL.len();

/// Bits of what a pixel has so far where voxels are blended: nine of how much
/// it still lets through, 24 of each colour. Fixed by the drawing rule, whatever the format.
pub const ACCUMULATOR_BITS: u32 = 9 + 3 * 24;

/// Bits of a pixel: red, green and blue.
pub const PIXEL_BITS: u32 = 24;

/// Bits that one access of each memory moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Widths {
    /// A record of the stack.
    pub stack_bits: u32,
    /// A node: mask and first child, or whatever a node is.
    pub node_bits: u32,
    /// Colour and normal of a node.
    pub attribute_bits: u32,
    /// A fill vector: four bits, one for each quarter.
    pub fill_vector_bits: u32,
    /// A pixel.
    pub pixel_bits: u32,
}

impl Widths {
    /// Bits that an access of this memory moves.
    #[must_use]
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

/// A probe that follows what goes to and from the memories. It does not look
/// at operations; pair it with a [`Counter`](crate::count::Counter) for both.
///
/// ```
/// use hwmodel::memory::{MemoryProbe, Widths};
/// use hwmodel::{Datapath, Format, Memory, Overflow};
///
/// let widths = Widths {
///     stack_bits: 700,
///     node_bits: 64,
///     attribute_bits: 56,
///     fill_vector_bits: 4,
///     pixel_bits: 24,
/// };
/// let mut probe = MemoryProbe::new(widths).with_curve(Memory::Node, 32);
/// let mut dp = Datapath::new(Format::new(24, 8)?, Overflow::Trap, &mut probe);
/// dp.write(Memory::Stack, 0); // a push
/// dp.read(Memory::Stack, 0); // and its pop
/// dp.read(Memory::Node, 0);
/// dp.read(Memory::Node, 3); // the same line: four nodes are 32 bytes
///
/// assert_eq!(probe.deepest_stack(), 1);
/// assert_eq!(probe.read_bits(Memory::Node), 128);
/// assert_eq!(probe.curves()[0].1.misses(1), 1);
/// # Ok::<(), hwmodel::FormatError>(())
/// ```
#[derive(Debug, Clone)]
pub struct MemoryProbe {
    widths: Widths,
    reads: [u64; MEMORIES],
    writes: [u64; MEMORIES],
    touched: [Touched; MEMORIES],
    curves: Vec<(Memory, MissCurve)>,
    /// Pushes by the depth that they make, in records.
    depths: Vec<u64>,
}

/// A stack deeper than this is counted at this depth: no stack is, and an
/// address that is no depth must not take all memory.
const MAX_DEPTH: usize = 1 << 20;

impl MemoryProbe {
    /// A probe that has seen nothing.
    #[must_use]
    pub fn new(widths: Widths) -> Self {
        Self {
            widths,
            reads: [0; MEMORIES],
            writes: [0; MEMORIES],
            touched: Default::default(),
            curves: Vec::new(),
            depths: Vec::new(),
        }
    }

    /// The same probe, which also draws a memory's miss curve for lines of
    /// `line_bytes`; call it several times for several.
    #[must_use]
    pub fn with_curve(mut self, memory: Memory, line_bytes: u32) -> Self {
        self.curves.push((memory, MissCurve::new(line_bytes)));
        self
    }

    /// What an access of each memory moves.
    #[must_use]
    pub fn widths(&self) -> Widths {
        self.widths
    }

    /// Reads of a memory.
    #[must_use]
    pub fn reads(&self, memory: Memory) -> u64 {
        self.reads[memory as usize]
    }

    /// Writes of a memory.
    #[must_use]
    pub fn writes(&self, memory: Memory) -> u64 {
        self.writes[memory as usize]
    }

    /// Bits read from a memory.
    #[must_use]
    pub fn read_bits(&self, memory: Memory) -> u64 {
        self.reads(memory) * u64::from(self.widths.of(memory))
    }

    /// Bits written to a memory.
    #[must_use]
    pub fn written_bits(&self, memory: Memory) -> u64 {
        self.writes(memory) * u64::from(self.widths.of(memory))
    }

    /// Different addresses of a memory that were read or written.
    #[must_use]
    pub fn distinct(&self, memory: Memory) -> u64 {
        self.touched[memory as usize].distinct()
    }

    /// Miss curves, in the order in which they were requested.
    #[must_use]
    pub fn curves(&self) -> &[(Memory, MissCurve)] {
        &self.curves
    }

    /// Most records that the stack held at once.
    #[must_use]
    pub fn deepest_stack(&self) -> u64 {
        self.depths.len().saturating_sub(1) as u64
    }

    /// How often a push made the stack so many records deep: entry `d` for
    /// depth `d`; entry 0 is always 0.
    #[must_use]
    pub fn stack_depths(&self) -> &[u64] {
        &self.depths
    }

    fn access(&mut self, memory: Memory, address: u64) {
        self.touched[memory as usize].touch(address);
        let bits = u64::from(self.widths.of(memory));
        for (of, curve) in &mut self.curves {
            if *of == memory {
                // Bits, for elements need not be whole bytes.
                let start = address.saturating_mul(bits);
                let end = start.saturating_add(bits.max(1) - 1);
                curve.access(start / 8, end / 8 - start / 8 + 1);
            }
        }
    }
}

impl Probe for MemoryProbe {
    #[inline(always)]
    fn op(&mut self, _: OpClass, _: u32, _: StageLevel, _: u32) {}

    #[inline(always)]
    fn op_on(&mut self, _: Operand, _: OpClass, _: u32, _: StageLevel) {}

    fn read(&mut self, memory: Memory, address: u64, _: StageLevel) {
        self.reads[memory as usize] += 1;
        self.access(memory, address);
    }

    fn write(&mut self, memory: Memory, address: u64, _: StageLevel) {
        self.writes[memory as usize] += 1;
        if memory == Memory::Stack {
            let depth = usize::try_from(address).map_or(MAX_DEPTH, |at| at.min(MAX_DEPTH - 1) + 1);
            if self.depths.len() <= depth {
                self.depths.resize(depth + 1, 0);
            }
            self.depths[depth] += 1;
        }
        self.access(memory, address);
    }
}
