//! Files by hand: one square in every format.
#![expect(unreachable_pub, reason = "a module of test crates")]

use serde_json::{Value, json};
use shiftvox::graph::Silent;
use shiftvox_mesh::{self, LoadOptions, Mesh, MeshFormat, Nothing, SceneError};

pub(crate) use super::gltf_bytes::{data_uri, glb};

/// Reads a mesh without other files.
pub fn load(bytes: &[u8], format: MeshFormat) -> Result<Mesh, SceneError> {
    let options = LoadOptions::default();
    shiftvox_mesh::read(bytes, format, "a file", &Nothing, &options, &Silent)
}

const CORNERS: [[f32; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
];

/// One square in every format and encoding: two triangles in the plane z = 0, from (0, 0) to (1, 1).
pub fn squares() -> Vec<(&'static str, MeshFormat, Vec<u8>)> {
    let obj = "o square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1 4//1\n";
    let stl = "solid s\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 1 1 0\n\
        endloop\n endfacet\n FACET NORMAL 0 0 1\n  OUTER LOOP\n   VERTEX 0 0 0\n   VERTEX 1 1 0\n\
        VERTEX 0 1 0\n  ENDLOOP\n ENDFACET\nendsolid s\n";
    let ply = ply_header("ascii", 4, "", "int vertex_indices")
        + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
    let gltf = gltf_json(&data_uri(&square_buffer())).to_string();
    let in_glb = glb(&gltf_json("").to_string(), &square_buffer());
    vec![
        ("obj", MeshFormat::Obj, obj.into()),
        ("ply text", MeshFormat::Ply, ply.into_bytes()),
        ("ply little", MeshFormat::Ply, binary_ply(false)),
        ("ply big", MeshFormat::Ply, binary_ply(true)),
        ("stl text", MeshFormat::Stl, stl.into()),
        ("stl binary", MeshFormat::Stl, binary_stl()),
        ("gltf", MeshFormat::Gltf, gltf.into_bytes()),
        ("glb", MeshFormat::Glb, in_glb),
    ]
}

/// The header of a `.ply` file with one face.
pub fn ply_header(encoding: &str, vertices: u64, colors: &str, list: &str) -> String {
    format!(
        "ply\nformat {encoding} 1.0\ncomment c\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
        property float z\n{colors}element face 1\nproperty list uchar {list}\nend_header\n"
    )
}

fn binary_ply(is_big: bool) -> Vec<u8> {
    let ordered = |mut bytes: [u8; 4]| {
        if is_big {
            bytes.reverse();
        }
        bytes
    };
    let encoding = format!("binary_{}_endian", if is_big { "big" } else { "little" });
    let colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    let mut bytes = ply_header(&encoding, 4, colors, "uint vertex_index").into_bytes();
    for corner in CORNERS {
        bytes.extend(corner.map(|c| ordered(c.to_le_bytes())).as_flattened());
        bytes.extend([255, 0, 10]);
    }
    bytes.push(4);
    bytes.extend((0..4u32).flat_map(|i| ordered(i.to_le_bytes())));
    bytes
}

fn binary_stl() -> Vec<u8> {
    // Some exporters begin the header as a text begins.
    let mut bytes = b"solid but binary".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(2u32.to_le_bytes());
    for triangle in [[0, 1, 2], [0, 2, 3]] {
        bytes.extend([0u8; 12]);
        let corners = triangle.map(|i: usize| CORNERS[i]);
        bytes.extend(corners.as_flattened().iter().flat_map(|c| c.to_le_bytes()));
        bytes.extend([0u8; 2]);
    }
    bytes
}

/// Four positions, then six indices of 16 bits.
pub fn square_buffer() -> Vec<u8> {
    let positions = CORNERS.iter().flatten().flat_map(|c| c.to_le_bytes());
    let indices = [0u16, 1, 2, 0, 2, 3];
    positions
        .chain(indices.iter().flat_map(|i| i.to_le_bytes()))
        .collect()
}

/// A document of the square. Its buffer is at an address, or in the file where that is empty.
pub fn gltf_json(uri: &str) -> Value {
    let mut json = json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"name": "red", "pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1]}}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 12},
        ],
        "buffers": [{"byteLength": 60}],
    });
    if !uri.is_empty() {
        json["buffers"][0]["uri"] = uri.into();
    }
    json
}
