//! What can be seen of the machine at work: one event for each operation and
//! each access to a memory.

use std::panic::Location;

use serde::{Deserialize, Serialize};

use crate::{Format, Signal};

/// The kinds of operation that the datapath has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum OpClass {
    /// Two words added.
    Add,
    /// One word subtracted from another, or negated.
    Sub,
    /// Two words compared, or one word's sign tested against zero.
    Compare,
    /// The smaller or the larger of two words (one comparison, one select).
    MinMax,
    /// One of two words chosen by a bit.
    Select,
    /// A shift by a constant or by a level's number: wires or a small shifter.
    Shift,
    /// And, or, exclusive or, not.
    Logic,
    /// One step of the restoring divide: a trial subtraction and a select.
    DivideStep,
}

impl OpClass {
    /// All classes, in the order of their discriminants.
    pub const ALL: [Self; 8] = [
        Self::Add,
        Self::Sub,
        Self::Compare,
        Self::MinMax,
        Self::Select,
        Self::Shift,
        Self::Logic,
        Self::DivideStep,
    ];

    /// The class in words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Add => "add",
            Self::Sub => "subtract",
            Self::Compare => "compare",
            Self::MinMax => "min/max",
            Self::Select => "select",
            Self::Shift => "shift",
            Self::Logic => "logic",
            Self::DivideStep => "divide step",
        }
    }
}

/// The stages of the record loop, in the order in which a record meets them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum Stage {
    /// A record is taken from the stack.
    Pop,
    /// Is the record's quadtree node full by now?
    Filled,
    /// Does the voxel map to one pixel?
    OnePixel,
    /// The centre of the voxel in object space.
    Centre,
    /// Octant bits and the order of the children.
    Order,
    /// The vertices that the children share.
    VertexPool,
    /// A child's box in the image.
    ChildBox,
    /// The smallest unfilled quadtree node that holds the box.
    QuadtreeFit,
    /// A record is put on the stack.
    Push,
    /// A pixel is drawn, or a leaf's pixels are.
    Draw,
    /// Fill vectors are updated towards the root.
    FillUpdate,
    /// A cage changes from clip space to screen space.
    ToScreen,
    /// A voxel that is not opaque is added to what a pixel has so far.
    Blend,
}

impl Stage {
    /// All stages, in the order of their discriminants.
    pub const ALL: [Self; 13] = [
        Self::Pop,
        Self::Filled,
        Self::OnePixel,
        Self::Centre,
        Self::Order,
        Self::VertexPool,
        Self::ChildBox,
        Self::QuadtreeFit,
        Self::Push,
        Self::Draw,
        Self::FillUpdate,
        Self::ToScreen,
        Self::Blend,
    ];

    /// The stage in words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pop => "pop",
            Self::Filled => "filled?",
            Self::OnePixel => "one pixel?",
            Self::Centre => "centre",
            Self::Order => "octant and order",
            Self::VertexPool => "vertex pool",
            Self::ChildBox => "child box",
            Self::QuadtreeFit => "quadtree fit",
            Self::Push => "push",
            Self::Draw => "draw",
            Self::FillUpdate => "fill update",
            Self::ToScreen => "to screen",
            Self::Blend => "blend",
        }
    }
}

/// The memories that the machine reads and writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum Memory {
    /// The record stack; the address is the depth.
    Stack,
    /// Graph nodes; the address is the node.
    Node,
    /// Colours and normals of nodes; the address is the node.
    Attribute,
    /// Fill vectors; the address is the quadtree node.
    FillVector,
    /// Pixels; the address is `y * width + x`.
    Pixel,
    /// What pixels have so far, where voxels are blended; addresses as of pixels.
    Accumulator,
}

impl Memory {
    /// All memories, in the order of their discriminants.
    pub const ALL: [Self; 6] = [
        Self::Stack,
        Self::Node,
        Self::Attribute,
        Self::FillVector,
        Self::Pixel,
        Self::Accumulator,
    ];

    /// The memory in words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stack => "stack",
            Self::Node => "node",
            Self::Attribute => "attribute",
            Self::FillVector => "fill vector",
            Self::Pixel => "pixel",
            Self::Accumulator => "accumulator",
        }
    }
}

/// Where an operation happens: the stage and the octree level of the record.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct StageLevel {
    /// Stage of the record loop.
    pub stage: Stage,
    /// Octree level of the record that is worked on, 0 = root.
    pub level: u32,
}

/// What an operation works on, as far as the calling line determines it. The
/// datapath's format has the widths that go with it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Operand {
    /// A word.
    Word,
    /// A word with the carry, one bit more.
    Carry,
    /// A wide word.
    Wide,
    /// A wide word with the carry.
    WideCarry,
    /// A short vector, of a number of bits that is written down.
    Short,
    /// Anything else.
    Other,
}

/// Sees every operation and every memory access.
///
/// All methods do nothing by default, and [`Probe::ENABLED`] lets the
/// datapath leave the calls out altogether.
pub trait Probe {
    /// Whether the probe does anything.
    const ENABLED: bool = true;

    /// Whether the probe takes the borders of blocks. Separate from
    /// [`Probe::ENABLED`], so that counting operations alone costs no more.
    const TAPS: bool = false;

    /// A datapath of this format is built around the probe.
    #[inline]
    fn begin(&mut self, format: Format) {
        let _ = format;
    }

    /// `times` operations of one class on words of `bits` bits were executed.
    #[inline]
    fn op(&mut self, class: OpClass, bits: u32, place: StageLevel, times: u32) {
        let _ = (class, bits, place, times);
    }

    /// One operation on an operand of a kind that is known when the program is
    /// compiled: what the datapath calls. `bits` follows from the kind and the
    /// format, or is a number that is written down.
    ///
    /// A probe that is faster for knowing the kind has a method of its own;
    /// for all others it is [`Probe::op`], once.
    #[inline]
    fn op_on(&mut self, operand: Operand, class: OpClass, bits: u32, place: StageLevel) {
        let _ = operand;
        self.op(class, bits, place, 1);
    }

    /// A word of `bits` bits was shifted by `places`, on a line of the machine.
    /// The same shift is an operation too: this adds by how much.
    #[inline]
    fn shift(
        &mut self,
        bits: u32,
        places: u32,
        place: StageLevel,
        site: &'static Location<'static>,
    ) {
        let _ = (bits, places, place, site);
    }

    /// A memory was read.
    #[inline]
    fn read(&mut self, memory: Memory, address: u64, place: StageLevel) {
        let _ = (memory, address, place);
    }

    /// A memory was written.
    #[inline]
    fn write(&mut self, memory: Memory, address: u64, place: StageLevel) {
        let _ = (memory, address, place);
    }

    /// What follows needs what is done: a state machine does it in another cycle, after `idle` cycles in which
    /// it does what the record loop does without operations (it keeps boxes that hardware makes anew).
    #[inline]
    fn next_step(&mut self, idle: u32, place: StageLevel) {
        let _ = (idle, place);
    }

    /// What follows, or no longer follows, is work of another stage that needs nothing of the stage before and is not
    /// needed in it: a state machine does it in the same cycles.
    #[inline]
    fn beside(&mut self, begins: bool) {
        let _ = begins;
    }

    /// A record begins its turn; `index` counts the records of a frame.
    #[inline]
    fn record(&mut self, index: u64, level: u32) {
        let _ = (index, level);
    }

    /// Whether [`Probe::tap`] should be called now; used only where `TAPS` is set.
    #[inline]
    fn is_tapping(&self) -> bool {
        Self::TAPS
    }

    /// A block had `stimulus` on its inputs and gave `expected`. What block
    /// `block` is, is between the machine and its probe.
    #[inline]
    fn tap(&mut self, block: u32, stimulus: &[Signal], expected: &[Signal]) {
        let _ = (block, stimulus, expected);
    }
}

/// No probe: every call vanishes at compile time.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoProbe;

impl Probe for NoProbe {
    const ENABLED: bool = false;
}

impl<P: Probe> Probe for &mut P {
    const ENABLED: bool = P::ENABLED;
    const TAPS: bool = P::TAPS;

    #[inline]
    fn begin(&mut self, format: Format) {
        (**self).begin(format);
    }

    #[inline]
    fn op_on(&mut self, operand: Operand, class: OpClass, bits: u32, place: StageLevel) {
        (**self).op_on(operand, class, bits, place);
    }

    #[inline]
    fn op(&mut self, class: OpClass, bits: u32, place: StageLevel, times: u32) {
        (**self).op(class, bits, place, times);
    }

    #[inline]
    fn shift(
        &mut self,
        bits: u32,
        places: u32,
        place: StageLevel,
        site: &'static Location<'static>,
    ) {
        (**self).shift(bits, places, place, site);
    }

    #[inline]
    fn read(&mut self, memory: Memory, address: u64, place: StageLevel) {
        (**self).read(memory, address, place);
    }

    #[inline]
    fn write(&mut self, memory: Memory, address: u64, place: StageLevel) {
        (**self).write(memory, address, place);
    }

    #[inline]
    fn next_step(&mut self, idle: u32, place: StageLevel) {
        (**self).next_step(idle, place);
    }

    #[inline]
    fn beside(&mut self, begins: bool) {
        (**self).beside(begins);
    }

    #[inline]
    fn record(&mut self, index: u64, level: u32) {
        (**self).record(index, level);
    }

    #[inline]
    fn is_tapping(&self) -> bool {
        (**self).is_tapping()
    }

    #[inline]
    fn tap(&mut self, block: u32, stimulus: &[Signal], expected: &[Signal]) {
        (**self).tap(block, stimulus, expected);
    }
}

/// Two probes that see the same; tuples nest for more.
impl<A: Probe, B: Probe> Probe for (A, B) {
    const ENABLED: bool = A::ENABLED || B::ENABLED;
    const TAPS: bool = A::TAPS || B::TAPS;

    #[inline]
    fn begin(&mut self, format: Format) {
        self.0.begin(format);
        self.1.begin(format);
    }

    #[inline]
    fn op_on(&mut self, operand: Operand, class: OpClass, bits: u32, place: StageLevel) {
        if A::ENABLED {
            self.0.op_on(operand, class, bits, place);
        }
        if B::ENABLED {
            self.1.op_on(operand, class, bits, place);
        }
    }

    #[inline]
    fn op(&mut self, class: OpClass, bits: u32, place: StageLevel, times: u32) {
        if A::ENABLED {
            self.0.op(class, bits, place, times);
        }
        if B::ENABLED {
            self.1.op(class, bits, place, times);
        }
    }

    #[inline]
    fn shift(
        &mut self,
        bits: u32,
        places: u32,
        place: StageLevel,
        site: &'static Location<'static>,
    ) {
        if A::ENABLED {
            self.0.shift(bits, places, place, site);
        }
        if B::ENABLED {
            self.1.shift(bits, places, place, site);
        }
    }

    #[inline]
    fn read(&mut self, memory: Memory, address: u64, place: StageLevel) {
        if A::ENABLED {
            self.0.read(memory, address, place);
        }
        if B::ENABLED {
            self.1.read(memory, address, place);
        }
    }

    #[inline]
    fn write(&mut self, memory: Memory, address: u64, place: StageLevel) {
        if A::ENABLED {
            self.0.write(memory, address, place);
        }
        if B::ENABLED {
            self.1.write(memory, address, place);
        }
    }

    #[inline]
    fn next_step(&mut self, idle: u32, place: StageLevel) {
        self.0.next_step(idle, place);
        self.1.next_step(idle, place);
    }

    #[inline]
    fn beside(&mut self, begins: bool) {
        self.0.beside(begins);
        self.1.beside(begins);
    }

    #[inline]
    fn record(&mut self, index: u64, level: u32) {
        if A::ENABLED {
            self.0.record(index, level);
        }
        if B::ENABLED {
            self.1.record(index, level);
        }
    }

    #[inline]
    fn is_tapping(&self) -> bool {
        self.0.is_tapping() || self.1.is_tapping()
    }

    #[inline]
    fn tap(&mut self, block: u32, stimulus: &[Signal], expected: &[Signal]) {
        if A::TAPS && self.0.is_tapping() {
            self.0.tap(block, stimulus, expected);
        }
        if B::TAPS && self.1.is_tapping() {
            self.1.tap(block, stimulus, expected);
        }
    }
}
