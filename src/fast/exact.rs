//! Exact silhouettes (R8, ties R8.1, the plane of the eye R8.2): in `f64` where its error bound decides, otherwise in
//! 128-bit integers.
//!
//! The plane through the eye and the edge of direction j that starts at `A` has the normal `n = A x e_j`. The side of the
//! sample `q = (2x + 1, 2y + 1, 2^(R + 1))` is the sign of `n q`; a zero is decided by the signs of `n_X` and `n_Y`.

use super::window::Window;
use crate::project::FrameSetup;

/// Bound of the error in `f64` of a plane's value at a sample, relative to the sizes of its products (`doubles.gappa`).
pub(super) const PLANE_ERROR: f64 = 1.0 / (1u64 << 48) as f64;

#[derive(Debug, Clone)]
pub(super) struct Exact {
    origin: [i64; 3],
    edge: [[i64; 3]; 3],
    edge_float: [[f64; 3]; 3],
    axis: [[i128; 3]; 3],
    positive: bool,
    eye_floor: [i64; 3],
    eye_ceil: [i64; 3],
    unit: i64,
}

fn cross(a: [i64; 3], b: [i64; 3]) -> [i128; 3] {
    let at = |i: usize, j: usize| {
        i128::from(a[i]) * i128::from(b[j]) - i128::from(a[j]) * i128::from(b[i])
    };
    [at(1, 2), at(2, 0), at(0, 1)]
}

/// The sign of a plane at a sample; zero is decided by the plane's slope.
fn side_of(plane: [i128; 3], sample: [i64; 3]) -> i8 {
    let value: i128 = (0..3).map(|c| plane[c] * i128::from(sample[c])).sum();
    for number in [value, plane[0], plane[1]] {
        if number != 0 {
            return if number > 0 { 1 } else { -1 };
        }
    }
    0
}

#[inline(always)]
fn dot(a: &[f64; 3], b: &[f64; 3], size: &[f64; 3]) -> (f64, f64) {
    (
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2],
        a[0].abs() * size[0] + a[1].abs() * size[1] + a[2].abs() * size[2],
    )
}

impl Exact {
    pub(super) fn new(setup: &FrameSetup) -> Self {
        let edge = setup.edge_clip;
        Self {
            origin: setup.origin_clip,
            edge,
            edge_float: edge.map(|e| e.map(|c| c as f64)),
            axis: [0, 1, 2].map(|k| cross(edge[(k + 1) % 3], edge[(k + 2) % 3])),
            positive: setup.positive,
            eye_floor: setup.eye_floor,
            eye_ceil: setup.eye_ceil,
            unit: 1i64 << (setup.levels + 1),
        }
    }

    #[inline(always)]
    fn at(&self, point: [i32; 3]) -> [i64; 3] {
        let mut at = self.origin;
        for k in 0..3 {
            for c in 0..3 {
                at[c] += i64::from(point[k]) * self.edge[k][c];
            }
        }
        at
    }

    /// Whether the ray of a sample meets the inside of a cube before the eye. Per direction j the least and greatest
    /// `n q = A (e_j x q)` decide, over the starts `A` of the four edges.
    #[inline(always)]
    pub(super) fn covers(&self, min: [i32; 3], side: i32, sample: [i32; 2]) -> bool {
        let corner = self.at(min);
        let q = self.sample(sample);
        let (base, q_float) = (corner.map(|c| c as f64), q.map(|c| c as f64));
        let side_float = f64::from(side);
        let mut is_certain = true;
        for j in 0..3 {
            let (k, l) = ((j + 1) % 3, (j + 2) % 3);
            let e = &self.edge_float[j];
            let mut across = [0.0; 3];
            let mut size = [0.0; 3];
            for c in 0..3 {
                let (a, b) = ((c + 1) % 3, (c + 2) % 3);
                let (left, right) = (e[a] * q_float[b], e[b] * q_float[a]);
                across[c] = left - right;
                size[c] = left.abs() + right.abs();
            }
            let (value, most) = dot(&base, &across, &size);
            let (along_k, most_k) = dot(&self.edge_float[k], &across, &size);
            let (along_l, most_l) = dot(&self.edge_float[l], &across, &size);
            let (along_k, along_l) = (along_k * side_float, along_l * side_float);
            let doubt = (most + (most_k + most_l) * side_float) * PLANE_ERROR;
            let least = value + along_k.min(0.0) + along_l.min(0.0);
            let greatest = value + along_k.max(0.0) + along_l.max(0.0);
            if least > doubt || greatest < -doubt {
                return false;
            }
            is_certain &= least < -doubt && greatest > doubt;
        }
        is_certain || self.covers_exactly(corner, side, q)
    }

    #[cold]
    fn covers_exactly(&self, corner: [i64; 3], side: i32, sample: [i64; 3]) -> bool {
        (0..3).all(|j| {
            let (k, l) = ((j + 1) % 3, (j + 2) % 3);
            let sides = [0, 1, 2, 3].map(|vertex| {
                let mut at = corner;
                for (axis, times) in [(k, vertex & 1), (l, vertex >> 1)] {
                    for c in 0..3 {
                        at[c] += self.edge[axis][c] * i64::from(side) * i64::from(times);
                    }
                }
                side_of(cross(at, self.edge[j]), sample)
            });
            sides.contains(&1) && sides.contains(&-1)
        })
    }

    #[cold]
    pub(super) fn runs_downwards(&self, axis: usize, sample: [i32; 2]) -> bool {
        (side_of(self.axis[axis], self.sample(sample)) < 0) == self.positive
    }

    fn sample(&self, [x, y]: [i32; 2]) -> [i64; 3] {
        [2 * i64::from(x) + 1, 2 * i64::from(y) + 1, self.unit]
    }

    pub(super) fn outline(&self, min: [i32; 3], side: i32, is_before_eye: bool) -> Outline {
        let edges = [0, 1, 2].map(|j| {
            let (k, l) = ((j + 1) % 3, (j + 2) % 3);
            [0, 1, 2, 3].map(|vertex| {
                let mut at = min;
                at[k] += (vertex & 1) * side;
                at[l] += (vertex >> 1) * side;
                self.plane(cross(self.at(at), self.edge[j]))
            })
        });
        let front = self.front(min, side).filter(|_| !is_before_eye);
        Outline { edges, front }
    }

    fn front(&self, min: [i32; 3], side: i32) -> Option<(Plane, i8)> {
        (0..3).find_map(|axis| {
            let upwards = self.eye_ceil[axis] <= i64::from(min[axis]);
            let downwards = i64::from(min[axis] + side) <= self.eye_floor[axis];
            (upwards || downwards).then(|| {
                let c: [i128; 3] = self.axis[axis];
                let side = if upwards == self.positive { 1 } else { -1 };
                (self.plane(c), side)
            })
        })
    }

    fn plane(&self, exact: [i128; 3]) -> Plane {
        Plane {
            exact,
            float: [
                exact[0] as f64,
                exact[1] as f64,
                exact[2] as f64 * self.unit as f64,
            ],
        }
    }
}

#[derive(Debug, Clone, Copy)]
struct Plane {
    exact: [i128; 3],
    /// `(2x + 1) [0] + (2y + 1) [1] + [2]`, rounded.
    float: [f64; 3],
}

impl Plane {
    /// The side of all samples of a window, 0 if there is no plane, or `None` where both sides may occur.
    fn side(&self, window: &Window) -> Option<i8> {
        let [a, b, c] = self.float;
        let odd = |i: i32| f64::from(i) * 2.0 + 1.0;
        let (x0, x1) = (a * odd(window.left), a * odd(window.right));
        let (y0, y1) = (b * odd(window.top), b * odd(window.bottom));
        let least = x0.min(x1) + y0.min(y1) + c;
        let greatest = x0.max(x1) + y0.max(y1) + c;
        let most = x0.abs().max(x1.abs()) + y0.abs().max(y1.abs()) + c.abs();
        let doubt = most * PLANE_ERROR;
        if least > doubt {
            Some(1)
        } else if greatest < -doubt {
            Some(-1)
        } else if self.exact == [0; 3] {
            Some(0)
        } else {
            None
        }
    }

    fn side_of_sample(&self, exact: &Exact, x: i32, y: i32) -> i8 {
        let [a, b, c] = self.float;
        let x_part = a * (f64::from(x) * 2.0 + 1.0);
        let y_part = b * (f64::from(y) * 2.0 + 1.0);
        let value = x_part + y_part + c;
        let doubt = (x_part.abs() + y_part.abs() + c.abs()) * PLANE_ERROR;
        if value > doubt {
            1
        } else if value < -doubt {
            -1
        } else {
            side_of(self.exact, exact.sample([x, y]))
        }
    }
}

#[derive(Debug, Clone)]
pub(super) struct Outline {
    edges: [[Plane; 4]; 3],
    /// A plane, and its side that sees the cube and not its mirror image behind the eye.
    front: Option<(Plane, i8)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cover {
    None,
    Some,
    All,
}

impl Outline {
    pub(super) fn cover(&self, window: &Window) -> Cover {
        let mut all = true;
        for edges in &self.edges {
            let sides = edges.each_ref().map(|plane| plane.side(window));
            if !(sides.contains(&Some(1)) && sides.contains(&Some(-1))) {
                if !sides.contains(&None) {
                    return Cover::None;
                }
                all = false;
            }
        }
        match &self.front {
            None => {}
            Some((plane, wanted)) => match plane.side(window) {
                None => all = false,
                Some(side) if side == *wanted => {}
                Some(_) => return Cover::None,
            },
        }
        if all { Cover::All } else { Cover::Some }
    }

    pub(super) fn covers(&self, exact: &Exact, x: i32, y: i32) -> bool {
        let side_of = |plane: &Plane| plane.side_of_sample(exact, x, y);
        let is_between = |edges: &[Plane; 4]| {
            let sides = edges.each_ref().map(side_of);
            sides.contains(&1) && sides.contains(&-1)
        };
        let is_in_front = |(plane, side): &(Plane, i8)| side_of(plane) == *side;
        self.edges.iter().all(is_between) && self.front.iter().all(is_in_front)
    }
}
