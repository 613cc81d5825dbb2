//! By level, the depths from which a record may change to screen space, or counts as a solid, computed by the host.
//!
//! Both follow from the deviation of an affine map of a voxel from its projection, and the projection's size; see
//! `SPEC.md`, "The change to screen space" and "Drawing rules". At twice the depth a voxel of twice the side looks the
//! same, so one ratio of side to depth serves all levels.

use super::options::SCREEN_GUARD_SHIFT;

/// Clip vectors of a finest voxel's edges, and the size of the picture.
pub(super) struct Edges {
    /// X and Y in units of the image root times depth, W in voxels.
    pub(super) edge: [[f64; 3]; 3],
    pub(super) root_samples: f64,
}

/// Index of W in a clip vector.
const W: usize = 2;

impl Edges {
    /// Speed of a picture position at `x` (0 to 1 across the image root) along each edge, times the depth, in samples.
    fn speed(&self, axis: usize, x: f64) -> [f64; 3] {
        self.edge.map(|e| (e[axis] - x * e[W]) * self.root_samples)
    }

    /// The two ends of the range of positions that may change, where linear and convex functions are greatest.
    fn ends(&self) -> [f64; 2] {
        let guard = libm::ldexp(1.0, -(SCREEN_GUARD_SHIFT as i32));
        [-guard, guard + 1.0]
    }

    /// Sum over the edges of the speed of a point, the greater of both axes and ends.
    fn total_speed(&self) -> f64 {
        let ends = self.ends();
        let mut most = 0.0f64;
        for axis in 0..2 {
            let [low, high] = ends.map(|x| self.speed(axis, x).map(f64::abs));
            let [x, y, z] = [0, 1, 2].map(|k| low[k].max(high[k]));
            most = most.max(x + y + z);
        }
        most
    }

    /// Depth that a finest voxel spans.
    fn depth_span(&self) -> f64 {
        let [x, y, z] = self.edge.map(|e| e[W].abs());
        x + y + z
    }

    /// Least depth, in voxels, at which a voxel of side 1 counts as a solid for a level of detail of at most `limit`
    /// samples.
    pub(super) fn detail_depth(&self, limit: f64) -> f64 {
        self.total_speed() / limit
    }

    /// Least depth, in voxels, at which a voxel of side 1 may change to screen space with a deviation of at most `allowed`
    /// samples.
    pub(super) fn screen_depth(&self, allowed: f64) -> f64 {
        libm::sqrt(self.total_speed() * self.depth_span() / allowed)
    }
}

/// Most samples by which rounding moves a vertex in screen space: quotients are rounded down, a corner and three edges by
/// one unit each.
pub(super) fn rounding(screen_frac: u32) -> f64 {
    libm::ldexp(4.0, -(screen_frac as i32))
}
