//! A frame's set-up for the oracle: planes through the eye.

use crate::project::FrameSetup;

/// Line functions up to this magnitude, times eight, stay within `i128`.
const I128_BOUND: i128 = 1 << 123;

#[derive(Debug)]
pub(super) struct RayFrame {
    /// Clip vector of the object's lowest corner.
    origin: [i128; 3],
    edge: [[i128; 3]; 3],
    /// `edge[k + 1] x edge[k + 2]`. Its product with a ray direction has the sign of object coordinate `k` of the
    /// direction, times [`determinant_sign`](Self::determinant_sign).
    pub(super) normal: [[i128; 3]; 3],
    pub(super) determinant_sign: i32,
    pub(super) depth: u32,
    levels: u32,
    sub_levels: u32,
    /// The eye in units of `2^-sub_levels` voxels, rounded down and up.
    eye_floor: [i64; 3],
    eye_ceil: [i64; 3],
    /// By octree level, least depth of a node with children that level of detail makes a solid. `None`: none.
    lod_depth: Vec<Option<i128>>,
}

impl RayFrame {
    pub(super) fn new(setup: &FrameSetup) -> Self {
        let edge = setup.edge_clip.map(|e| e.map(i128::from));
        Self {
            origin: setup.origin_clip.map(i128::from),
            edge,
            normal: [0, 1, 2].map(|k| cross(edge[(k + 1) % 3], edge[(k + 2) % 3])),
            determinant_sign: if setup.positive { 1 } else { -1 },
            depth: setup.depth,
            levels: setup.levels,
            sub_levels: setup.sub_levels,
            eye_floor: setup.eye_floor,
            eye_ceil: setup.eye_ceil,
            lod_depth: setup
                .lod_depth
                .iter()
                .map(|&w| (w != i64::MAX).then_some(i128::from(w)))
                .collect(),
        }
    }

    /// Level of detail (`SPEC.md`, R7.1): whether it makes the node of this level whose lowest corner is `lo` a solid.
    pub(super) fn is_solid_by_detail(&self, lo: [i64; 3], level: u32) -> bool {
        let enough = self.lod_depth.get(level as usize).copied().flatten();
        enough.is_some_and(|enough| self.least_depth(lo, level) >= enough)
    }

    /// The least `W` of a node: `W` is linear, so it is least at one end of each axis.
    fn least_depth(&self, lo: [i64; 3], level: u32) -> i128 {
        let side = 1i128 << (self.depth - level);
        let mut least = self.origin[2];
        for (step, at) in self.edge.iter().zip(lo) {
            least += i128::from(at) * step[2] + (side * step[2]).min(0);
        }
        least
    }

    pub(super) fn ray(&self, i: u32, j: u32) -> [i64; 3] {
        [
            2 * i64::from(i) + 1,
            2 * i64::from(j) + 1,
            1 << (self.levels + 1),
        ]
    }

    /// The plane through the eye and the voxel edge that leaves object point `u` along `axis`. Zero if the edge's line
    /// contains the eye.
    pub(super) fn edge_plane(&self, axis: usize, u: [i64; 3]) -> [i128; 3] {
        let mut point = self.origin;
        for (step, along) in self.edge.iter().zip(u) {
            for c in 0..3 {
                point[c] += i128::from(along) * step[c];
            }
        }
        cross(point, self.edge[axis])
    }

    /// Plane of the eye (R8.2): the side of the eye on which the slab `lo..hi` (voxels) of axis `k` lies, 0 around the
    /// eye.
    #[inline]
    pub(super) fn side_of_eye(&self, k: usize, lo: i64, hi: i64) -> i32 {
        // A whole number is >= the eye exactly if it is >= the eye rounded up.
        if lo << self.sub_levels >= self.eye_ceil[k] {
            1
        } else if hi << self.sub_levels <= self.eye_floor[k] {
            -1
        } else {
            0
        }
    }

    /// Whether every line function, and every sum of three, fits `i128`. Line functions are linear in the object point,
    /// so they are largest at a corner of the object.
    pub(super) fn fits_i128(&self) -> bool {
        let side = 1i64 << self.depth;
        (0..8i64).all(|corner| {
            let u = [corner >> 2 & 1, corner >> 1 & 1, corner & 1].map(|bit| bit * side);
            (0..3).all(|axis| {
                let reach: u128 = self
                    .edge_plane(axis, u)
                    .iter()
                    .map(|c| c.unsigned_abs())
                    .sum();
                reach <= I128_BOUND as u128 >> (self.levels + 1)
            })
        })
    }
}

fn cross(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
