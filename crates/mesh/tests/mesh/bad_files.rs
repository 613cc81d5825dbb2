//! Damaged files are refused or repaired with a message, and never cause a panic.

use proptest::prelude::*;
use serde_json::json;
use shiftvox_mesh::MeshFormat::{self, Glb, Gltf, Obj, Ply, Stl};

use super::shapes::{glb, gltf_json, load, ply_header, square_buffer, square_json, squares};

/// Rows: kind, content, part of the error. `.obj` files begin with three vertices, and `.ply` files with a header of as
/// many vertices as stated and a face. Of a sound glTF document, one place gets another value. Kinds in capitals are
/// whole files.
const FAULTS: &str = r#"
obj  | # c\nv 0 0\n                           | vertex at line 5: expected "v x y z"
obj  | v 1 \\n0 0\nv 0 1 x\n                    | vertex at line 6: expected
obj  | f 1 1 x\n                              | face at line 4: expected "f" and corners such as
obj  | f 1 2 3\nf 1 2 4\nf 1 2 3\n            | face at line 5: expected a corner from 1 to 3, counted up to there, found 4; the file is cut
obj  | f 1 2 0\n                              | face at line 4: expected a corner from 1 to 3
obj  | f 1 2 -4\n                             | face at line 4: expected a corner from 1 to 3
obj  | vt 0 0\nf 1/-12 2/1 3/1\n              | face at line 5: expected a corner from 1 to 1, counted up to there, found -12
obj  | f 1 2 3\nf 2 3                         | face at line 5: expected three or more corners of one form in the last line, which has no end, found "f 2 3"; the file is cut
obj  | vn 0 0 1\nf 1//1 2//1 3//1\nf 1//1 3/  | face at line 6: expected three
obj  |                                        | mesh: expected at least one triangle, found none; 
obj  | v nan 0 0\nv inf 0 0\nf 3 4 5\n        | found none that can be drawn: 1 of 1 triangles with a coordinate that is infinite or not a number
obj  | v 2 0 0\nf 1 2 4\nf 1 1 2\n            | mesh: expected at least one triangle, found none that can be drawn: 2 of 2 triangles without area (corners equal, or on a line); export the mesh again, with its faces
ply  | ascii 3: 0 0 0\n1 0 0\n1 1 0\n3 0 1 3\n  | face 0 at byte 182: expected corners from 0 to 2, found 3
ply  | ascii 3: 0 0 0\n1 0 0\n1 1 0\n3 0 -1 2\n | expected corners from 0 to 2, found -1
ply  | ascii 3: 0 0 0\n1 0 0\n                | vertex 2 at byte 176: expected as many elements as the header says
ply  | ascii 3: 0 0 0\n1 0 0\n1 1 0\n9 0 1 2\n | face 0 at byte
ply  | ascii 3: 0 0 0\n1 0 0\n1 1 0\n0\n      | expected at least one triangle
ply  | binary_little_endian 4000000000: abc   | vertex 0 at byte 188: expected as many elements as the header says
PLY  | ply\nformat ascii 2.0\n                | header
PLY  | ply\n                                  | header
PLY  | ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int y\nproperty int z\nelement vertex 1\nproperty int x\nend_header\n1 2 3\n4\n | at least one triangle
STL  | solid a\nfacet x\n                     | triangle 1: expected "facet normal
STL  | solid a\nendsolid a\nsolid b\nfacet x\n | triangle 1: expected "facet normal
STL  | solid a\nendsolid a\n                  | at least one triangle
STL  | 7777777777777777777777777777777777777777777777777777777777777777777777777777777777777 | 46318274834 bytes in all for the 926365495 triangles
STL  | solid a\0\0\n                           | header at byte 0: expected 84 bytes, found 10 bytes
STL  | 77777777777777777777                   | header at byte 0: expected 84 bytes, found 20 bytes; the file is cut short or damaged
gltf | /asset/version: "1.0"                  | asset: expected version 2, found 1.0
gltf | /accessors/0/count: 400000000000       | accessor 0: expected 400000000000 elements of 12 bytes
gltf | /accessors/0/count: 18446744073709551615 | accessor 0: expected 18446744073709551615 elements
gltf | /accessors/0/type: "VEC2"              | accessor 0: expected positions as VEC3
gltf | /accessors/0/count: 3                  | mesh 0: expected indices from 0 to 2, found 3
gltf | /accessors/1/componentType: 5126       | accessor 1: expected 6 elements of 4 bytes
gltf | /bufferViews/1/byteOffset: 18446744073709551615 | expected a buffer view within its buffer
gltf | /buffers/0/byteLength: 61              | buffer 0: expected 61 bytes, found 60
gltf | /buffers/0/uri: "a b.bin"              | buffer 0: expected the file "a b.bin" beside the mesh
gltf | /scenes/0/nodes: [0, 7]                | node 7: expected a node of this number
gltf | /nodes/0: {"mesh": 0, "children": [0]} | node 0: expected one parent, in a tree
gltf | /extensionsRequired: ["KHR_draco"]     | extensionsRequired: expected no extension that has to be understood, found KHR_draco
gltf | /extensionsRequired: ["KHR_draco_mesh_compression"] | found KHR_draco_mesh_compression; unpack it: gltf-transform cp IN OUT
gltf | /extensionsUsed: ["KHR_draco_mesh_compression"] | accessor 0: expected a buffer view within its buffer, found that of KHR_draco_mesh_compression; unpack it: gltf-transform cp IN OUT
gltf | /extensionsUsed: ["EXT_other"]         | found none
gltf | /accessors/0: {"componentType": 5126, "count": 4, "type": "VEC3", "sparse": {"count": 2, "indices": {"bufferView": 1, "byteOffset": 4, "componentType": 5123}, "values": {"bufferView": 0}}} | accessor 0: expected sparse indices in ascending order, below its count
gltf | /accessors/0: {"componentType": 5126, "count": 4, "type": "VEC3", "sparse": {"count": 9, "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 0}}} | accessor 0: expected 9 elements of 2 bytes
gltf | /accessors/0: {"componentType": 5126, "count": 1000000000000000000, "type": "VEC3", "sparse": {"count": 0, "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 0}}} | at most 16 triangles for a byte of the file
gltf | /nodes/0: {"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"SCALE": 9}}}} | accessor 9: expected an accessor of this number
PLY  | ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int y\nproperty int z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n1 2 3\n2 0 7\n | tristrips 0 at byte 157: expected corners from 0 to 0, found 7
GLTF | {"asset": {"version": "1.0"}, "meshes": {}} | expected a sequence at line 1 column 40; export as glTF 2.0
GLTF | {"asset":                              | JSON at line 1: expected glTF 2.0
GLB  | glTFxx                                 | header at byte 0: expected 12 bytes
GLB  | glTF\1\0\0\0\0\0\0\0                 | header at byte 4: expected version 2, found 1; export as glTF 2.0
"#;

fn file(kind: &str, content: &str) -> (MeshFormat, Vec<u8>) {
    let text = content
        .replace("\\n", "\n")
        .replace("\\0", "\0")
        .replace("\\1", "\u{1}");
    match kind {
        "obj" => (Obj, ["v 0 0 0\nv 1 0 0\nv 1 1 0\n", &text].concat().into()),
        "ply" => {
            let (header, body) = text.split_once(": ").unwrap();
            let (encoding, vertices) = header.split_once(' ').unwrap();
            let vertices = vertices.parse().unwrap();
            let header = ply_header(encoding, vertices, "", "int vertex_indices");
            (Ply, (header + body).into())
        }
        "gltf" => {
            let mut json = square_json();
            json["extensionsRequired"] = json!([]);
            let (place, value) = content.split_once(": ").unwrap();
            if place == "/extensionsUsed" {
                json["extensionsUsed"] = json!([]);
                json["accessors"][0]["bufferView"].take();
            }
            *json.pointer_mut(place).unwrap() = value.parse().unwrap();
            (Gltf, json.to_string().into())
        }
        "PLY" => (Ply, text.into()),
        "STL" => (Stl, text.into()),
        "GLTF" => (Gltf, text.into()),
        _ => (Glb, text.into()),
    }
}

#[test]
fn errors_name_the_fault_and_its_place() {
    let rows = FAULTS.lines().skip(1).map(|row| {
        let cells: Vec<&str> = row.splitn(3, '|').map(str::trim).collect();
        (file(cells[0], cells[1]), cells[2])
    });
    let mut cut = glb(&gltf_json("").to_string(), &square_buffer());
    cut.pop();
    let cut = ((Glb, cut), "header at byte 8");
    for ((format, bytes), expected) in rows.chain([cut]) {
        let found =
            load(&bytes, format).map_or_else(|error| error.to_string(), |_| "a mesh".into());
        let file = bytes.escape_ascii();
        assert!(
            found.starts_with("a file: ") && found.contains(expected),
            "{file}\n  expected: {expected}\n  found:    {found}"
        );
    }
}

#[test]
fn a_small_gltf_file_cannot_fill_the_memory() {
    // Two thousand nodes show two thousand squares, or parts that are passed over, each.
    for mode in [4, 0] {
        let mut json = square_json();
        json["nodes"] = json!(vec![json!({"mesh": 0}); 2000]);
        json["scenes"] = json!([{"nodes": (0..2000).collect::<Vec<u32>>()}]);
        let primitives = &mut json["meshes"][0]["primitives"];
        primitives[0]["mode"] = json!(mode);
        *primitives = json!(vec![primitives[0].clone(); 2000]);
        let error = load(json.to_string().as_bytes(), Gltf).unwrap_err();
        assert!(error.is_limit(), "{error}");
    }
}

/// Numbers, or values in place of them.
const NUMBERS: [&str; 6] = [
    "18446744073709551615",
    "-1",
    "1e308",
    "4294967295",
    "null",
    "{}",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn damaged_files_are_read_or_refused(
        which in 0usize..8,
        damages in prop::collection::vec((any::<prop::sample::Index>(), 0..5u8, any::<u8>(), any::<bool>()), 1..6),
    ) {
        let (_, format, mut bytes) = squares().swap_remove(which);
        for (place, kind, byte, is_digit) in damages {
            let at = place.index(bytes.len());
            let byte = if is_digit { b"0123456789-./e "[usize::from(byte) % 15] } else { byte };
            match kind {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                2 if at > 9 => bytes.truncate(at),
                3 => {
                    let is_other = |byte: &&u8| !byte.is_ascii_digit();
                    let begin = at + bytes[at..].iter().take_while(is_other).count();
                    let digits = bytes[begin..].iter().take_while(|b| b.is_ascii_digit()).count();
                    let number = NUMBERS[usize::from(byte) % 6];
                    bytes.splice(begin..begin + digits, number.bytes());
                }
                _ => drop(bytes.remove(at)),
            }
        }
        if let Ok(mesh) = load(&bytes, format) {
            prop_assert!(mesh.triangles().iter().flatten().all(|&i| (i as usize) < mesh.positions().len()));
            let (low, high) = mesh.bounds();
            prop_assert!(low.is_finite() && high.is_finite());
        }
    }
}
