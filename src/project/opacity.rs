//! Constants of a frame that blends (`SPEC.md`, section 11).

use super::FrameSetup;

/// Most bits of a coordinate for directions.
const MOST_BITS: u32 = 24;
/// Bits of a word beyond such a coordinate: sign, the eye's distance, the sum of three, and its double in a divide.
const HEADROOM_BITS: u32 = 5;

pub const SHARES: i64 = 16;
pub const ALL_LEFT: u32 = 256;
/// Transmittance at which a sample is opaque enough: the last voxel takes the rest.
pub const OPAQUE_ENOUGH: u32 = 64;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct OpacityEye {
    pub shift: u32,
    /// The eye in object coordinates, rounded down, shifted.
    pub at: [i64; 3],
}

impl FrameSetup {
    /// The eye, with as many bits as a word has room for.
    pub fn opacity_eye(&self) -> OpacityEye {
        let room = (self.format.bits() - HEADROOM_BITS).min(MOST_BITS);
        let side = 1u64 << self.depth;
        let [x, y, z] = self.eye_floor.map(|c| c.unsigned_abs().max(side));
        let longest = x.max(y).max(z);
        let shift = (u64::BITS - longest.leading_zeros()).saturating_sub(room);
        OpacityEye {
            shift,
            at: self.eye_floor.map(|c| c >> shift),
        }
    }
}
