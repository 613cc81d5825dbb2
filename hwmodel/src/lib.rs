//! Words, datapath and counters of hardware with adders, shifts, logic and compares, but no multiplier, divider or
//! floating point.
//!
//! Every operation is a call on a [`Datapath`] and is reported to a [`Probe`]. The [`Overflow`] policy handles results
//! that do not fit:
//!
//! ```
//! use hwmodel::count::Counter;
//! use hwmodel::{Datapath, Format, OpClass, Overflow};
//!
//! hwmodel::stages! {
//!     enum Block {
//!         Load = "load",
//!         VertexPool = "vertex pool",
//!     }
//! }
//!
//! let format = Format::new(24, 8)?; // 24-bit words, 8 bits of them fraction
//! let mut dp = Datapath::new(format, Overflow::Trap, Counter::new());
//! dp.begin_record(0, 3); // record 0, a voxel of octree level 3
//! dp.stage(Block::VertexPool);
//! let (left, right) = (dp.load(5 << 8), dp.load(-(2 << 8)));
//! let middle = dp.midpoint(left, right); // (5 - 2) / 2, by add and shift
//! assert_eq!((middle.to_host(), dp.trap()), (3 << 7, None));
//! dp.shl(left, 13); // 5 * 2^13 is more than 15 bits can hold
//! assert_eq!(
//!     dp.trap().map(|trap| trap.to_string()).as_deref(),
//!     Some("a word of 24 bits overflowed in shift left (stage vertex pool, octree level 3, record 0)")
//! );
//! assert_eq!(dp.into_probe().ops_at(Block::VertexPool, OpClass::Shift), 2);
//! # Ok::<(), hwmodel::FormatError>(())
//! ```

#![forbid(unsafe_code)]
/// Defines an enum whose variants have names in words, which are also their documentation.
#[doc(hidden)]
#[macro_export]
macro_rules! named {
    ($(#[$meta:meta])* $visible:vis enum $type:ident { $($(#[$doc:meta])* $variant:ident = $name:literal,)+ }) => {
        $(#[$meta])*
        $visible enum $type {
            $($(#[$doc])* #[doc = ""] #[doc = concat!("`", $name, "`")] $variant,)+
        }

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
pub mod memory;
mod narrow;
pub mod probe;
pub mod shifts;
mod stage;
pub mod tap;
mod trap;
mod word;

pub use datapath::Datapath;
pub use format::{Format, FormatError, MAX_BITS, MIN_BITS, Overflow};
pub use probe::{Memory, NoProbe, OpClass, Operand, Probe, StageLevel};
pub use stage::{MAX_STAGES, Stage};
pub use tap::{Short, Signal, SignalKind, Wires};
pub use trap::{Trap, TrapOp};
pub use word::{Narrow, Number, WideWord, Word};
