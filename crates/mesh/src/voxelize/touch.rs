//! Does a triangle touch a cube? Exactly, in integers.
//!
//! They are apart if and only if one of these directions separates them: the cube's three axes, the nine products of an
//! edge and an axis, and the triangle's normal. The normal of a segment or a point is zero and separates nothing.
//!
//! Coordinates and edges are below 2^30 in size, so a product of an edge and an axis dotted with a corner is below 2^61,
//! as the normal is. Dotted with a corner that is below 2^93: `i128`.

#[derive(Debug, Clone, Copy, Default)]
struct Flat {
    parts: [i64; 2],
    low: i64,
    high: i64,
}

impl Flat {
    fn new(parts: [i64; 2], points: [[i64; 2]; 3]) -> Self {
        let values = points.map(|p| parts[0] * p[0] + parts[1] * p[1]);
        Self {
            parts,
            low: values[0].min(values[1]).min(values[2]),
            high: values[0].max(values[1]).max(values[2]),
        }
    }

    #[inline]
    fn separates(&self, corner: [i64; 2], side: i64) -> bool {
        let [a, b] = self.parts;
        let at = a * corner[0] + b * corner[1];
        let low = at + (a.min(0) + b.min(0)) * side;
        let high = at + (a.max(0) + b.max(0)) * side;
        low > self.high || high < self.low
    }
}

#[derive(Debug, Clone)]
pub(crate) struct Prepared {
    pub(crate) corners: [[i64; 3]; 3],
    pub(crate) low: [i64; 3],
    pub(crate) high: [i64; 3],
    pub(crate) normal: [i64; 3],
    pub(crate) offset: i128,
    /// For each axis the directions of the three edges in the plane of the others.
    flats: [[Flat; 3]; 3],
}

pub(crate) const OTHERS: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

impl Prepared {
    pub(crate) fn new(corners: [[i64; 3]; 3]) -> Self {
        let [a, b, c] = corners;
        let edges = [subtract(b, a), subtract(c, b), subtract(a, c)];
        let normal = cross(edges[0], edges[1]);
        let fold =
            |pick: fn(i64, i64) -> i64| std::array::from_fn(|k| pick(pick(a[k], b[k]), c[k]));
        let flats = OTHERS.map(|[u, v]| {
            let points = corners.map(|p| [p[u], p[v]]);
            edges.map(|edge| Flat::new([-edge[v], edge[u]], points))
        });
        Self {
            corners,
            low: fold(i64::min),
            high: fold(i64::max),
            normal,
            offset: (0..3)
                .map(|k| i128::from(normal[k]) * i128::from(a[k]))
                .sum(),
            flats,
        }
    }

    #[inline]
    pub(crate) fn touches(&self, corner: [i64; 3], side: i64) -> bool {
        for k in 0..3 {
            if corner[k] > self.high[k] || corner[k] + side < self.low[k] {
                return false;
            }
        }
        for (flats, [u, v]) in self.flats.iter().zip(OTHERS) {
            let square = [corner[u], corner[v]];
            if flats.iter().any(|flat| flat.separates(square, side)) {
                return false;
            }
        }
        let (mut low, mut high) = (0i128, 0i128);
        for k in 0..3 {
            let n = i128::from(self.normal[k]);
            let at = n * i128::from(corner[k]);
            let far = at + n * i128::from(side);
            low += at.min(far);
            high += at.max(far);
        }
        low <= self.offset && self.offset <= high
    }

    /// The children of a cube that the triangle touches, as bits `x << 2 | y << 1 | z`.
    pub(super) fn children(&self, corner: [i64; 3], half: i64) -> u8 {
        (0..8u8)
            .filter(|&octant| self.touches(child(corner, half, octant), half))
            .fold(0, |mask, octant| mask | 1 << octant)
    }

    pub(super) fn is_inside(&self, corner: [i64; 3], side: i64) -> bool {
        (0..3).all(|k| corner[k] <= self.low[k] && self.high[k] <= corner[k] + side)
    }
}

#[inline]
pub(crate) fn child(corner: [i64; 3], half: i64, octant: u8) -> [i64; 3] {
    std::array::from_fn(|k| corner[k] + half * i64::from(octant >> (2 - k) & 1))
}

fn subtract(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn cross(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    OTHERS.map(|[u, v]| a[u] * b[v] - a[v] * b[u])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_numbers_fit() {
        let most = (1i64 << 30) - 1;
        let triangle = Prepared::new([[0, most, 0], [most, 0, most], [most, most, 0]]);
        assert!(triangle.touches([0, most - 1, 0], 1));
        // The triangle has the points (x, most - z, z) with x from z to most. y and z are not both in the upper half.
        // At z = 2^29 it meets the lower half of x in a point.
        assert_eq!(triangle.children([0; 3], 1 << 29), 0b0111_0111);
    }
}
