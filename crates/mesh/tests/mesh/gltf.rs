//! glTF documents: each mode of primitives, type of numbers and place of nodes.

use std::cell::Cell;

use serde_json::{Value, json};
use shiftvox::graph::Silent;
use shiftvox_mesh::{ColorSpace, Mesh, MeshFormat, read};

use super::shapes::{CORNERS, data_uri, gltf_json, load, square_buffer, square_json};
use super::shared::{files_of, has, soup};

/// Parts of the square's document with other values, and the corners of all triangles.
const SCENES: &str = r#"
{} | 000 100 110, 000 110 010
{"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]} | 000 100 110
{"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 5}]}]} | 000 100 110, 110 100 010
{"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 5, "indices": 1}]}]} | 000 100 110, 110 100 000, 110 000 010
{"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 6}, {"attributes": {"POSITION": 0}, "mode": 1}]}]} | 000 100 110, 000 110 010
{"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 4}, {"attributes": {"POSITION": 0}, "mode": 4}]}]} | 000 100 110, 000 100 110
{"scene": 1, "scenes": [{"nodes": []}, {"nodes": [0]}]} | 000 100 110, 000 110 010
{"scene": null, "scenes": [{"nodes": [0]}, {"nodes": []}]} | 000 100 110, 000 110 010
{"nodes": [{"mesh": 0, "matrix": [2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1]}]} | 123 323 333, 123 333 133
{"nodes": [{"mesh": 0, "translation": [1, 2, 3], "rotation": [1, 1, 1, 1], "scale": [2, 1, 3]}]} | 123 143 144, 123 144 124
{"nodes": [{"mesh": 0, "translation": [2, 0, 0], "rotation": [0, 0, 0, 0], "scale": [-1, 1, 1]}]} | 200 110 100, 200 210 110
{"scenes": [], "nodes": [{"mesh": 0, "scale": [2, 2, 2]}, {"children": [2], "translation": [1, 1, 1]}, {"mesh": 0, "scale": [1, 3, 1]}]} | 000 200 220, 000 220 020, 111 211 241, 111 241 141
{"meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": null}}]}]} | 000 100 110
{"accessors": [{"componentType": 5126, "count": 4, "type": "VEC3", "sparse": {"count": 2, "indices": {"bufferView": 1, "byteOffset": 2, "componentType": 5123}, "values": {"bufferView": 0, "byteOffset": 12}}}, {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}]} | 000 100 110
{"accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "sparse": {"count": 2, "indices": {"bufferView": 1, "byteOffset": 2, "componentType": 5123}, "values": {"bufferView": 0, "byteOffset": 24}}}, {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}]} | 000 110 010
{"accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}, {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}, {"bufferView": 0, "byteOffset": 24, "componentType": 5126, "count": 2, "type": "VEC3"}], "extensionsRequired": ["EXT_mesh_gpu_instancing"], "nodes": [{"mesh": 0, "scale": [2, 1, 1], "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 2, "ROTATION": null}}}}]} | 210 410 420, 210 420 220, 010 210 220, 010 220 020
{"nodes": [{"children": [2, 1], "scale": [2, 1, 1]}, {"mesh": 0, "translation": [3, 0, 0]}, {"mesh": 0}, {"mesh": 0}]} | 000 200 210, 000 210 010, 600 800 810, 600 810 610
{"nodes": [{"children": [1, 3]}, {"extensions": {"KHR_node_visibility": {"visible": false}}, "children": [2]}, {"mesh": 0}, {"mesh": 0, "extensions": {"KHR_node_visibility": {}}}]} | 000 100 110, 000 110 010
"#;

#[test]
fn scenes_have_their_triangles_in_order() {
    for row in SCENES.lines().skip(1) {
        let (parts, expected) = row.split_once(" | ").unwrap();
        let mut json = square_json();
        let parts: Value = parts.parse().unwrap();
        for (key, value) in parts.as_object().unwrap() {
            json[key] = value.clone();
        }
        let mesh = mesh_of(&json);
        let corner = |corner: [f32; 3]| corner.map(|c| c.to_string()).concat();
        let triangles = soup(&mesh).into_iter().map(|t| t.map(corner).join(" "));
        assert_eq!(triangles.collect::<Vec<_>>().join(", "), expected, "{row}");
    }
}

fn mesh_of(json: &Value) -> Mesh {
    load(json.to_string().as_bytes(), MeshFormat::Gltf).unwrap()
}

/// The square with other elements for an accessor, which has gaps.
fn with(number: usize, accessor: Value, elements: &[Vec<u8>]) -> Mesh {
    let mut json = square_json();
    let gap = [0xee; 4];
    let bytes = elements
        .iter()
        .flat_map(|element| element.iter().chain(&gap));
    let bytes: Vec<u8> = gap.iter().chain(&gap).chain(bytes).copied().collect();
    json["buffers"] = json!([json["buffers"][0], {
        "uri": data_uri(&bytes).trim_end_matches('='), "byteLength": bytes.len(),
    }]);
    json["bufferViews"][number] = json!({
        "buffer": 1, "byteOffset": 4, "byteLength": bytes.len() - 4, "byteStride": elements[0].len() + 4,
    });
    let all = &mut json["accessors"][number];
    *all = accessor;
    all["bufferView"] = number.into();
    all["byteOffset"] = 4.into();
    all["count"] = elements.len().into();
    mesh_of(&json)
}

#[test]
fn numbers_of_all_types_are_read() {
    let square = soup(&mesh_of(&square_json()));
    let real = 1f32.to_le_bytes();
    let types: [(u32, bool, &[u8]); 9] = [
        (5126, false, &real),
        (5120, false, &[1]),
        (5120, true, &[127]),
        (5121, false, &[1]),
        (5121, true, &[255]),
        (5122, false, &[1, 0]),
        (5122, true, &[255, 127]),
        (5123, false, &[1, 0]),
        (5123, true, &[255, 255]),
    ];
    for (kind, normalized, one) in types {
        let zero = vec![0; one.len()];
        let number = |c: f32| if c > 0.0 { one } else { &zero };
        let elements = CORNERS.map(|corner| corner.map(number).concat());
        let accessor = json!({"componentType": kind, "normalized": normalized, "type": "VEC3"});
        assert_eq!(soup(&with(0, accessor, &elements)), square, "{kind}");
    }
    for (kind, width) in [(5121, 1), (5123, 2), (5125, 4)] {
        let elements = [0u32, 1, 2, 0, 2, 3].map(|i| i.to_le_bytes()[..width].to_vec());
        let accessor = json!({"componentType": kind, "type": "SCALAR"});
        assert_eq!(soup(&with(1, accessor, &elements)), square, "{kind}");
    }
    // Numbers with a sign, of which the least is no less than -1.
    for (normalized, x) in [(true, -1.0), (false, -128.0)] {
        let elements = [[0, 0, 0], [128, 0, 0], [0, 1, 0], [0, 0, 0]].map(|e| e.to_vec());
        let accessor = json!({"componentType": 5120, "normalized": normalized, "type": "VEC3"});
        assert_eq!(with(0, accessor, &elements).positions()[1][0], x);
    }
}

#[test]
fn normals_turn_and_colours_become_srgb() {
    let mut json = square_json();
    json["nodes"][0]["scale"] = json!([2, 1, 1]);
    json["meshes"][0]["primitives"][0]["attributes"] =
        json!({"POSITION": 0, "NORMAL": 0, "COLOR_0": 0});
    let mesh = mesh_of(&json);
    let colors = CORNERS.map(|corner| corner.map(|c| (255.0 * c) as u8));
    assert_eq!(mesh.vertex_colors(), colors);
    // A normal without length is that of the plane; (1, 1, 0) becomes (1/2, 1, 0).
    let slanted = [0.2f32.sqrt(), 0.8f32.sqrt(), 0.0];
    let expected = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], slanted];
    for (found, expected) in mesh.corner_normals()[0].iter().zip(expected) {
        assert!(
            (0..3).all(|k| (found[k] - expected[k]).abs() < 1e-6),
            "{found:?}"
        );
    }
    // The default material of the format is white.
    let primitive = json["meshes"][0]["primitives"][0].as_object_mut();
    primitive.unwrap().remove("material");
    let mesh = mesh_of(&json);
    let material = mesh.material_of()[0] as usize;
    assert_eq!(mesh.materials()[material].diffuse, [1.0; 3]);
}

#[test]
fn alpha_counts_by_its_mode() {
    let mut json = square_json();
    let material = |mode: &str, alpha: f64, cutoff: Value| {
        let color = json!({"baseColorFactor": [1, 1, 1, alpha]});
        json!({"alphaMode": mode, "alphaCutoff": cutoff, "pbrMetallicRoughness": color})
    };
    json["materials"] = json!([
        material("OPAQUE", 0.2, Value::Null),
        material("BLEND", 0.25, Value::Null),
        material("MASK", 0.5, Value::Null),
        material("MASK", 0.4, Value::Null),
        material("MASK", 0.4, json!(0.3)),
    ]);
    let mesh = mesh_of(&json);
    let alphas = mesh.materials().iter().map(|material| material.alpha);
    assert!(alphas.eq([1.0, 1.0, 0.25, 1.0, 0.0, 1.0]));
}

#[test]
fn what_is_not_drawn_is_warned_of() {
    let mut json = square_json();
    let transmission =
        |factor: f64| json!({"KHR_materials_transmission": {"transmissionFactor": factor}});
    json["materials"] = json!([
        {"alphaMode": "BLEND", "emissiveFactor": [0, 0.1, 0], "extensions": transmission(0.5)},
        {"emissiveFactor": [0, 0, 0], "extensions": transmission(0.0)},
        {"emissiveFactor": "odd", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}},
    ]);
    assert_eq!(mesh_of(&json).warnings().len(), 2);
    let primitive = json["meshes"][0]["primitives"][0].clone();
    let mut primitives = vec![primitive; 2];
    primitives[0]["attributes"]["COLOR_0"] = 2.into();
    primitives[1]["material"] = 2.into();
    json["meshes"][0]["primitives"] = primitives.into();
    let colors = json!({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC4"});
    json["accessors"].as_array_mut().unwrap().push(colors);
    let mesh = mesh_of(&json);
    let warnings = [
        "1 primitives have opacities of vertices",
        "1 materials emit light",
        "1 materials transmit light",
        "1 primitives have a texture, but no texture coordinates",
        "1 primitives have fewer normals, colours or texture coordinates",
    ];
    has(mesh.warnings(), &warnings);
    assert_eq!(mesh.warnings().len(), 5);
    // All opaque, or of no effect.
    json["materials"][0]["alphaMode"] = "OPAQUE".into();
    assert_eq!(mesh_of(&json).warnings().len(), 4);
    json["accessors"][1]["count"] = 5.into();
    json["scene"] = 7.into();
    let primitives = json["meshes"][0]["primitives"].as_array_mut().unwrap();
    primitives[0]["material"] = 3.into();
    // Of the material of coloured vertices, which is none of the file's.
    let attributes = json!({"POSITION": 0, "COLOR_0": 0, "NORMAL": 2});
    primitives.push(json!({"attributes": attributes, "indices": 1}));
    json["meshes"].as_array_mut().unwrap().push(json!({}));
    let warnings = [
        "1 meshes are in no node that is shown",
        "the default scene 7 is none of 1; all nodes are drawn",
        "3 primitives end within a triangle, which was passed over",
        "2 primitives have fewer normals, colours or texture coordinates",
        "1 triangles are of materials that do not exist",
    ];
    has(mesh_of(&json).warnings(), &warnings);
    let instances = json!({"attributes": {"TRANSLATION": 0, "_COLOR_0": 0}});
    json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = instances;
    has(
        mesh_of(&json).warnings(),
        &["1 nodes have colours of instances"],
    );
}

#[test]
fn a_file_with_many_references_is_read_once() {
    let mut json = gltf_json("");
    json["buffers"] = json!(vec![json!({"uri": "a%20b.bin", "byteLength": 60}); 1000]);
    let json = json.to_string().into_bytes();
    let (reads, colors) = (Cell::new(0), ColorSpace::default());
    let files = files_of(|name| {
        reads.set(reads.get() + 1);
        (name == "a b.bin").then(square_buffer)
    });
    let mesh = read(&json, MeshFormat::Gltf, "a", &files, colors, &Silent);
    assert_eq!((mesh.unwrap().triangles().len(), reads.get()), (2, 1));
}
