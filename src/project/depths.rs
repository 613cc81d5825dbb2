//! The depths from which on a record may change to screen space, or be taken
//! for a solid: constants of a level, made by the host.
//!
//! Both follow from how far an affine map of a voxel deviates from its
//! projection, and how large the projection is; see `SPEC.md`, "The change to
//! screen space" and "Drawing rules". Everything scales: at twice the depth a
//! voxel of twice the side looks the same, so one ratio of side to depth
//! serves all levels.

use super::host::{Host, Real};
use super::setup::SCREEN_GUARD_SHIFT;

/// Bits of a strip's normal: the fast engine's lattices, which find what is then decided exactly.
pub const STRIP_NORMAL_BITS: u32 = 11;

/// Points along each axis at which the deviation is looked at, ends included.
const DEVIATION_POINTS: i32 = 9;

/// Steps towards the depth at which a deviation is just allowed.
const BISECTIONS: u32 = 40;

/// Clip vectors of a finest voxel's edges, and the picture they are seen in.
pub(super) struct Edges<H> {
    /// X and Y in units of the image root times depth, W in voxels.
    pub(super) edge: [[Real<H>; 3]; 3],
    /// Samples a side of the image root.
    pub(super) root_samples: Real<H>,
    /// Is told of all steps.
    pub(super) by: H,
}

/// Where W is in a clip vector.
const W: usize = 2;

impl<H: Host> Edges<H> {
    /// How fast a picture position at `x` (0 to 1 across the image root)
    /// moves along each edge, times the depth, in samples.
    fn speed(&self, axis: usize, x: Real<H>) -> [Real<H>; 3] {
        self.edge.map(|e| (e[axis] - x * e[W]) * self.root_samples)
    }

    /// The two ends of the range of positions that may change: linear and
    /// convex functions of the position are greatest there.
    fn ends(&self) -> [Real<H>; 2] {
        let guard = self.by.lift(1.0).scaled(-(SCREEN_GUARD_SHIFT as i32));
        [-guard, guard + 1.0]
    }

    /// Sum over the edges of how fast they move a point, the greater of both
    /// axes and ends.
    fn total_speed(&self) -> Real<H> {
        let ends = self.ends();
        let mut most = self.by.lift(0.0);
        for axis in 0..2 {
            let [low, high] = ends.map(|x| self.speed(axis, x).map(Real::abs));
            let [x, y, z] = [0, 1, 2].map(|k| low[k].max(high[k]));
            most = most.max(x + y + z);
        }
        most
    }

    /// Depth that a finest voxel spans.
    fn depth_span(&self) -> Real<H> {
        let [x, y, z] = self.edge.map(|e| e[W].abs());
        x + y + z
    }

    /// Least depth, in voxels, for a voxel of side 1 that a level of detail of
    /// at most `limit` samples takes for a solid.
    pub(super) fn detail_depth(&self, limit: Real<H>) -> Real<H> {
        self.total_speed() / limit
    }

    /// Least depth, in voxels, at which a voxel of side 1 may change to
    /// screen space with a deviation of at most `allowed` samples.
    pub(super) fn screen_depth(&self, allowed: Real<H>) -> Real<H> {
        (self.total_speed() * self.depth_span() / allowed).sqrt()
    }

    /// The same for the map through the mean of the eight vertices.
    ///
    /// With `D` the speeds, `E` the depths that the edges span and `d` a point
    /// of the voxel (-1/2 to 1/2), the projection is affine but for
    /// `-(D d)(E d) / W^2 * (1 + at most sum|E| / 2W)`. The fit takes away
    /// the mean of the first part over the vertices, where `d_k^2 = 1/4`; it
    /// makes the second part at most five times as large.
    pub(super) fn central_depth(&self, allowed: Real<H>) -> Real<H> {
        let mut second_order = self.by.lift(0.0);
        for axis in 0..2 {
            for x in self.ends() {
                second_order = second_order.max(self.greatest_bend(&self.speed(axis, x)));
            }
        }
        let span = self.depth_span();
        let third_order = self.total_speed() * span / 4.0 * 5.0 * (span / 2.0);
        let excess =
            |depth: Real<H>| (second_order + third_order / depth) / (depth * depth) - allowed;
        let mut below = (second_order / allowed).sqrt();
        let mut above = below + (third_order / allowed).cbrt();
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
    fn greatest_bend(&self, speed: &[Real<H>; 3]) -> Real<H> {
        let product = [0, 1, 2].map(|j| [0, 1, 2].map(|k| speed[j] * self.edge[k][W]));
        let step = self.by.lift(1.0) / f64::from(DEVIATION_POINTS - 1);
        let at: [Real<H>; DEVIATION_POINTS as usize] = std::array::from_fn(|i| {
            self.by.lift(i as u64).to_real() / f64::from(DEVIATION_POINTS - 1) - 0.5
        });
        let mut most = self.by.lift(0.0);
        for x in at {
            for y in at {
                for z in at {
                    let d = [x, y, z];
                    let mut bend = self.by.lift(0.0);
                    for a in 0..3 {
                        bend += product[a][a] * (d[a] * d[a] - 0.25);
                        for b in 0..a {
                            bend += (product[a][b] + product[b][a]) * d[a] * d[b];
                        }
                    }
                    most = most.max(bend.abs());
                }
            }
        }
        // Between two points a square is at most a quarter of their distance
        // squared away from the line through them.
        let [x, y, z] = [0, 1, 2].map(|k| product[k][k].abs());
        let between = (x + y + z) * step * step / 4.0;
        most + between
    }
}

/// `2^exponent`.
fn power<H: Host>(by: H, exponent: i32) -> Real<H> {
    by.lift(1.0).scaled(exponent)
}

/// Most of a sample by which rounding moves a vertex in screen space: quotients
/// are rounded down, a corner and three edges, one unit each.
pub(super) fn rounding<H: Host>(by: H, screen_frac: u32) -> Real<H> {
    power(by, -(screen_frac as i32)) * 4.0
}

/// Rounding of a strip, in its units: its place by less than one, each half
/// edge by half a unit at its end, up to four units where the voxel's finest
/// parts are two levels below or more.
const STRIP_ROUNDING_UNITS: f64 = 7.0;

/// Most of a sample by which rounding moves an outline made of strips.
pub(super) fn lattice_rounding<H: Host>(by: H, screen_frac: u32) -> Real<H> {
    // A normal is at least half of 2^bits long.
    let unit = power(by, -((STRIP_NORMAL_BITS - 1) as i32));
    rounding(by, screen_frac) + unit * STRIP_ROUNDING_UNITS
}
