//! Files by hand: one square in every format.
#![allow(
    unreachable_pub,
    reason = "a module of test crates, and of a fuzz target"
)]

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use shiftvox::graph::Silent;
use shiftvox_mesh::{self, ColorSpace, Mesh, MeshFormat, SceneError, no_files};

/// Reads a mesh without other files.
pub fn load(bytes: &[u8], format: MeshFormat) -> Result<Mesh, SceneError> {
    let colors = ColorSpace::default();
    shiftvox_mesh::read(bytes, format, "a file", &no_files, colors, &Silent)
}

pub const CORNERS: [[f32; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
];

/// One square in every format and encoding: two triangles in the plane z = 0, from (0, 0) to (1, 1).
pub fn squares() -> Vec<(&'static str, MeshFormat, Vec<u8>)> {
    let obj = "o square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1 4//1\n";
    let stl = "\u{feff} SOLID s\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 1 1 0\n\
        endloop\n endfacet\n FACET NORMAL 0 0 1\n  OUTER LOOP\n   VERTEX 0 0 0\n   VERTEX 1 1 0\n\
        VERTEX 0 1 0\n  ENDLOOP\n ENDFACET\nendsolid s\n";
    let ply = ply_header("ascii", 4, "", "int vertex_indices")
        + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
    let gltf = square_json().to_string();
    let in_glb = glb(&gltf_json("").to_string(), &square_buffer());
    vec![
        ("obj", MeshFormat::Obj, obj.into()),
        ("ply text", MeshFormat::Ply, ply.into_bytes()),
        (
            "ply little",
            MeshFormat::Ply,
            binary_ply("binary_little_endian", f32::to_le_bytes, u32::to_le_bytes),
        ),
        (
            "ply big",
            MeshFormat::Ply,
            binary_ply("binary_big_endian", f32::to_be_bytes, u32::to_be_bytes),
        ),
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

fn binary_ply(encoding: &str, real: fn(f32) -> [u8; 4], whole: fn(u32) -> [u8; 4]) -> Vec<u8> {
    let colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    let mut bytes = ply_header(encoding, 4, colors, "uint vertex_index").into_bytes();
    for corner in CORNERS {
        bytes.extend(corner.map(real).as_flattened());
        bytes.extend([255, 0, 10]);
    }
    bytes.push(4);
    bytes.extend([0, 1, 2, 3].map(whole).as_flattened());
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
    let positions = CORNERS.map(|corner| corner.map(f32::to_le_bytes).concat());
    let indices = [0, 1, 2, 0, 2, 3].map(u16::to_le_bytes);
    [positions.concat(), indices.concat()].concat()
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

pub fn square_json() -> Value {
    gltf_json(&data_uri(&square_buffer()))
}

/// Bytes as an address.
pub fn data_uri(bytes: &[u8]) -> String {
    "data:application/octet-stream;base64,".to_owned() + &STANDARD.encode(bytes)
}

/// A binary file of a document and its buffer.
pub fn glb(json: &str, buffer: &[u8]) -> Vec<u8> {
    // As some programs fill up.
    let json = json.to_owned() + &"\0".repeat(json.len().wrapping_neg() % 4);
    let word = |n: usize| (n as u32).to_le_bytes();
    let length = word(12 + 8 + json.len() + 8 + buffer.len());
    let mut bytes = [*b"glTF", word(2), length].concat();
    for (kind, content) in [(b"JSON", json.as_bytes()), (b"BIN\0", buffer)] {
        bytes.extend(word(content.len()));
        bytes.extend(kind);
        bytes.extend(content);
    }
    bytes
}
