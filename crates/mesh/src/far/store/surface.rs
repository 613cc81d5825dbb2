//! Triangles of a node as they are stored (`spec/far.md`, Surface). Shared vertices are exact, so that no gap opens.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use crate::far::record::{
    LeafTriangle, MOST_COLORS, Node, OWN_BYTES, SHARED_BYTES, SurfaceColumns,
};
use crate::geometry::{plane_normal, point};
use crate::texture::paint::{PAINT_BYTES, Paint};
use shiftvox::graph::PackedNormal;

const STEPS: f64 = 65535.0;

struct Lattice {
    low: DVec3,
    high: Vec3,
    step: DVec3,
}

impl Lattice {
    fn of(node: &Node) -> Self {
        let [low, high] = [node.low, node.high].map(point);
        Self {
            low,
            high: high.as_vec3(),
            step: (high - low) / STEPS,
        }
    }

    fn nearest(&self, position: [f32; 3]) -> [u16; 3] {
        let at = point(position) - self.low;
        [0, 1, 2].map(|k| match self.step[k] > 0.0 {
            true => (at[k] / self.step[k] + 0.5) as u16,
            false => 0,
        })
    }

    fn point(&self, place: [u16; 3]) -> [f32; 3] {
        let steps = point(place);
        let point = (self.low + steps * self.step).as_vec3();
        point.max(self.low.as_vec3()).min(self.high).to_array()
    }
}

pub(in crate::far) fn flat_normal(corners: &[[f32; 3]; 3]) -> u16 {
    PackedNormal::encode(plane_normal(corners.map(point))).0
}

type Key = ([u32; 3], u16, [u8; 3]);

/// Sets the counts of a node, which has its box, and gives the bytes.
pub(in crate::far) fn lay_out(
    node: &mut Node,
    triangles: &[LeafTriangle],
    is_shared: impl Fn([f32; 3]) -> bool,
) -> Vec<u8> {
    let is_flat = |triangle: &LeafTriangle| triangle.normals == [flat_normal(&triangle.corners); 3];
    let is_flat = triangles.iter().all(is_flat);
    let lattice = Lattice::of(node);
    let mut numbers: [HashMap<Key, u32>; 2] = Default::default();
    let mut vertices: [Vec<Key>; 2] = Default::default();
    let mut codes: Vec<u32> = Vec::with_capacity(3 * triangles.len());
    for triangle in triangles {
        for k in 0..3 {
            let position = triangle.corners[k];
            let shared = is_shared(position);
            let place = match shared {
                true => position.map(f32::to_bits),
                false => lattice.nearest(position).map(u32::from),
            };
            let normal = if is_flat { 0 } else { triangle.normals[k] };
            let key = (place, normal, triangle.colors[k]);
            let list = &mut vertices[usize::from(shared)];
            let next = list.len() as u32;
            let number = *numbers[usize::from(shared)].entry(key).or_insert(next);
            if number == next {
                list.push(key);
            }
            codes.push((next - number) << 1 | u32::from(shared));
        }
    }
    let mut colors: Vec<[u8; 3]> = Vec::new();
    let mut color_numbers: HashMap<[u8; 3], usize> = HashMap::new();
    for &(.., color) in vertices.iter().flatten() {
        color_numbers.entry(color).or_insert_with(|| {
            colors.push(color);
            colors.len() - 1
        });
    }
    if colors.len() > MOST_COLORS {
        colors.clear();
    }
    node.vertices = [0, 1].map(|list| vertices[list].len() as u32);
    node.surface = triangles.len() as u32;
    node.colors = colors.len() as u16;
    node.is_flat = u8::from(is_flat);
    node.is_painted = u8::from(triangles.iter().any(|t| t.paint != Paint::NONE));
    let columns = SurfaceColumns::of(node);
    let mut bytes = colors.concat();
    let [own, shared] = &vertices;
    planes(&mut bytes, own, OWN_BYTES, |(place, ..), byte| {
        place[byte / 2].to_le_bytes()[byte % 2]
    });
    planes(&mut bytes, shared, SHARED_BYTES, |(place, ..), byte| {
        place[byte / 4].to_le_bytes()[byte % 4]
    });
    let all: Vec<Key> = vertices.concat();
    planes(&mut bytes, &all, columns.normal, |(_, normal, _), byte| {
        normal.to_le_bytes()[byte]
    });
    planes(
        &mut bytes,
        &all,
        columns.color,
        |(.., color), byte| match columns.color {
            1 => color_numbers[color] as u8,
            _ => color[byte],
        },
    );
    planes(&mut bytes, &codes, columns.index, |code, byte| {
        code.to_le_bytes()[byte]
    });
    planes(&mut bytes, triangles, columns.paint, |triangle, byte| {
        triangle.paint.to_bytes()[byte]
    });
    bytes
}

fn planes<T>(out: &mut Vec<u8>, items: &[T], bytes: usize, byte_of: impl Fn(&T, usize) -> u8) {
    for byte in 0..bytes {
        out.extend(items.iter().map(|item| byte_of(item, byte)));
    }
}

fn take<const N: usize>(bytes: &mut &[u8], count: usize, width: usize) -> Vec<[u8; N]> {
    let (own, rest) = bytes.split_at(count * width);
    *bytes = rest;
    let mut items = vec![[0; N]; count];
    for (byte, plane) in own.chunks_exact(count.max(1)).enumerate() {
        for (item, &value) in items.iter_mut().zip(plane) {
            item[byte] = value;
        }
    }
    items
}

/// The triangles of a node, of as many bytes as it says; `None` where they were not laid out so.
pub(super) fn read(node: &Node, mut bytes: &[u8]) -> Option<Vec<LeafTriangle>> {
    let columns = SurfaceColumns::of(node);
    let [own, shared] = node.vertices.map(|count| count as usize);
    let lattice = Lattice::of(node);
    let colors: Vec<[u8; 3]> = {
        let (table, rest) = bytes.split_at(usize::from(node.colors) * 3);
        bytes = rest;
        table.as_chunks::<3>().0.to_vec()
    };
    let steps = take::<OWN_BYTES>(&mut bytes, own, OWN_BYTES);
    let singles = take::<SHARED_BYTES>(&mut bytes, shared, SHARED_BYTES);
    let steps = steps
        .iter()
        .map(|b| lattice.point([0, 1, 2].map(|k| u16::from_le_bytes([b[2 * k], b[2 * k + 1]]))));
    let singles = singles
        .iter()
        .map(|b| [0, 4, 8].map(|k| f32::from_le_bytes([b[k], b[k + 1], b[k + 2], b[k + 3]])));
    let positions: Vec<[f32; 3]> = steps.chain(singles).collect();
    let normals = take::<2>(&mut bytes, own + shared, columns.normal);
    let tints = take::<3>(&mut bytes, own + shared, columns.color);
    let codes = take::<4>(&mut bytes, node.surface as usize * 3, columns.index);
    let paints = take::<PAINT_BYTES>(&mut bytes, node.surface as usize, columns.paint);
    let color_of = |vertex: usize| match columns.color {
        0 => colors.first().copied(),
        1 => colors.get(usize::from(tints[vertex][0])).copied(),
        _ => Some(tints[vertex]),
    };
    let mut next = [0; 2];
    let mut vertex_of = |code: [u8; 4]| {
        let code = u32::from_le_bytes(code);
        let list = (code & 1) as usize;
        let back = (code >> 1) as usize;
        let number = usize::checked_sub(next[list], back)?;
        if back == 0 {
            next[list] += 1;
        }
        let count = [own, shared][list];
        (number < count).then_some(number + list * own)
    };
    let mut triangles = Vec::with_capacity(codes.len() / 3);
    for (codes, paint) in codes.as_chunks::<3>().0.iter().zip(&paints) {
        let mut triangle = LeafTriangle {
            corners: [[0.0; 3]; 3],
            normals: [0; 3],
            colors: [[0; 3]; 3],
            paint: match columns.paint {
                0 => Paint::NONE,
                _ => Paint::from_bytes(paint)?,
            },
        };
        for k in 0..3 {
            let vertex = vertex_of(codes[k])?;
            triangle.corners[k] = positions[vertex];
            triangle.normals[k] = u16::from_le_bytes(normals[vertex]);
            triangle.colors[k] = color_of(vertex)?;
        }
        if columns.normal == 0 {
            triangle.normals = [flat_normal(&triangle.corners); 3];
        }
        triangles.push(triangle);
    }
    (next == [own, shared]).then_some(triangles)
}
