//! Parts of a mesh that hang together, and how wide they are.

use std::collections::HashMap;

use crate::mesh::{Mesh, Surface};

/// The width of the part that each triangle belongs to, world units.
///
/// Triangles that share a corner's position are of one part. Its width is its area over its
/// longest extent: the smaller side of a leaf, the girth of a wire, more than a pixel for all that
/// is large both ways.
pub(super) fn widths(mesh: &Mesh) -> Vec<f64> {
    let mut vertices: HashMap<[u64; 3], usize> = HashMap::new();
    let mut parents: Vec<usize> = (0..mesh.len()).collect();
    for (number, corners) in mesh.triangles().iter().enumerate() {
        for &corner in corners {
            let place = mesh.positions()[corner as usize].map(|x| (x + 0.0).to_bits());
            let other = *vertices.entry(place).or_insert(number);
            let (a, b) = (root(&mut parents, number), root(&mut parents, other));
            parents[a.max(b)] = a.min(b);
        }
    }
    let mut parts: HashMap<usize, Part> = HashMap::new();
    let roots: Vec<usize> = (0..mesh.len()).map(|n| root(&mut parents, n)).collect();
    for (number, root) in roots.iter().enumerate() {
        let [a, b, c] = Surface::corners(mesh, number);
        let part = parts.entry(*root).or_insert(Part {
            low: a,
            high: a,
            area: 0.0,
        });
        part.low = part.low.min(a).min(b).min(c);
        part.high = part.high.max(a).max(b).max(c);
        part.area += (b - a).cross(c - a).length() / 2.0;
    }
    let width = |part: &Part| part.area / (part.high - part.low).length();
    roots.iter().map(|root| width(&parts[root])).collect()
}

struct Part {
    low: glam::DVec3,
    high: glam::DVec3,
    area: f64,
}

fn root(parents: &mut [usize], mut of: usize) -> usize {
    while parents[of] != of {
        parents[of] = parents[parents[of]];
        of = parents[of];
    }
    of
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshBuilder;

    #[test]
    fn a_leaf_is_as_wide_as_its_smaller_side() {
        let mut builder = MeshBuilder::new();
        // A strip of 1 by 8 in four parts of two triangles that share edges, and a far triangle.
        for i in 0..5 {
            for y in [0.0, 1.0] {
                builder.position([2.0 * i as f32, y, 0.0]);
            }
        }
        for i in 0..4u32 {
            let [a, b] = [2 * i, 2 * i + 2];
            builder.triangle([a, b, b + 1], None, 0).unwrap();
            builder.triangle([a, b + 1, a + 1], None, 0).unwrap();
        }
        let far = [[50.0, 0.0, 0.0], [50.0, 3.0, 0.0], [50.0, 0.0, 4.0]];
        let corners = far.map(|p| builder.position(p));
        builder.triangle(corners, None, 0).unwrap();
        let widths = widths(&builder.finish("strip").unwrap());
        for width in &widths[..8] {
            assert!((width - 8.0 / libm::sqrt(65.0)).abs() < 1e-9);
        }
        assert!((widths[8] - 6.0 / 5.0).abs() < 1e-9);
    }
}
