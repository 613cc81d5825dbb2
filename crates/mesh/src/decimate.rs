//! Decimation: collapses the edges with the least quadric error first.
//!
//! The work is that of `meshoptimizer-rs`, whose results are those of meshoptimizer, bit by bit. A vertex is a
//! position, a material and a colour, so the borders between materials keep their place. Colours of textures, which
//! triangles have, become those of vertices.

use std::collections::HashMap;

use glam::DVec3;
use meshoptimizer_rs::{
    Attributes, Positions, SimplifyOptions, SimplifySettings, VertexFlags, Workspace,
    simplify_with_attributes,
};

use super::geometry::{plane_normal, point};
use super::material::{to_light, to_srgb};
use super::{Mesh, Surface};
use shiftvox::graph::PackedNormal;

/// How far a mesh is decimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Decimation {
    /// To so many triangles; more stay where nothing more can be collapsed. Small parts vanish.
    Count(usize),
    /// To the greatest distance from the mesh, in its units. Parts that are smaller stay.
    Error(f64),
}

/// Why a mesh was not decimated: it is too large for the library's limits of memory and work.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the mesh cannot be decimated: {0}")]
pub struct DecimateError(String);

/// The weight of a normal's change by its own length, in extents of the mesh, where triangles are counted. It equals
/// moving the surface by a hundredth of its extent.
const NORMAL_WEIGHT: f32 = 0.01;
const COLOR_WEIGHT: f32 = 0.1;
const FACES_ALIKE: f64 = 0.5;
const ATTRIBUTES: usize = 6;

type Key = (Place, u32, [u8; 3]);

type Place = [u64; 3];

/// Decimates a mesh; `None` where no triangle is left.
pub fn decimate(mesh: &Mesh, how: Decimation) -> Result<Option<Mesh>, DecimateError> {
    decimate_between(mesh, how, |_| None)
}

/// Decimates a part of a mesh. Positions that it shares with other parts stay. For these, `shared` gives the normals of
/// all triangles there, each as long as its triangle's area.
pub fn decimate_between<'n>(
    mesh: &Mesh,
    how: Decimation,
    shared: impl Fn([f64; 3]) -> Option<&'n [DVec3]>,
) -> Result<Option<Mesh>, DecimateError> {
    let mut vertices = Vertices::of(mesh);
    let mut flags = Vec::with_capacity(vertices.positions.len());
    for &position in &vertices.positions {
        let normals = shared(position);
        flags.push(match normals {
            Some(_) => VertexFlags::LOCK,
            None => VertexFlags::EMPTY,
        });
        if let Some(normals) = normals {
            vertices
                .normals
                .insert(place_of(position), normals.to_vec());
        }
    }
    let (low, high) = mesh.bounds();
    // The middle of the box, so that single precision suffices wherever the mesh lies.
    let near = |&position: &[f64; 3]| (point(position) - low).as_vec3().to_array();
    let near: Vec<[f32; 3]> = vertices.positions.iter().map(near).collect();
    let extent = (high - low).max_element();
    let absolute = SimplifyOptions::ERROR_ABSOLUTE;
    let (triangles, error, share, options) = match how {
        Decimation::Count(triangles) => {
            let options = absolute | SimplifyOptions::PRUNE;
            (triangles, 10.0 * extent, NORMAL_WEIGHT, options)
        }
        // A normal that turns by the distance's length is as wrong.
        Decimation::Error(error) => (0, error, (error / extent) as f32, absolute),
    };
    let weights = [[share; 3], [COLOR_WEIGHT; 3]];
    let failed = |error: meshoptimizer_rs::Error| DecimateError(error.to_string());
    let count = vertices.positions.len();
    let attributes = vertices.attributes.as_flattened();
    let attributes = Attributes::from_interleaved(attributes, count, ATTRIBUTES, ATTRIBUTES, 0);
    let simplified = simplify_with_attributes(
        &vertices.indices,
        Positions::from_packed(&near),
        attributes.map_err(failed)?,
        weights.as_flattened(),
        Some(&flags),
        SimplifySettings {
            target_index_count: (3 * triangles).min(vertices.indices.len()),
            target_error: error as f32,
            options,
        },
        &mut Workspace::default(),
    )
    .map_err(failed)?;
    Ok(vertices.mesh_of(mesh, &simplified.indices))
}

struct Vertices {
    positions: Vec<[f64; 3]>,
    attributes: Vec<[f32; ATTRIBUTES]>,
    keys: Vec<Key>,
    indices: Vec<u32>,
    normals: HashMap<Place, Vec<DVec3>>,
}

impl Vertices {
    fn of(mesh: &Mesh) -> Self {
        let mut numbers: HashMap<Key, u32> = HashMap::new();
        let mut all = Self {
            positions: Vec::new(),
            attributes: Vec::new(),
            keys: Vec::new(),
            indices: Vec::new(),
            normals: HashMap::new(),
        };
        let mut sums: Vec<DVec3> = Vec::new();
        let tints = tints(mesh);
        for (number, corners) in mesh.triangles.iter().enumerate() {
            let triangle = mesh.triangle(number);
            let [a, b, c] = triangle.corners;
            let area = (b - a).cross(c - a).length();
            for (k, &corner) in corners.iter().enumerate() {
                let position = mesh.positions[corner as usize];
                let place = place_of(position);
                let material = mesh.material_of[number];
                let color = mesh.vertex_colors.get(corner as usize);
                let mut color = color.copied().unwrap_or([255; 3]);
                if let Some(tint) = tints.get(&(place, material)) {
                    color = to_srgb(to_light(color) * *tint);
                }
                let key = (place, material, color);
                let vertex = *numbers.entry(key).or_insert_with(|| {
                    all.positions.push(position);
                    all.keys.push(key);
                    sums.push(DVec3::ZERO);
                    // Fewer than three for each of 2^32 triangles, of which a mesh has fewer.
                    (all.keys.len() - 1) as u32
                });
                all.indices.push(vertex);
                let normal = triangle.normals[k] * area;
                sums[vertex as usize] += normal;
                all.normals.entry(place).or_default().push(normal);
            }
        }
        let attributes = sums.iter().zip(&all.keys).map(|(sum, (.., color))| {
            let [x, y, z] = sum.normalize_or_zero().as_vec3().to_array();
            let [r, g, b] = color.map(|byte| f32::from(byte) / 255.0);
            [x, y, z, r, g, b]
        });
        all.attributes = attributes.collect();
        all
    }

    fn mesh_of(&self, mesh: &Mesh, indices: &[u32]) -> Option<Mesh> {
        let mut left = Mesh {
            materials: mesh.materials.clone(),
            ..Mesh::default()
        };
        let mut numbers: HashMap<u32, u32> = HashMap::new();
        for corners in indices.as_chunks::<3>().0 {
            let points = corners.map(|c| point(self.positions[c as usize]));
            if (points[1] - points[0]).cross(points[2] - points[0]) == DVec3::ZERO {
                continue;
            }
            let plane = plane_normal(points);
            let triangle = corners.map(|corner| {
                *numbers.entry(corner).or_insert_with(|| {
                    let (_, _, color) = self.keys[corner as usize];
                    left.positions.push(self.positions[corner as usize]);
                    if !mesh.vertex_colors.is_empty() || !mesh.tints.is_empty() {
                        left.vertex_colors.push(color);
                    }
                    (left.positions.len() - 1) as u32
                })
            });
            left.triangles.push(triangle);
            left.material_of.push(self.keys[corners[0] as usize].1);
            left.corner_normals.push(corners.map(|corner| {
                let normals = &self.normals[&self.keys[corner as usize].0];
                let alike = normals
                    .iter()
                    .filter(|normal| normal.dot(plane) >= FACES_ALIKE * normal.length());
                let mean = alike.copied().sum::<DVec3>().normalize_or(plane);
                mean.as_vec3().to_array()
            }));
        }
        (!left.triangles.is_empty()).then(|| {
            left.find_bounds();
            left
        })
    }
}

fn place_of(position: [f64; 3]) -> Place {
    position.map(|x| (x + 0.0).to_bits())
}

fn tints(mesh: &Mesh) -> HashMap<(Place, u32), DVec3> {
    let mut sums: HashMap<(Place, u32), (DVec3, f64)> = HashMap::new();
    for (number, &tint) in mesh.tints.iter().enumerate() {
        let [a, b, c] = Surface::corners(mesh, number);
        let area = (b - a).cross(c - a).length();
        for corner in mesh.triangles[number] {
            let place = place_of(mesh.positions[corner as usize]);
            let sum = sums.entry((place, mesh.material_of[number])).or_default();
            *sum = (sum.0 + point(tint) * area, sum.1 + area);
        }
    }
    let mean = |(key, (sum, area)): (_, (DVec3, f64))| {
        let is_some = area > 0.0;
        (key, if is_some { sum / area } else { DVec3::ONE })
    };
    sums.into_iter().map(mean).collect()
}

const STEPS: f64 = 65535.0;
/// Bytes of a compact mesh beside its lists: the box and three counts.
const HEADER: u64 = 6 * 4 + 3 * 4;

/// A mesh as an indexed buffer for drawing. Each vertex has a position in 16 bits per axis of the box, a normal in 16
/// bits and, where the mesh has colours, a colour.
///
/// Returns the rounded mesh and its size in bytes.
pub fn compact(mesh: &Mesh) -> (Mesh, u64) {
    let mut rounded = mesh.clone();
    let (low, high) = mesh.bounds();
    let step = (high - low) / STEPS;
    for position in rounded.positions.iter_mut() {
        for k in 0..3 {
            if step[k] > 0.0 {
                let steps = libm::round((position[k] - low[k]) / step[k]);
                position[k] = low[k] + steps * step[k];
            }
        }
    }
    if rounded.corner_normals.is_empty() {
        let plane = |number| [plane_normal(Surface::corners(mesh, number)); 3];
        let planes = (0..mesh.len()).map(plane);
        let planes = planes.map(|normals| normals.map(|normal| normal.as_vec3().to_array()));
        rounded.corner_normals = planes.collect::<Vec<_>>().into();
    }
    let mut vertices = std::collections::HashSet::new();
    let mut used = std::collections::HashSet::new();
    for (number, corners) in rounded.triangles.iter().enumerate() {
        used.insert(rounded.material_of[number]);
        for (&corner, normal) in corners.iter().zip(&mut rounded.corner_normals[number]) {
            let packed = PackedNormal::encode(point(*normal));
            if let Some(unit) = packed.decode() {
                *normal = unit.as_vec3().to_array();
            }
            let place = place_of(rounded.positions[corner as usize]);
            let color = rounded.vertex_colors.get(corner as usize).copied();
            vertices.insert((place, packed.0, color));
        }
    }
    rounded.find_bounds();
    let vertex = 6 + 2 + if mesh.vertex_colors.is_empty() { 0 } else { 3 };
    let index = if vertices.len() <= 1 << 16 { 2 } else { 4 };
    let material = match used.len() {
        ..=1 => 0,
        2..=256 => 1,
        _ => 2,
    };
    let bytes = HEADER
        + vertices.len() as u64 * vertex
        + rounded.triangles.len() as u64 * (3 * index + material)
        + used.len() as u64 * 3
        + rounded.tints.len() as u64 * 3;
    (rounded, bytes)
}
