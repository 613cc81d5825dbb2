//! Windows: rectangles of samples, and their bits in tiles and blocks.

pub(super) const TILE_LOG2: u32 = 3;
pub(super) const BLOCK_LOG2: u32 = 6;
pub(super) const ALL: u64 = u64::MAX;
pub(super) const LEFT_COLUMN: u64 = 0x0101_0101_0101_0101;

pub(super) const WINDOW_MARGIN: f32 = 1.0 / 512.0;
pub(super) const BEYOND: f64 = 40_000.0;

#[inline(always)]
pub(super) fn bits(mask: u64) -> impl Iterator<Item = usize> {
    let mut left = mask;
    std::iter::from_fn(move || {
        let bit = left.trailing_zeros() as usize;
        left &= left.wrapping_sub(1);
        (bit < 64).then_some(bit)
    })
}

/// Samples from `left` to `right` and `top` to `bottom`, all included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Window {
    pub(super) left: i32,
    pub(super) top: i32,
    pub(super) right: i32,
    pub(super) bottom: i32,
}

impl Window {
    #[inline(always)]
    pub(super) fn of([left, top, right, bottom]: [i32; 4]) -> Self {
        Self {
            left,
            top,
            right,
            bottom,
        }
    }

    #[inline(always)]
    pub(super) fn is_empty(&self) -> bool {
        self.left > self.right || self.top > self.bottom
    }

    #[inline(always)]
    pub(super) fn and(&self, other: &Self) -> Self {
        Self {
            left: self.left.max(other.left),
            top: self.top.max(other.top),
            right: self.right.min(other.right),
            bottom: self.bottom.min(other.bottom),
        }
    }

    /// The bits of a tile or block, whose first bit is at `x`, `y`, in the window.
    #[inline(always)]
    pub(super) fn bits(&self, x: i32, y: i32) -> u64 {
        let left = (self.left - x).max(0) as u32;
        let right = (self.right - x).min(7) as u32;
        let top = (self.top - y).max(0) as u32;
        let bottom = (self.bottom - y).min(7) as u32;
        let row = ((0xffu64 << left) & 0xff) & (0xff >> (7 - right));
        let rows = (ALL << (8 * top)) & (ALL >> (8 * (7 - bottom)));
        row.wrapping_mul(LEFT_COLUMN) & rows
    }

    /// The window in units `2^places` times as large.
    #[inline(always)]
    pub(super) fn coarser(&self, places: u32) -> Self {
        Self {
            left: self.left >> places,
            top: self.top >> places,
            right: self.right >> places,
            bottom: self.bottom >> places,
        }
    }
}
