//! Edge functions, which decide exactly whether a triangle covers a sample.
//!
//! For an edge from `a` to `b` and a sample `p`, all in 1/4096 pixel,
//! `(b - a) x (p - a)` is positive on the inner side. Coordinates are within
//! 2^29 steps, so products are below 2^60 and their difference below 2^61.
//! A sample on an edge counts for a top or a left edge only.

use super::samples::{SUBPIXEL_BITS, SUBPIXELS};

/// One edge: its function is `at + right * x + down * y` in steps from a pixel's corner.
#[derive(Debug, Clone, Copy)]
struct Edge {
    /// At step (0, 0), less 1 for an edge that excludes its own points.
    at: i64,
    right: i64,
    down: i64,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Edges([Edge; 3]);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cover {
    Nothing,
    Part,
    All,
}

impl Edges {
    pub(crate) fn new(points: [[i64; 2]; 3]) -> Option<Self> {
        let [a, b, c] = points;
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let turned = match area {
            0 => return None,
            1.. => [a, b, c],
            _ => [a, c, b],
        };
        Some(Self([0, 1, 2].map(|i| {
            let (from, to) = (turned[i], turned[(i + 1) % 3]);
            let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
            // y grows downwards: the inner side of an upward edge is to its right.
            let is_top_left = dy < 0 || dy == 0 && dx > 0;
            Edge {
                at: dy * from[0] - dx * from[1] - i64::from(!is_top_left),
                right: -dy,
                down: dx,
            }
        })))
    }

    #[inline]
    pub(super) fn seen_from(&self, pixel: [i64; 2]) -> Self {
        Self(self.0.map(|edge| Edge {
            at: edge.at + ((edge.right * pixel[0] + edge.down * pixel[1]) << SUBPIXEL_BITS),
            ..edge
        }))
    }

    #[inline]
    pub(super) fn cover(&self) -> Cover {
        let mut all = true;
        for edge in &self.0 {
            let (right, down) = (edge.right * SUBPIXELS, edge.down * SUBPIXELS);
            if edge.at + right.max(0) + down.max(0) < 0 {
                return Cover::Nothing;
            }
            all &= edge.at + right.min(0) + down.min(0) >= 0;
        }
        if all { Cover::All } else { Cover::Part }
    }

    #[inline]
    pub(crate) fn covers(&self, [x, y]: [i64; 2]) -> bool {
        self.0
            .iter()
            .all(|edge| edge.at + edge.right * x + edge.down * y >= 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_triangles_fit() {
        let most = 80_000 * SUBPIXELS;
        let edges = Edges::new([[-most, -most], [most, -most], [most, most]]).unwrap();
        assert!(edges.seen_from([32767, 0]).covers([0, 0]));
        assert!(!edges.seen_from([0, 32767]).covers([0, 0]));
    }
}
