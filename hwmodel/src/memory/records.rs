//! Kinds of record on the stack, and their bits.

use serde::{Deserialize, Serialize};

use crate::count::Accesses;
use crate::{Memory, OpClass, Operand, Probe, StageLevel};

named! {
    /// The kinds of record that a stack holds.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    #[repr(u8)]
    pub enum RecordKind {
        Clip = "in clip space",
        Screen = "in screen space",
        /// A finest voxel, which needs no vertices.
        Finest = "finest voxel",
    }
}

/// Bits of a record by its kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "the other fields are as in `RecordKind`")]
pub struct RecordBits {
    pub clip: u32,
    pub screen: u32,
    pub finest: u32,
    /// First octree level of finest voxels, if known.
    pub finest_level: Option<u32>,
}

impl RecordBits {
    /// The same bits for all kinds.
    pub const fn uniform(bits: u32) -> Self {
        Self {
            clip: bits,
            screen: bits,
            finest: bits,
            finest_level: None,
        }
    }

    /// Bits of a record of a kind.
    pub const fn of(&self, kind: RecordKind) -> u32 {
        match kind {
            RecordKind::Clip => self.clip,
            RecordKind::Screen => self.screen,
            RecordKind::Finest => self.finest,
        }
    }

    /// Bits of a stack's entry.
    pub fn widest(&self) -> u32 {
        self.clip.max(self.screen).max(self.finest)
    }

    /// The kind of a record at an octree level.
    pub fn kind(&self, level: u32, in_screen_space: bool) -> RecordKind {
        match self.finest_level {
            Some(finest) if level >= finest => RecordKind::Finest,
            _ if in_screen_space => RecordKind::Screen,
            _ => RecordKind::Clip,
        }
    }
}

/// A probe of the records on the stack. One that divides is in screen space with all that it pushes.
///
/// ```
/// use hwmodel::memory::{RecordBits, RecordKind, RecordProbe};
/// use hwmodel::{Datapath, Format, Memory, Overflow, Word};
///
/// let bits = RecordBits { clip: 100, screen: 60, finest: 40, finest_level: Some(2) };
/// let mut probe = RecordProbe::new(bits);
/// let mut dp = Datapath::new(Format::new(24, 8)?, Overflow::Trap, &mut probe);
/// dp.write(Memory::Stack, 0); // the object
/// dp.begin_record(0, 0);
/// dp.read(Memory::Stack, 0);
/// let _ = dp.divide_step(Word::from_host(1), Word::from_host(3), false); // it changes
/// dp.write(Memory::Stack, 0); // its child, in screen space
/// dp.begin_record(1, 1);
/// dp.read(Memory::Stack, 0);
/// dp.write(Memory::Stack, 0); // a finest voxel
/// assert_eq!((probe.of(RecordKind::Clip).reads, probe.of(RecordKind::Screen).reads), (1, 1));
/// assert_eq!(probe.written_bits(), 100 + 60 + 40);
/// # Ok::<(), hwmodel::FormatError>(())
/// ```
#[derive(Debug, Clone)]
pub struct RecordProbe {
    bits: RecordBits,
    accesses: [Accesses; RecordKind::ALL.len()],
    stack: Vec<RecordKind>,
    child_level: u32,
    in_screen_space: bool,
}

impl RecordProbe {
    /// A probe without records.
    pub fn new(bits: RecordBits) -> Self {
        Self {
            bits,
            accesses: Default::default(),
            stack: Vec::new(),
            child_level: 0,
            in_screen_space: false,
        }
    }

    /// Bits of each kind.
    pub fn bits(&self) -> RecordBits {
        self.bits
    }

    /// Pops and pushes of records of a kind.
    pub fn of(&self, kind: RecordKind) -> Accesses {
        self.accesses[kind as usize]
    }

    /// Bits read, all kinds.
    pub fn read_bits(&self) -> u64 {
        self.sum(|of| of.reads)
    }

    /// Bits written, all kinds.
    pub fn written_bits(&self) -> u64 {
        self.sum(|of| of.writes)
    }

    fn sum(&self, times: fn(&Accesses) -> u64) -> u64 {
        RecordKind::ALL
            .iter()
            .map(|&kind| times(&self.of(kind)) * u64::from(self.bits.of(kind)))
            .sum()
    }
}

/// Deeper addresses are taken as this one.
const MAX_DEPTH: usize = 1 << 20;

impl Probe for RecordProbe {
    #[inline]
    fn op(&mut self, class: OpClass, _: u32, _: StageLevel, _: u32) {
        self.in_screen_space |= class == OpClass::DivideStep;
    }

    #[inline(always)]
    fn op_on(&mut self, _: Operand, class: OpClass, _: u32, _: StageLevel) {
        self.in_screen_space |= class == OpClass::DivideStep;
    }

    fn record(&mut self, _: u64, level: u32) {
        self.child_level = level + 1;
    }

    fn read(&mut self, memory: Memory, address: u64, _: StageLevel) {
        if memory == Memory::Stack {
            let at = usize::try_from(address).unwrap_or(MAX_DEPTH);
            let kind = self.stack.get(at).copied().unwrap_or(RecordKind::Clip);
            self.in_screen_space = kind == RecordKind::Screen;
            self.accesses[kind as usize].reads += 1;
        }
    }

    fn write(&mut self, memory: Memory, address: u64, _: StageLevel) {
        if memory == Memory::Stack {
            let kind = self.bits.kind(self.child_level, self.in_screen_space);
            self.accesses[kind as usize].writes += 1;
            let at = usize::try_from(address).map_or(MAX_DEPTH, |at| at.min(MAX_DEPTH));
            if self.stack.len() <= at {
                self.stack.resize(at + 1, RecordKind::Clip);
            }
            self.stack[at] = kind;
        }
    }
}
