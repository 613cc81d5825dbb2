//! Words, datapath and counters of hardware with adders, shifts, logic and compares, but no multiplier, divider or
//! floating point.
//!
//! The lowest crate of `shiftvox`. It knows voxels only as *record*, *stage* and *level*. Every operation is a call on
//! a [`Datapath`] and is reported to a [`Probe`]. The [`Overflow`] policy handles results that do not fit:
//!
//! ```
//! use hwmodel::count::Counter;
//! use hwmodel::{Datapath, Format, OpClass, Overflow, Stage};
//!
//! // 24-bit words, 8 bits of them fraction.
//! let format = Format::new(24, 8)?;
//! let mut dp = Datapath::new(format, Overflow::Trap, Counter::new());
//! dp.begin_record(0, 3); // record 0, a voxel of octree level 3
//! dp.stage(Stage::VertexPool);
//!
//! let left = dp.load(5 << 8); // 5.0
//! let right = dp.load(-(2 << 8)); // -2.0
//! let middle = dp.midpoint(left, right); // (5 - 2) / 2, by add and shift
//! assert_eq!(middle.to_host(), 3 << 7);
//! assert_eq!(dp.trap(), None);
//!
//! // 5 * 2^13 is more than the 15 bits left of the point can hold.
//! dp.shl(left, 13);
//! let trap = dp.trap().expect("an overflow");
//! assert_eq!(
//!     trap.to_string(),
//!     "a word of 24 bits overflowed in shift left \
//!      (stage vertex pool, octree level 3, record 0)"
//! );
//!
//! let counter = dp.into_probe();
//! assert_eq!(counter.ops_at(Stage::VertexPool, OpClass::Add), 1);
//! assert_eq!(counter.ops_of(OpClass::Shift), 2);
//! assert_eq!(counter.widest(), 25); // a midpoint's sum has one bit more
//! # Ok::<(), hwmodel::FormatError>(())
//! ```

#![forbid(unsafe_code)]
/// Defines an enum whose variants have names in words.
#[doc(hidden)]
#[macro_export]
macro_rules! named {
    ($(#[$meta:meta])* pub enum $type:ident { $($(#[$doc:meta])* $variant:ident = $name:literal,)+ }) => {
        $(#[$meta])*
        pub enum $type { $($(#[$doc])* $variant,)+ }

        impl $type {
            /// All values, in the order of their discriminants.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$variant),+];

            /// The name in words.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)+ }
            }
        }
    };
}

pub mod cost;
pub mod count;
pub mod cycles;
mod datapath;
mod format;
mod hash;
pub mod memory;
mod narrow;
pub mod probe;
pub mod shifts;
pub mod tap;
mod trap;
mod word;

pub use datapath::Datapath;
pub use format::{Format, FormatError, MAX_BITS, MIN_BITS, Overflow};
pub use probe::{Memory, NoProbe, OpClass, Operand, Probe, Stage, StageLevel};
pub use tap::{Short, Signal, SignalKind, Wires};
pub use trap::{Trap, TrapOp};
pub use word::{Narrow, Number, WideWord, Word};
