//! Boxes, planes, polygons and sets that several methods need.

use glam::DVec3;

pub(crate) fn bounds(points: impl IntoIterator<Item = DVec3>) -> (DVec3, DVec3) {
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    points
        .into_iter()
        .fold(start, |(low, high), p| (low.min(p), high.max(p)))
}

pub(crate) fn point<T: Into<f64>>(position: [T; 3]) -> DVec3 {
    DVec3::from_array(position.map(Into::into))
}

pub(crate) fn area([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).cross(c - a).length() / 2.0
}

/// The unit normal of a triangle's plane, towards who sees it counter-clockwise; +Z if its corners are on a line.
pub(crate) fn plane_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or(DVec3::Z)
}

/// The shares of the corners in a point of the triangle, each 0 to 1; thirds if it has no area.
pub fn barycentric([a, b, c]: &[DVec3; 3], point: DVec3) -> [f64; 3] {
    let normal = (*b - *a).cross(*c - *a);
    let square = normal.length_squared();
    if square == 0.0 {
        return [1.0 / 3.0; 3];
    }
    let of_b = (point - *a).cross(*c - *a).dot(normal) / square;
    let of_c = (*b - *a).cross(point - *a).dot(normal) / square;
    let (of_b, of_c) = (of_b.clamp(0.0, 1.0), of_c.clamp(0.0, 1.0));
    let excess = (of_b + of_c).max(1.0);
    let (of_b, of_c) = (of_b / excess, of_c / excess);
    [1.0 - of_b - of_c, of_b, of_c]
}

pub(crate) fn blend(of: &[DVec3; 3], shares: [f64; 3]) -> DVec3 {
    of[0] * shares[0] + of[1] * shares[1] + of[2] * shares[2]
}

/// Most corners of a triangle that was cut at six planes, and one more.
const MOST: usize = 10;

#[derive(Debug, Clone, Copy)]
pub(crate) struct Polygon {
    corners: [DVec3; MOST],
    count: usize,
}

impl Polygon {
    pub(crate) fn of(triangle: &[DVec3; 3]) -> Self {
        let mut corners = [DVec3::ZERO; MOST];
        corners[..3].copy_from_slice(triangle);
        Self { corners, count: 3 }
    }

    pub(crate) fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }

    /// The part in which `inside` is not negative. An edge is cut at the same point in both directions.
    pub(crate) fn cut(&self, inside: impl Fn(DVec3) -> f64) -> Self {
        self.cut_at(inside, true)
    }

    /// As [`Polygon::cut`], but an edge is cut from its first end on, whichever is inside.
    pub(crate) fn cut_in_order(&self, inside: impl Fn(DVec3) -> f64) -> Self {
        self.cut_at(inside, false)
    }

    /// The part in a unit cube.
    pub(crate) fn within(&self, corner: DVec3) -> Self {
        let mut part = *self;
        for axis in 0..3 {
            let along = part.corners().iter().map(|p| p[axis]);
            let high = along.clone().fold(f64::NEG_INFINITY, f64::max);
            if along.fold(f64::INFINITY, f64::min) < corner[axis] {
                part = part.cut_in_order(|p| p[axis] - corner[axis]);
            }
            if high > corner[axis] + 1.0 {
                part = part.cut_in_order(|p| corner[axis] + 1.0 - p[axis]);
            }
        }
        part
    }

    fn cut_at(&self, inside: impl Fn(DVec3) -> f64, from_inner: bool) -> Self {
        let mut part = Self {
            corners: self.corners,
            count: 0,
        };
        let mut put = |point: DVec3| {
            // Rounding may make a polygon that is not quite convex; excess corners are dropped.
            if part.count < MOST {
                part.corners[part.count] = point;
                part.count += 1;
            }
        };
        for (i, &here) in self.corners().iter().enumerate() {
            let next = self.corners[(i + 1) % self.count];
            let (a, b) = (inside(here), inside(next));
            if a >= 0.0 {
                put(here);
            }
            if (a >= 0.0) != (b >= 0.0) {
                let (from, to, a, b) = match from_inner && a < 0.0 {
                    true => (next, here, b, a),
                    false => (here, next, a, b),
                };
                put(from + (to - from) * (a / (a - b)));
            }
        }
        part
    }
}

/// Numbers in sets that can be joined. The lowest number of a set is its root.
pub(crate) struct Sets(Vec<u32>);

impl Sets {
    pub(crate) fn new(count: u32) -> Self {
        Self((0..count).collect())
    }

    pub(crate) fn root(&mut self, mut number: u32) -> u32 {
        while self.0[number as usize] != number {
            let above = self.0[self.0[number as usize] as usize];
            self.0[number as usize] = above;
            number = above;
        }
        number
    }

    pub(crate) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
