//! The mean colour of each triangle's part of a texture.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use image::{DynamicImage, ImageFormat, Rgb, RgbImage};
use serde_json::{Value, json};
use shiftvox::graph::Silent;
use shiftvox_mesh::open::read_mesh;
use shiftvox_mesh::{Mesh, Surface};

use super::shapes::{data_uri, gltf_json, square_buffer};
use super::shared::has;

/// A picture with halves of two colours.
fn halves(left: [u8; 3], right: [u8; 3], format: ImageFormat) -> Vec<u8> {
    let color = |x, _| Rgb(if x < 32 { left } else { right });
    let picture = DynamicImage::from(RgbImage::from_fn(64, 64, color));
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

#[track_caller]
fn check(mesh: &Mesh, triangle: usize, expected: [f64; 3], within: f64) {
    let color = Surface::triangle(mesh, triangle).colors[0].to_array();
    let is_near = (0..3).all(|k| (color[k] - expected[k]).abs() <= within);
    assert!(is_near, "{color:?}, expected {expected:?}");
}

fn read(path: &Path) -> Mesh {
    read_mesh(path, &Default::default(), &Silent).unwrap().0
}

/// A square on the left half of a picture, and one on all of it.
const OBJ: &str = "mtllib a.mtl\nusemtl wood\n\
    v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n\
    vt 0.02 0.02\nvt 0.45 0.02\nvt 0.45 0.98\nvt 0.02 0.98\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
    f 1/1 2/2 3/3 4/4\nf 2/5 5/6 6/7 3/8\n";

/// Writes and reads a `.obj` file and its library.
fn obj(folder: &Path, obj: &str, mtl: &str) -> Mesh {
    fs::write(folder.join("a.obj"), obj).unwrap();
    fs::write(folder.join("a.mtl"), mtl).unwrap();
    read(&folder.join("a.obj"))
}

#[test]
fn textures_of_obj_files_are_averaged_over_triangles() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let materials = at.join("materials");
    fs::create_dir_all(materials.join("pictures")).unwrap();
    let mtl = "newmtl wood\nKd 1 0.5 1\nmap_Kd -s 1 1 1 pictures/wood grain.png\n";
    fs::write(materials.join("a.mtl"), mtl).unwrap();
    fs::write(at.join("a.obj"), OBJ.replace("a.mtl", "materials/a.mtl")).unwrap();
    let picture = materials.join("pictures/wood grain.png");
    for format in [ImageFormat::Png, ImageFormat::Jpeg] {
        fs::write(&picture, halves([255, 255, 0], [0, 0, 255], format)).unwrap();
        let mesh = read(&at.join("a.obj"));
        assert_eq!(mesh.warnings(), [""; 0]);
        // sRGB 0.5 is 0.214 of the light.
        check(&mesh, 0, [1.0, 0.214, 0.0], 0.02);
        // The triangles of the whole picture have a quarter of one half and three quarters of the other.
        let colors = [2, 3].map(|n| Surface::triangle(&mesh, n).colors[0]);
        let mean = (colors[0] + colors[1]) / 2.0;
        assert!((mean - glam::DVec3::new(0.5, 0.107, 0.5)).length() < 0.03);
    }
    // A warning names an unreadable texture, and the plain colour is kept.
    fs::write(&picture, "no picture").unwrap();
    let mesh = read(&at.join("a.obj"));
    has(mesh.warnings(), &["wood grain.png cannot be read"]);
    check(&mesh, 2, [1.0, 0.214, 1.0], 0.001);
    // Nothing outside the mesh's folder is read.
    let secret = halves([9; 3], [9; 3], ImageFormat::Png);
    fs::write(at.join("secret.png"), secret).unwrap();
    let mesh = obj(&materials, OBJ, "newmtl wood\nmap_Kd ../secret.png\n");
    has(mesh.warnings(), &["cannot be read"]);
}

#[test]
fn textures_of_gltf_files_are_averaged_over_triangles() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    let png = halves([255, 0, 0], [0, 255, 0], ImageFormat::Png);
    fs::write(folder.path().join("a picture.png"), &png).unwrap();
    // Corners on the right half of the picture, then the picture.
    let corners = [[0.6f32, 0.1], [0.9, 0.1], [0.9, 0.9], [0.6, 0.9]];
    let mut buffer = square_buffer();
    buffer.extend(corners.as_flattened().iter().flat_map(|c| c.to_le_bytes()));
    buffer.extend(&png);
    let mut json = gltf_json(&data_uri(&buffer));
    let mut push = |list: &str, value| json[list].as_array_mut().unwrap().push(value);
    push(
        "bufferViews",
        json!({"buffer": 0, "byteOffset": 60, "byteLength": 32}),
    );
    push(
        "bufferViews",
        json!({"buffer": 0, "byteOffset": 92, "byteLength": png.len()}),
    );
    push(
        "accessors",
        json!({"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"}),
    );
    json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(2);
    json["textures"] = json!([{"source": 0}]);
    json["buffers"][0]["byteLength"] = json!(buffer.len());
    let mut mesh = |image: Value, texture: Value| {
        json["materials"][0]["pbrMetallicRoughness"] =
            json!({"baseColorFactor": [1, 0.5, 1, 1], "baseColorTexture": texture});
        json["images"] = json!([image]);
        fs::write(&path, json.to_string()).unwrap();
        read(&path)
    };
    let (green, red) = ([0.0, 0.5, 0.0], [1.0, 0.0, 0.0]);
    let texture = json!({"index": 0});
    let moved = json!({"index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0]}}});
    let in_buffer = json!({"bufferView": 3, "mimeType": "image/png"});
    for (image, texture, color) in [
        (json!({"uri": "a%20picture.png"}), &texture, green),
        (in_buffer, &texture, green),
        (json!({"uri": data_uri(&png)}), &moved, red),
    ] {
        let mesh = mesh(image, texture.clone());
        assert_eq!(mesh.warnings(), [""; 0]);
        check(&mesh, 0, color, 0.001);
    }
    let mesh = mesh(json!({"uri": "none.png"}), texture);
    has(mesh.warnings(), &["none.png cannot be read"]);
    check(&mesh, 1, [1.0, 0.5, 1.0], 0.001);
}

/// An exporter wrote `Tr 1` for opaque materials until 2023.
#[test]
fn a_model_is_opaque_if_all_of_it_would_vanish() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = obj(folder.path(), OBJ, "newmtl wood\nTr 1\n");
    assert_eq!(mesh.triangles().len(), 4);
    has(mesh.warnings(), &["drawn opaque"]);
    assert_eq!(Surface::triangle(&mesh, 0).alpha, 1.0);
    // A transparent part is left out.
    let two = OBJ.replace("f 2/5", "usemtl glass\nf 2/5");
    let mesh = obj(folder.path(), &two, "newmtl wood\nnewmtl glass\nTr 1\n");
    assert_eq!(mesh.triangles().len(), 2);
    has(mesh.warnings(), &["opacity 0"]);
}
