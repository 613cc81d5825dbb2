//! Settings of the machine that are not part of a frame set-up.

use hwmodel::Overflow;
use hwmodel::cycles::Organisation;

use crate::project::OCCLUSION_ORDER;

/// Settings of the machine that are not part of a frame set-up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MachineOptions {
    /// Treatment of a result that does not fit its word.
    pub overflow: Overflow,
    /// Whether records whose quadrants are all full are rejected. The picture
    /// is the same either way.
    pub reject_filled: bool,
    /// Children by octant, nearest first, for octant 000; only tests use
    /// another array than [`OCCLUSION_ORDER`].
    pub order: [u8; 8],
    /// Contents of the stack, reads for a leaf, and whether the picture is drawn by tiles.
    /// Without the organisation of the image-order paper, only a frame's records and accesses
    /// change, not its picture.
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
