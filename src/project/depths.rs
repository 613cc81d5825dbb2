//! The depths from which on a record may change to screen space, or be taken
//! for a solid: constants of a level, made by the host.
//!
//! Both follow from how far an affine map of a voxel deviates from its
//! projection, and how large the projection is; see `SPEC.md`, "The change to
//! screen space" and "Drawing rules". Everything scales: at twice the depth a
//! voxel of twice the side looks the same, so one ratio of side to depth
//! serves all levels.

use glam::DVec3;

use super::setup::{Coverage, SCREEN_GUARD_SHIFT};

/// Bits of a strip's normal (`SPEC.md`, "Strips").
pub const STRIP_NORMAL_BITS: u32 = 11;

/// Points along each axis at which the deviation is looked at, ends included.
const DEVIATION_POINTS: i32 = 9;

/// Steps towards the depth at which a deviation is just allowed.
const BISECTIONS: u32 = 40;

/// Clip vectors of a finest voxel's edges, and the picture they are seen in.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edges {
    /// X and Y in units of the image root times depth, W in voxels.
    pub(super) edge: [DVec3; 3],
    /// Samples a side of the image root.
    pub(super) root_samples: f64,
}

impl Edges {
    /// How fast a picture position at `x` (0 to 1 across the image root)
    /// moves along each edge, times the depth, in samples.
    fn speed(&self, axis: usize, x: f64) -> [f64; 3] {
        self.edge.map(|e| (e[axis] - x * e.z) * self.root_samples)
    }

    /// The two ends of the range of positions that may change: linear and
    /// convex functions of the position are greatest there.
    fn ends() -> [f64; 2] {
        let guard = 1.0 / f64::from(1u32 << SCREEN_GUARD_SHIFT);
        [-guard, 1.0 + guard]
    }

    /// Sum over the edges of how fast they move a point, the greater of both
    /// axes and ends.
    fn total_speed(&self) -> f64 {
        let mut most: f64 = 0.0;
        for axis in 0..2 {
            let mut sum = 0.0;
            for k in 0..3 {
                let here = Self::ends().map(|x| self.speed(axis, x)[k].abs());
                sum += here[0].max(here[1]);
            }
            most = most.max(sum);
        }
        most
    }

    /// Depth that a finest voxel spans.
    fn depth_span(&self) -> f64 {
        self.edge.iter().map(|e| e.z.abs()).sum()
    }

    /// Least depth, in voxels, for a voxel of side 1 that a level of detail of
    /// at most `limit` samples takes for a solid.
    pub(super) fn detail_depth(&self, limit: f64) -> f64 {
        self.total_speed() / limit
    }

    /// Least depth, in voxels, at which a voxel of side 1 may change to
    /// screen space with a deviation of at most `allowed` samples.
    pub(super) fn screen_depth(&self, coverage: Coverage, allowed: f64) -> f64 {
        if coverage.draws_outlines() {
            return self.central_depth(allowed);
        }
        libm::sqrt(self.total_speed() * self.depth_span() / allowed)
    }

    /// The same for the map through the mean of the eight vertices.
    ///
    /// With `D` the speeds, `E` the depths that the edges span and `d` a point
    /// of the voxel (-1/2 to 1/2), the projection is affine but for
    /// `-(D d)(E d) / W^2 * (1 + at most sum|E| / 2W)`. The fit takes away
    /// the mean of the first part over the vertices, where `d_k^2 = 1/4`; it
    /// makes the second part at most five times as large.
    fn central_depth(&self, allowed: f64) -> f64 {
        let mut second_order: f64 = 0.0;
        for axis in 0..2 {
            for x in Self::ends() {
                second_order = second_order.max(self.greatest_bend(&self.speed(axis, x)));
            }
        }
        let span = self.depth_span();
        let third_order = 5.0 * (self.total_speed() * span / 4.0) * (span / 2.0);
        let excess = |depth: f64| (second_order + third_order / depth) / (depth * depth) - allowed;
        let mut below = libm::sqrt(second_order / allowed);
        let mut above = below + libm::cbrt(third_order / allowed);
        for _ in 0..BISECTIONS {
            let middle = (below + above) / 2.0;
            if middle > 0.0 && excess(middle) <= 0.0 {
                above = middle;
            } else {
                below = middle;
            }
        }
        above
    }

    /// The most of `|(D d)(E d) - mean over the vertices|` in a voxel.
    fn greatest_bend(&self, speed: &[f64; 3]) -> f64 {
        let product = |j: usize, k: usize| speed[j] * self.edge[k].z;
        let at = |i: i32| f64::from(i) / f64::from(DEVIATION_POINTS - 1) - 0.5;
        let mut most: f64 = 0.0;
        for i in 0..DEVIATION_POINTS {
            for j in 0..DEVIATION_POINTS {
                for k in 0..DEVIATION_POINTS {
                    let d = [at(i), at(j), at(k)];
                    let mut bend = 0.0;
                    for a in 0..3 {
                        bend += product(a, a) * (d[a] * d[a] - 0.25);
                        for b in 0..a {
                            bend += (product(a, b) + product(b, a)) * d[a] * d[b];
                        }
                    }
                    most = most.max(bend.abs());
                }
            }
        }
        // Between two points a square is at most a quarter of their distance
        // squared away from the line through them.
        let step = 1.0 / f64::from(DEVIATION_POINTS - 1);
        let between: f64 = (0..3).map(|k| product(k, k).abs()).sum::<f64>() * step * step / 4.0;
        most + between
    }
}

/// Rounding of a strip, in its units: its place by less than one, each half
/// edge by half a unit at its end, up to four units where the voxel's finest
/// parts are two levels below or more.
const STRIP_ROUNDING_UNITS: f64 = 7.0;

/// Most of a sample by which rounding moves an outline in screen space.
/// `guard` is the fraction bits of strips beyond those that their levels need.
pub(super) fn rounding(coverage: Coverage, screen_frac: u32, guard: u32) -> f64 {
    // Quotients are rounded down: a corner and three edges, one unit each.
    let quotients = 4.0 * libm::ldexp(1.0, -(screen_frac as i32));
    if !coverage.draws_outlines() {
        return quotients;
    }
    // A normal is at least half of 2^bits long.
    let unit = libm::ldexp(1.0, -((STRIP_NORMAL_BITS - 1 + guard) as i32));
    quotients + STRIP_ROUNDING_UNITS * unit
}

/// Fraction bits that strips get so that their rounding is an eighth of the
/// tolerance at most.
pub(super) fn strip_guard(tolerance_px: f64) -> u32 {
    if tolerance_px == 0.0 || tolerance_px.is_infinite() {
        return 0;
    }
    let unit = libm::ldexp(1.0, -((STRIP_NORMAL_BITS - 1) as i32));
    let ratio = STRIP_ROUNDING_UNITS * unit / (tolerance_px / 8.0);
    (libm::ceil(libm::log2(ratio)).max(0.0) as u32).min(MAX_STRIP_GUARD)
}

/// By how much outlines in screen space are drawn wider, so that nothing
/// falls between neighbours that changed apart: `2^-slack` of what a step of
/// a sample along both axes adds: an eighth of the tolerance, rounded up to a
/// power of two, and no more than a sample. `None`: not at all.
pub(super) fn strip_slack(tolerance_px: f64) -> Option<u32> {
    let is_approximate = tolerance_px > 0.0 && tolerance_px.is_finite();
    is_approximate.then(|| {
        let places = libm::floor(3.0 - libm::log2(tolerance_px));
        (places.max(0.0) as u32).min(MAX_STRIP_SLACK)
    })
}

/// Beyond this the tolerance is below what screen positions hold.
const MAX_STRIP_SLACK: u32 = 32;

/// Beyond this many, the tolerance is below what screen positions hold.
const MAX_STRIP_GUARD: u32 = 16;
