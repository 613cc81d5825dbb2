//! Parts of a mesh that hang together, how wide they are, and which corners nodes share.

use std::collections::HashMap;
use std::ops::Range;

use glam::DVec3;

/// Parts of all triangles, which are numbered as the hierarchy orders them.
pub(super) struct Parts {
    /// Vertices by the bits of their positions.
    vertices: HashMap<[u32; 3], u32>,
    /// The first and the last triangle that has each vertex.
    spans: Vec<[u32; 2]>,
    /// Of each triangle the sizes of its part.
    sizes: Vec<PartSize>,
}

/// How large a part is, world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PartSize {
    /// Its area over its longest extent: the smaller side of a leaf, the girth of a wire, more than
    /// a voxel for all that is large both ways.
    pub(super) width: f32,
    /// Half of its longest extent.
    pub(super) radius: f32,
}

impl Parts {
    /// Triangles that share a corner's position are of one part. There are fewer than 2^32.
    pub(super) fn of(count: usize, corners: impl Fn(usize) -> [[f32; 3]; 3]) -> Self {
        let mut vertices: HashMap<[u32; 3], u32> = HashMap::new();
        let mut spans: Vec<[u32; 2]> = Vec::new();
        let mut parents: Vec<u32> = (0..count as u32).collect();
        for number in 0..count as u32 {
            for corner in corners(number as usize) {
                let next = spans.len() as u32;
                let vertex = *vertices.entry(bits(corner)).or_insert(next);
                if vertex == next {
                    spans.push([number; 2]);
                    continue;
                }
                let span = &mut spans[vertex as usize];
                span[1] = number;
                let (a, b) = (root(&mut parents, number), root(&mut parents, span[0]));
                parents[a.max(b) as usize] = a.min(b);
            }
        }
        let roots: Vec<u32> = (0..count as u32)
            .map(|number| root(&mut parents, number))
            .collect();
        let mut parts: HashMap<u32, Part> = HashMap::new();
        for (number, root) in roots.iter().enumerate() {
            let [a, b, c] = corners(number).map(|p| DVec3::from_array(p.map(f64::from)));
            let part = parts.entry(*root).or_insert(Part {
                low: a,
                high: a,
                area: 0.0,
            });
            part.low = part.low.min(a).min(b).min(c);
            part.high = part.high.max(a).max(b).max(c);
            part.area += (b - a).cross(c - a).length() / 2.0;
        }
        let size = |root| parts[root].size();
        Self {
            vertices,
            spans,
            sizes: roots.iter().map(size).collect(),
        }
    }

    pub(super) fn size(&self, triangle: usize) -> PartSize {
        self.sizes[triangle]
    }

    /// Whether triangles beyond a range have a corner at a position.
    pub(super) fn is_shared(&self, range: &Range<usize>, position: [f32; 3]) -> bool {
        let Some(&vertex) = self.vertices.get(&bits(position)) else {
            return false;
        };
        let [first, last] = self.spans[vertex as usize].map(|number| number as usize);
        first < range.start || last >= range.end
    }
}

/// Zeros of both signs are one place.
fn bits(position: [f32; 3]) -> [u32; 3] {
    position.map(|x| (x + 0.0).to_bits())
}

struct Part {
    low: DVec3,
    high: DVec3,
    area: f64,
}

impl Part {
    fn size(&self) -> PartSize {
        let extent = (self.high - self.low).length();
        PartSize {
            width: (self.area / extent) as f32,
            radius: (extent / 2.0) as f32,
        }
    }
}

fn root(parents: &mut [u32], mut of: u32) -> u32 {
    while parents[of as usize] != of {
        parents[of as usize] = parents[parents[of as usize] as usize];
        of = parents[of as usize];
    }
    of
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leaf_is_as_wide_as_its_smaller_side() {
        // A strip of 1 by 8 in four parts of two triangles that share edges, and a far triangle.
        let point = |i: u32, y: f32| [2.0 * i as f32, y, 0.0];
        let mut triangles: Vec<[[f32; 3]; 3]> = Vec::new();
        for i in 0..4 {
            let [a, b, c, d] = [
                point(i, 0.0),
                point(i + 1, 0.0),
                point(i + 1, 1.0),
                point(i, 1.0),
            ];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        triangles.push([[50.0, 0.0, 0.0], [50.0, 3.0, 0.0], [50.0, 0.0, 4.0]]);
        let parts = Parts::of(triangles.len(), |number| triangles[number]);
        for number in 0..8 {
            assert!((parts.size(number).width - 8.0 / 65f32.sqrt()).abs() < 1e-6);
        }
        assert!((parts.size(8).width - 6.0 / 5.0).abs() < 1e-6);
        assert!((parts.size(8).radius - 2.5).abs() < 1e-6);
        // The middle of the strip is of triangles 2 to 5, its end of 6 and 7.
        assert!(parts.is_shared(&(0..4), point(2, 0.0)));
        assert!(parts.is_shared(&(4..9), point(2, 1.0)));
        assert!(!parts.is_shared(&(0..8), point(2, 1.0)));
        assert!(!parts.is_shared(&(4..9), point(4, 0.0)));
        assert!(!parts.is_shared(&(0..4), [9.0; 3]));
    }
}
