//! Settings of the machine.

use hwmodel::Overflow;
use hwmodel::cycles::Organisation;

use crate::project::OCCLUSION_ORDER;

/// Settings of the machine that are not part of a frame set-up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MachineOptions {
    /// Treatment of a result that does not fit its word.
    pub overflow: Overflow,
    /// Whether records whose quadrants are all full are rejected; does not change the picture.
    pub reject_filled: bool,
    /// Children by octant, nearest first, for octant 000; only tests use another array than [`OCCLUSION_ORDER`].
    pub order: [u8; 8],
    /// Organisation of stack, nodes and tiles; changes a frame's records and accesses, but not its picture.
    pub organisation: Organisation,
}

impl Default for MachineOptions {
    fn default() -> Self {
        Self {
            overflow: Overflow::Trap,
            reject_filled: true,
            order: OCCLUSION_ORDER,
            organisation: Organisation::default(),
        }
    }
}
