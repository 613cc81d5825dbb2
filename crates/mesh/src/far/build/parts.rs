//! Parts of a mesh that hang together, how wide they are, and which corners nodes share.

use std::collections::HashMap;
use std::ops::Range;

use glam::DVec3;

use crate::geometry::{Sets, area, bounds, point};

/// Parts of all triangles, which are numbered as the hierarchy orders them.
pub(super) struct Parts {
    /// Vertices by the bits of their positions.
    vertices: HashMap<[u32; 3], u32>,
    /// The first and the last triangle that has each vertex.
    spans: Vec<[u32; 2]>,
    /// Of each vertex that leaves share the normals of all triangles there, each as long as its
    /// triangle's area.
    normals: HashMap<u32, Vec<DVec3>>,
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
    /// Triangles that share a corner's position are of one part. `leaves` has the number of triangles of each leaf,
    /// fewer than 2^32 in all. `normals_of` returns the normals of a triangle's corners.
    pub(super) fn of(
        leaves: &[usize],
        corners: impl Fn(usize) -> [[f32; 3]; 3],
        normals_of: impl Fn(usize) -> [DVec3; 3],
    ) -> Self {
        let count = leaves.iter().sum::<usize>();
        let mut vertices: HashMap<[u32; 3], u32> = HashMap::new();
        let mut spans: Vec<[u32; 2]> = Vec::new();
        let mut sets = Sets::new(count as u32);
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
                sets.join(number, span[0]);
            }
        }
        let roots: Vec<u32> = (0..count as u32).map(|number| sets.root(number)).collect();
        let mut normals: HashMap<u32, Vec<DVec3>> = HashMap::new();
        let mut end = 0;
        for own in leaves {
            let leaf = end..end + own;
            end = leaf.end;
            for number in leaf.clone() {
                let corners = corners(number);
                for (k, &corner) in corners.iter().enumerate() {
                    let vertex = vertices[&bits(corner)];
                    let is_within = |number: u32| leaf.contains(&(number as usize));
                    if !spans[vertex as usize].into_iter().all(is_within) {
                        let [a, b, c] = corners.map(point);
                        let area = (b - a).cross(c - a).length();
                        let normal = normals_of(number)[k] * area;
                        normals.entry(vertex).or_default().push(normal);
                    }
                }
            }
        }
        let mut parts: HashMap<u32, Part> = HashMap::new();
        for (number, root) in roots.iter().enumerate() {
            let corners = corners(number).map(point);
            let part = parts.entry(*root).or_insert(Part {
                low: corners[0],
                high: corners[0],
                area: 0.0,
            });
            (part.low, part.high) = bounds([part.low, part.high].into_iter().chain(corners));
            part.area += area(corners);
        }
        let size = |root| parts[root].size();
        Self {
            vertices,
            spans,
            normals,
            sizes: roots.iter().map(size).collect(),
        }
    }

    pub(super) fn size(&self, triangle: usize) -> PartSize {
        self.sizes[triangle]
    }

    /// The normals of all triangles at a position where some beyond a range, which is that of a
    /// node, have a corner; `None` of any other position.
    pub(super) fn shared(&self, range: &Range<usize>, position: [f32; 3]) -> Option<&[DVec3]> {
        let vertex = self.vertices.get(&bits(position))?;
        let [first, last] = self.spans[*vertex as usize].map(|number| number as usize);
        let is_shared = first < range.start || last >= range.end;
        let normals = is_shared.then(|| self.normals.get(vertex))?;
        Some(normals.map_or(&[], Vec::as_slice))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leaf_is_as_wide_as_its_smaller_side() {
        // A strip of 1 by 8 in four parts of two triangles that share edges, and a far triangle.
        let mut triangles: Vec<[[f32; 3]; 3]> = Vec::new();
        for x in [0.0, 2.0, 4.0, 6.0] {
            let [a, b] = [[x, 0.0, 0.0], [x + 2.0, 0.0, 0.0]];
            let [c, d] = [[x + 2.0, 1.0, 0.0], [x, 1.0, 0.0]];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        triangles.push([[50.0, 0.0, 0.0], [50.0, 3.0, 0.0], [50.0, 0.0, 4.0]]);
        let normals = |number: usize| [DVec3::X * (number + 1) as f64; 3];
        let parts = Parts::of(&[4, 5], |number| triangles[number], normals);
        for number in 0..8 {
            assert!((parts.size(number).width - 8.0 / 65f32.sqrt()).abs() < 1e-6);
        }
        assert!((parts.size(8).width - 6.0 / 5.0).abs() < 1e-6);
        assert!((parts.size(8).radius - 2.5).abs() < 1e-6);
        // The point in the middle of the strip belongs to triangles 2 to 5, its end to 6 and 7.
        let middle = [4.0, 0.0, 0.0];
        let normals = parts.shared(&(0..4), middle).unwrap();
        assert!(normals.iter().map(|n| n.x).eq([6.0, 10.0, 12.0]));
        assert_eq!(parts.shared(&(4..9), middle), Some(normals));
        for (own, point) in [(0..8, middle), (4..9, [8.0, 0.0, 0.0]), (0..4, [9.0; 3])] {
            assert_eq!(parts.shared(&own, point), None);
        }
    }
}
