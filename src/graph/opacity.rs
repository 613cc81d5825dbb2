//! Opacity of a voxel from each of six sides (`spec/graph.md`, "Opacities").

/// Opacity of a voxel along the six main directions, 0 (transparent) to 15 (opaque), four bits each.
///
/// Byte `k` is for axis `k`: the low half seen from the side of low coordinates, the high half from the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct Opacity(pub [u8; 3]);

pub const MOST_OPACITY: u8 = 15;

impl Opacity {
    pub const OPAQUE: Self = Self([0xff; 3]);

    pub fn new(sides: [[u8; 2]; 3]) -> Self {
        Self(sides.map(|[low, high]| low.min(MOST_OPACITY) | high.min(MOST_OPACITY) << 4))
    }

    /// Opacity along axis `k`, seen from the side of high coordinates or from the other.
    #[inline(always)]
    pub fn from_side(self, k: usize, high: bool) -> u8 {
        self.0[k] >> if high { 4 } else { 0 } & MOST_OPACITY
    }
}

impl Default for Opacity {
    fn default() -> Self {
        Self::OPAQUE
    }
}

/// Sixteenths of its outline that a voxel of this opacity covers, 0 to 16.
#[inline(always)]
pub const fn sixteenths(opacity: u8) -> u8 {
    opacity + (opacity >> 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_sides_are_kept_apart_and_the_most_is_all() {
        let opacity = Opacity::new([[1, 2], [3, 4], [5, 200]]);
        let sides = [0, 1, 2].map(|k| [false, true].map(|high| opacity.from_side(k, high)));
        assert_eq!(sides, [[1, 2], [3, 4], [5, 15]]);
        let all: Vec<u8> = (0..=MOST_OPACITY).map(sixteenths).collect();
        assert_eq!(all, [0, 1, 2, 3, 4, 5, 6, 7, 9, 10, 11, 12, 13, 14, 15, 16]);
    }
}
