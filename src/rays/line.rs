//! Exact coverage (`SPEC.md`, R8): one sample's ray against axis-aligned cubes (`spec/rays.md`, "Hit").
//!
//! Ties (R8.1): the ray is moved by `(e, e^2)` in `(x, y)` for an infinitesimal `e`. A linear function `a x + b y + c
//! w` of the direction that is 0 then has the sign of `a`, or of `b` if `a` is 0 as well. If both are 0 so is `c`: the
//! function is zero for every ray (an edge through the eye) and has no sign. `g_k` always has one, as its plane is not
//! zero.

use super::number::Number;
use super::ray_frame::RayFrame;

pub(super) struct Line<'v, N> {
    view: &'v RayFrame,
    /// `f_j(0)`, for `f_j(u) = det(P(u), edge_j, q)`.
    pub(super) at_origin: [N; 3],
    /// `g_k = (edge_k+1 x edge_k+2) . q`.
    slope: [N; 3],
    /// Whether `g_k` is above 0, ties resolved; otherwise below.
    slope_positive: [bool; 3],
    /// Signs of the ray's direction in object space: 1 or -1.
    pub(super) direction: [i32; 3],
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Cube<N> {
    /// Lowest corner, finest voxels.
    pub(super) lo: [i64; 3],
    /// `f_j(lo)`.
    pub(super) at_lo: [N; 3],
}

impl<'v, N: Number> Line<'v, N> {
    pub(super) fn new(view: &'v RayFrame, i: u32, j: u32) -> Self {
        let ray = view.ray(i, j);
        let slope = view.normal.map(|plane| N::dot(plane, ray));
        let slope_sign = [0, 1, 2].map(|k| sign(slope[k], || view.normal[k]));
        Self {
            view,
            at_origin: [0, 1, 2].map(|axis| N::dot(view.edge_plane(axis, [0; 3]), ray)),
            slope,
            slope_positive: slope_sign.map(|s| s > 0),
            direction: slope_sign.map(|s| s * view.determinant_sign),
        }
    }

    /// The change of line functions along the side of a cube of `2^levels` voxels.
    pub(super) fn along_side(&self, levels: u32) -> [N; 3] {
        self.slope.map(|g| g.times_power(levels))
    }

    /// The cube that lies `octant` (`x << 2 | y << 1 | z`) sides above another; `side` in voxels.
    #[inline]
    pub(super) fn neighbour(
        &self,
        cube: &Cube<N>,
        octant: u8,
        side: i64,
        along_side: &[N; 3],
    ) -> Cube<N> {
        let above = [octant >> 2 & 1, octant >> 1 & 1, octant & 1].map(|bit| bit != 0);
        let mut lo = cube.lo;
        let mut at_lo = cube.at_lo;
        for axis in 0..3 {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            if above[axis] {
                lo[axis] += side;
            }
            if above[next] {
                at_lo[axis] = at_lo[axis] - along_side[last];
            }
            if above[last] {
                at_lo[axis] = at_lo[axis] + along_side[next];
            }
        }
        Cube { lo, at_lo }
    }

    /// Whether the ray, from the eye on, passes through the interior of a cube.
    #[inline]
    pub(super) fn enters(&self, cube: &Cube<N>, side: i64, along_side: &[N; 3]) -> bool {
        self.goes_forward_to(cube.lo, side) && self.line_crosses(cube, side, along_side)
    }

    /// Plane of the eye (R8.2): whether a cube on the line lies before the eye, which is outside of a slab, or in the
    /// cube.
    #[inline]
    fn goes_forward_to(&self, lo: [i64; 3], side: i64) -> bool {
        (0..3).all(|k| {
            let slab = self.view.side_of_eye(k, lo[k], lo[k] + side);
            slab == 0 || slab == self.direction[k]
        })
    }

    #[inline]
    fn line_crosses(&self, cube: &Cube<N>, side: i64, along_side: &[N; 3]) -> bool {
        (0..3).all(|axis| {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            // f_j falls along axis j+1 where g_j+2 is positive, grows along j+2 where g_j+1 is.
            let most_at_next = !self.slope_positive[last];
            let most_at_last = self.slope_positive[next];
            let edge_sign = |at_next: bool, at_last: bool| {
                let mut value = cube.at_lo[axis];
                if at_next {
                    value = value - along_side[last];
                }
                if at_last {
                    value = value + along_side[next];
                }
                sign(value, || {
                    let mut corner = cube.lo;
                    corner[next] += side * i64::from(at_next);
                    corner[last] += side * i64::from(at_last);
                    self.view.edge_plane(axis, corner)
                })
            };
            edge_sign(most_at_next, most_at_last) > 0 && edge_sign(!most_at_next, !most_at_last) < 0
        })
    }
}

/// Sign of `plane . q` with ties resolved; `plane` is evaluated only in a tie.
#[inline]
fn sign<N: Number>(value: N, plane: impl FnOnce() -> [i128; 3]) -> i32 {
    match value.sign() {
        0 => {
            let plane = plane();
            match plane[0].signum() {
                0 => plane[1].signum() as i32,
                a => a as i32,
            }
        }
        sign => sign,
    }
}
