//! Overflow of a word, which ends a frame under [`Overflow::Trap`](crate::Overflow::Trap).

use crate::StageLevel;

named! {
    /// The operation that overflowed.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum TrapOp {
        Add = "add",
        Sub = "subtract",
        ShiftLeft = "shift left",
        Load = "load of a frame constant",
    }
}

/// The first overflow of a frame under [`Overflow::Trap`](crate::Overflow::Trap).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, thiserror::Error)]
#[error(
    "a word of {bits} bits overflowed in {} (stage {}, octree level {}, record {record})",
    op.name(), place.stage.name(), place.level
)]
pub struct Trap {
    /// The operation.
    pub op: TrapOp,
    /// Stage and octree level.
    pub place: StageLevel,
    /// Number of the record within the frame, from 0.
    pub record: u64,
    /// Width of the word, in bits.
    pub bits: u32,
}
