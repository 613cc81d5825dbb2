//! Meshes with known answers, and files written by hand.
#![expect(unreachable_pub, reason = "a module of a test crate")]

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox_mesh::{
    self, LoadOptions, Material, Mesh, MeshBuilder, MeshFormat, Nothing, SceneError,
};

pub(crate) use super::gltf_bytes::{data_uri, glb};

/// A mesh of one material.
pub fn mesh_of(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Mesh {
    let mut builder = MeshBuilder::new();
    builder.material(Material::of_srgb("grey", [90, 120, 150]));
    for &position in positions {
        builder.position(position);
    }
    for &triangle in triangles {
        builder.triangle(triangle, None, 0).unwrap();
    }
    builder.finish("a shape").unwrap()
}

/// A box, its faces two triangles each, outside counter-clockwise.
pub fn cuboid(low: [f32; 3], high: [f32; 3]) -> Mesh {
    let positions: Vec<[f32; 3]> = (0..8u32)
        .map(|i| {
            std::array::from_fn(|k| {
                if i >> (2 - k) & 1 == 1 {
                    high[k]
                } else {
                    low[k]
                }
            })
        })
        .collect();
    let faces = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ];
    let triangles: Vec<[u32; 3]> = faces
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    mesh_of(&positions, &triangles)
}

/// A closed surface of rings around the z axis, through places and radii.
pub fn turned(profile: &[(f64, f64)], around: u32) -> Mesh {
    let (first, last) = (profile[0], profile[profile.len() - 1]);
    let mut positions = vec![[0.0, 0.0, first.0 as f32]];
    let rings = &profile[1..profile.len() - 1];
    for &(z, radius) in rings {
        for i in 0..around {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(around);
            positions.push([
                (radius * angle.cos()) as f32,
                (radius * angle.sin()) as f32,
                z as f32,
            ]);
        }
    }
    positions.push([0.0, 0.0, last.0 as f32]);
    let end = positions.len() as u32 - 1;
    let at = |ring: u32, i: u32| 1 + ring * around + i % around;
    let mut triangles = Vec::new();
    for i in 0..around {
        triangles.push([0, at(0, i + 1), at(0, i)]);
        for ring in 1..rings.len() as u32 {
            let (a, b) = (at(ring - 1, i), at(ring - 1, i + 1));
            let (c, d) = (at(ring, i), at(ring, i + 1));
            triangles.extend([[a, b, d], [a, d, c]]);
        }
        let ring = rings.len() as u32 - 1;
        triangles.push([at(ring, i), at(ring, i + 1), end]);
    }
    mesh_of(&positions, &triangles)
}

/// A ball of radius 1 around the origin.
pub fn ball(steps: u32) -> Mesh {
    let profile: Vec<(f64, f64)> = (0..=steps)
        .map(|i| {
            let angle = std::f64::consts::PI * f64::from(i) / f64::from(steps);
            (-angle.cos(), angle.sin())
        })
        .collect();
    turned(&profile, 2 * steps)
}

/// Reads a mesh without other files.
pub fn load(bytes: &[u8], format: MeshFormat) -> Result<Mesh, SceneError> {
    shiftvox_mesh::read(
        bytes,
        format,
        "a file",
        &Nothing,
        &LoadOptions::default(),
        &Silent,
    )
}

/// The corners of all triangles.
pub fn soup(mesh: &Mesh) -> Vec<[[f32; 3]; 3]> {
    let corner = |i: u32| mesh.positions()[i as usize].map(|c| c as f32);
    mesh.triangles().iter().map(|t| t.map(corner)).collect()
}

/// The seven cases are the file formats with their encodings: one square each,
/// of two triangles in the plane z = 0, from (0, 0) to (1, 1).
pub fn squares() -> Vec<(&'static str, MeshFormat, Vec<u8>)> {
    vec![
        ("obj", MeshFormat::Obj, b"o square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1 4//1\n".to_vec()),
        ("ply text", MeshFormat::Ply, b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n".to_vec()),
        ("ply little", MeshFormat::Ply, binary_ply(false)),
        ("ply big", MeshFormat::Ply, binary_ply(true)),
        ("stl text", MeshFormat::Stl, b"solid s\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 1 1 0\n  endloop\n endfacet\n FACET NORMAL 0 0 1\n  OUTER LOOP\n   VERTEX 0 0 0\n   VERTEX 1 1 0\n   VERTEX 0 1 0\n  ENDLOOP\n ENDFACET\nendsolid s\n".to_vec()),
        ("stl binary", MeshFormat::Stl, binary_stl()),
        ("gltf", MeshFormat::Gltf, gltf_json(&data_uri(&square_buffer()), "").into_bytes()),
        ("glb", MeshFormat::Glb, glb(&gltf_json("", ""), &square_buffer())),
    ]
}

const CORNERS: [[f32; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
];

fn binary_ply(big: bool) -> Vec<u8> {
    let name = if big { "big" } else { "little" };
    let mut bytes = format!("ply\nformat binary_{name}_endian 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar uint vertex_index\nend_header\n").into_bytes();
    for corner in CORNERS {
        for c in corner {
            bytes.extend(if big {
                c.to_be_bytes()
            } else {
                c.to_le_bytes()
            });
        }
        bytes.extend([255, 0, 10]);
    }
    bytes.push(4);
    for i in 0..4u32 {
        bytes.extend(if big {
            i.to_be_bytes()
        } else {
            i.to_le_bytes()
        });
    }
    bytes
}

fn binary_stl() -> Vec<u8> {
    // The header begins as a text does, as some exporters have it.
    let mut bytes = b"solid but binary".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(2u32.to_le_bytes());
    for triangle in [[0, 1, 2], [0, 2, 3]] {
        bytes.extend([0u8; 12]);
        for i in triangle {
            bytes.extend(
                CORNERS[i as usize]
                    .iter()
                    .flat_map(|c: &f32| c.to_le_bytes()),
            );
        }
        bytes.extend([0u8; 2]);
    }
    bytes
}

/// Four positions, then six indices of 16 bits.
pub fn square_buffer() -> Vec<u8> {
    let positions = CORNERS.iter().flatten().flat_map(|c: &f32| c.to_le_bytes());
    let indices = [0u16, 1, 2, 0, 2, 3];
    positions
        .chain(indices.iter().flat_map(|i| i.to_le_bytes()))
        .collect()
}

/// A document of the square; its buffer at an address, or in the file where
/// that is empty; `node` is put into its node.
pub fn gltf_json(uri: &str, node: &str) -> String {
    let uri = if uri.is_empty() {
        String::new()
    } else {
        format!("\"uri\": \"{uri}\", ")
    };
    format!(
        "{{\"asset\": {{\"version\": \"2.0\"}}, \"scene\": 0, \"scenes\": [{{\"nodes\": [0]}}],
        \"nodes\": [{{{node}\"mesh\": 0}}],
        \"meshes\": [{{\"primitives\": [{{\"attributes\": {{\"POSITION\": 0}}, \"indices\": 1, \"material\": 0}}]}}],
        \"materials\": [{{\"name\": \"red\", \"pbrMetallicRoughness\": {{\"baseColorFactor\": [1, 0.5, 0, 1]}}}}],
        \"accessors\": [{{\"bufferView\": 0, \"componentType\": 5126, \"count\": 4, \"type\": \"VEC3\"}},
            {{\"bufferView\": 1, \"componentType\": 5123, \"count\": 6, \"type\": \"SCALAR\"}}],
        \"bufferViews\": [{{\"buffer\": 0, \"byteLength\": 48}}, {{\"buffer\": 0, \"byteOffset\": 48, \"byteLength\": 12}}],
        \"buffers\": [{{{uri}\"byteLength\": 60}}]}}"
    )
}

/// A point of the world.
pub fn point(position: [f32; 3]) -> DVec3 {
    DVec3::from_array(position.map(f64::from))
}
