//! The first overflow of a frame.

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
#[expect(missing_docs, reason = "names of the other fields say what they are")]
pub struct Trap {
    pub op: TrapOp,
    pub place: StageLevel,
    /// Number of the record within the frame, from 0.
    pub record: u64,
    /// Width of the word.
    pub bits: u32,
}
