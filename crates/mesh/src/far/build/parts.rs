//! Parts of a mesh that hang together, how wide they are, and which corners nodes share.

use std::collections::HashMap;
use std::ops::Range;

use glam::DVec3;

use crate::geometry::{Sets, area, bounds, point};

pub(super) struct Parts {
    vertices: HashMap<[u32; 3], u32>,
    /// The first and the last triangle that has each vertex.
    spans: Vec<[u32; 2]>,
    /// At vertices that leaves share: normals of all triangles, as long as their areas.
    normals: HashMap<u32, Vec<DVec3>>,
    /// Of each triangle's part.
    pub(super) sizes: Vec<PartSize>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PartSize {
    /// Area over longest extent: the smaller side of a leaf, the girth of a wire.
    pub(super) width: f32,
    pub(super) radius: f32,
}

impl Parts {
    /// Triangles that share a corner's position are of one part. `leaves` has the number of triangles of each leaf.
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
        let mut parts: HashMap<u32, (DVec3, DVec3, f64)> = HashMap::new();
        for (number, root) in roots.iter().enumerate() {
            let corners = corners(number).map(point);
            let (low, high, sum) = parts.entry(*root).or_insert((corners[0], corners[0], 0.0));
            (*low, *high) = bounds([*low, *high].into_iter().chain(corners));
            *sum += area(corners);
        }
        let size = |root| {
            let (low, high, area) = parts[root];
            let extent = (high - low).length();
            PartSize {
                width: (area / extent) as f32,
                radius: (extent / 2.0) as f32,
            }
        };
        Self {
            vertices,
            spans,
            normals,
            sizes: roots.iter().map(size).collect(),
        }
    }

    /// The normals of all triangles at a position that a node, of a range of triangles, shares with others.
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
