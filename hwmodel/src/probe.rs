//! Events of the machine: one per operation and per access to a memory.

use std::panic::Location;

use serde::{Deserialize, Serialize};

use crate::{Format, Signal, Stage};

named! {
    /// Operations of the datapath.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    #[repr(u8)]
    pub enum OpClass {
        Add = "add",
        Sub = "subtract",
        Compare = "compare",
        /// One comparison, one select.
        MinMax = "min/max",
        Select = "select",
        /// A shift: wires or a small shifter.
        Shift = "shift",
        Logic = "logic",
        /// A trial subtraction and a select.
        DivideStep = "divide step",
    }
}

named! {
    /// Memories of the machine.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    #[repr(u8)]
    pub enum Memory {
        /// The record stack; the address is the depth.
        Stack = "stack",
        /// Graph nodes; the address is the node.
        Node = "node",
        /// Colours and normals of nodes; the address is the node.
        Attribute = "attribute",
        /// Fill vectors; the address is the quadtree node.
        FillVector = "fill vector",
        /// Pixels; the address is `y * width + x`.
        Pixel = "pixel",
        /// Partial sums of blended pixels; addresses as of pixels.
        Accumulator = "accumulator",
    }
}

/// The stage and the octree level (0 = root) of an operation's record.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "names of the fields say what they are")]
pub struct StageLevel {
    pub stage: Stage,
    pub level: u32,
}

/// The kind of an operand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "names of the other kinds say what they are")]
pub enum Operand {
    Word,
    /// A word and a carry bit.
    Carry,
    Wide,
    /// A wide word and a carry bit.
    WideCarry,
    /// A constant number of bits.
    Short,
    /// A counter of control logic, which no unit's issue waits for.
    Control,
    Other,
}

/// Defines [`Probe`] and its forwarding implementations from one list of events.
macro_rules! probe {
    ($($(#[$doc:meta])* fn $event:ident($self:ident $(, $argument:ident: $type:ty)*) $default:block)+) => {
        /// Receives the machine's events; does nothing by default.
        pub trait Probe {
            /// Whether the datapath calls it.
            const ENABLED: bool = true;

            /// Whether it takes the borders of blocks.
            const TAPS: bool = false;

            /// Whether [`Probe::tap`] should be called now; used only where `TAPS` is set.
            #[inline]
            fn is_tapping(&self) -> bool {
                Self::TAPS
            }

            $(
                $(#[$doc])*
                #[inline]
                fn $event(&mut $self, $($argument: $type),*) {
                    let _ = ($($argument,)*);
                    $default
                }
            )+
        }

        impl<P: Probe> Probe for &mut P {
            const ENABLED: bool = P::ENABLED;
            const TAPS: bool = P::TAPS;

            #[inline]
            fn is_tapping(&self) -> bool {
                (**self).is_tapping()
            }

            $(
                #[inline]
                fn $event(&mut self, $($argument: $type),*) {
                    (**self).$event($($argument),*);
                }
            )+
        }

        /// Both receive all events.
        impl<A: Probe, B: Probe> Probe for (A, B) {
            const ENABLED: bool = A::ENABLED || B::ENABLED;
            const TAPS: bool = A::TAPS || B::TAPS;

            #[inline]
            fn is_tapping(&self) -> bool {
                self.0.is_tapping() || self.1.is_tapping()
            }

            $(
                #[inline]
                fn $event(&mut self, $($argument: $type),*) {
                    if A::ENABLED {
                        self.0.$event($($argument),*);
                    }
                    if B::ENABLED {
                        self.1.$event($($argument),*);
                    }
                }
            )+
        }
    };
}

probe! {
    /// A datapath of this format is built around the probe.
    fn begin(self, format: Format) {}

    /// The datapath enters a stage.
    fn stage(self, stage: Stage) {}

    /// `times` operations on words of `bits` bits.
    fn op(self, class: OpClass, bits: u32, place: StageLevel, times: u32) {}

    /// One operation on an operand whose kind is known at compile time. By default one [`Probe::op`].
    fn op_on(self, operand: Operand, class: OpClass, bits: u32, place: StageLevel) {
        self.op(class, bits, place, 1);
    }

    /// A line of the machine shifts a word of `bits` bits by `places`; the operation is another event.
    fn shift(self, bits: u32, places: u32, place: StageLevel, site: &'static Location<'static>) {}

    /// A read.
    fn read(self, memory: Memory, address: u64, place: StageLevel) {}

    /// A write.
    fn write(self, memory: Memory, address: u64, place: StageLevel) {}

    /// The following operations need the results so far, after `idle` cycles without operations.
    fn next_step(self, idle: u32, place: StageLevel) {}

    /// Begins or ends independent work of another stage, which a state machine does in the same cycles.
    fn beside(self, begins: bool) {}

    /// A record begins its turn; `index` counts the records of a frame.
    fn record(self, index: u64, level: u32) {}

    /// A block had `stimulus` on its inputs and gave `expected`.
    fn tap(self, block: u32, stimulus: &[Signal], expected: &[Signal]) {}
}

/// No probe: every call vanishes at compile time.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoProbe;

impl Probe for NoProbe {
    const ENABLED: bool = false;
}
