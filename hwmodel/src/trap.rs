//! A word that overflowed, and where: what a frame ends with under [`Overflow::Trap`](crate::Overflow::Trap).

use crate::StageLevel;

/// The operation during which a word overflowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TrapOp {
    /// A sum.
    Add,
    /// A difference or a negation.
    Sub,
    /// A left shift.
    ShiftLeft,
    /// A constant of the frame, handed over by the host.
    Load,
}

impl TrapOp {
    /// The operation in words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Add => "add",
            Self::Sub => "subtract",
            Self::ShiftLeft => "shift left",
            Self::Load => "load of a frame constant",
        }
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
    /// Width of the word that overflowed, in bits.
    pub bits: u32,
}
