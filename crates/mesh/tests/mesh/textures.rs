//! Textures of meshes: the mean colour of each triangle's part.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use image::{DynamicImage, ImageFormat, Rgb, RgbImage};
use shiftvox::graph::Silent;
use shiftvox_mesh::open::read_mesh;
use shiftvox_mesh::{Mesh, Surface};

use super::shapes::{data_uri, square_buffer};

/// A picture: left half of one colour, right half of another.
fn halves(left: [u8; 3], right: [u8; 3], format: ImageFormat) -> Vec<u8> {
    let color = |x, _| Rgb(if x < 32 { left } else { right });
    let picture = DynamicImage::from(RgbImage::from_fn(64, 64, color));
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn color(mesh: &Mesh, triangle: usize) -> [f64; 3] {
    Surface::triangle(mesh, triangle).colors[0].to_array()
}

fn near(a: [f64; 3], b: [f64; 3], within: f64) -> bool {
    (0..3).all(|k| (a[k] - b[k]).abs() <= within)
}

fn read(path: &Path) -> Mesh {
    read_mesh(path, &Default::default(), &Silent).unwrap().0
}

/// Two triangles on the left half of a picture, and two on all of it.
const OBJ: &str = "mtllib materials/a.mtl\nusemtl wood\n\
    v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n\
    vt 0.02 0.02\nvt 0.45 0.02\nvt 0.45 0.98\nvt 0.02 0.98\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
    f 1/1 2/2 3/3 4/4\nf 2/5 5/6 6/7 3/8\n";

#[test]
fn wavefront_textures_are_averaged_over_triangles() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::create_dir_all(at.join("materials/pictures")).unwrap();
    fs::write(at.join("a.obj"), OBJ).unwrap();
    let mtl = "newmtl wood\nKd 1 0.5 1\nmap_Kd -s 1 1 1 pictures/wood grain.png\n";
    fs::write(at.join("materials/a.mtl"), mtl).unwrap();
    let picture = at.join("materials/pictures/wood grain.png");
    for format in [ImageFormat::Png, ImageFormat::Jpeg] {
        fs::write(&picture, halves([255, 255, 0], [0, 0, 255], format)).unwrap();
        let mesh = read(&at.join("a.obj"));
        assert_eq!(mesh.warnings(), [""; 0]);
        // sRGB 0.5 is 0.214 of the light. Half yellow and half blue: half the light of each, not half the bytes.
        assert!(
            near(color(&mesh, 0), [1.0, 0.214, 0.0], 0.02),
            "{:?}",
            color(&mesh, 0)
        );
        let [a, b] = [2, 3].map(|triangle| color(&mesh, triangle));
        let mean = [0, 1, 2].map(|k| (a[k] + b[k]) / 2.0);
        assert!(near(mean, [0.5, 0.107, 0.5], 0.02), "{mean:?}");
    }
    // A warning names an unreadable texture, and the plain colour is kept.
    for broken in [None, Some(&b"no picture"[..])] {
        let _ = fs::remove_file(&picture);
        if let Some(bytes) = broken {
            fs::write(&picture, bytes).unwrap();
        }
        let mesh = read(&at.join("a.obj"));
        assert!(
            mesh.warnings()[0].contains("wood grain.png cannot be read"),
            "{:?}",
            mesh.warnings()
        );
        assert!(near(color(&mesh, 2), [1.0, 0.214, 1.0], 0.001));
    }
    // Nothing outside the mesh's folder is read.
    fs::write(
        at.join("secret.png"),
        halves([9; 3], [9; 3], ImageFormat::Png),
    )
    .unwrap();
    fs::create_dir(at.join("inner")).unwrap();
    fs::write(at.join("inner/a.obj"), OBJ.replace("materials/", "")).unwrap();
    fs::write(
        at.join("inner/a.mtl"),
        "newmtl wood\nmap_Kd ../secret.png\n",
    )
    .unwrap();
    assert!(read(&at.join("inner/a.obj")).warnings()[0].contains("cannot be read"));
}

#[test]
fn gltf_textures_are_averaged_over_triangles() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let mut buffer = square_buffer();
    // Corners on the right half of the picture.
    for uv in [[0.6f32, 0.1], [0.9, 0.1], [0.9, 0.9], [0.6, 0.9]] {
        buffer.extend(uv.iter().flat_map(|c| c.to_le_bytes()));
    }
    let in_buffer = buffer.len();
    let png = halves([255, 0, 0], [0, 255, 0], ImageFormat::Png);
    buffer.extend(&png);
    let document = |image: &str, info: &str| {
        format!(
            r#"{{"asset": {{"version": "2.0"}}, "nodes": [{{"mesh": 0}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "TEXCOORD_0": 2}}, "indices": 1,
                "material": 0}}]}}],
            "materials": [{{"pbrMetallicRoughness": {{"baseColorFactor": [1, 0.5, 1, 1],
                "baseColorTexture": {{"index": 0{info}}}}}}}],
            "textures": [{{"source": 0}}], "images": [{{{image}}}],
            "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}},
                {{"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}},
                {{"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"}}],
            "bufferViews": [{{"buffer": 0, "byteLength": 48}},
                {{"buffer": 0, "byteOffset": 48, "byteLength": 12}},
                {{"buffer": 0, "byteOffset": 60, "byteLength": 32}},
                {{"buffer": 0, "byteOffset": {in_buffer}, "byteLength": {}}}],
            "buffers": [{{"uri": "{}", "byteLength": {}}}]}}"#,
            png.len(),
            data_uri(&buffer),
            buffer.len(),
        )
    };
    fs::write(at.join("a picture.png"), &png).unwrap();
    let (green, red) = ([0.0, 0.5, 0.0], [1.0, 0.0, 0.0]);
    let moved = r#", "extensions": {"KHR_texture_transform": {"offset": [0.5, 0]}}"#;
    let data = format!("\"uri\": \"{}\"", data_uri(&png));
    for (image, info, right) in [
        (r#""uri": "a%20picture.png""#, "", green),
        (r#""bufferView": 3, "mimeType": "image/png""#, "", green),
        (data.as_str(), "", green),
        (data.as_str(), moved, red),
    ] {
        fs::write(at.join("a.gltf"), document(image, info)).unwrap();
        let mesh = read(&at.join("a.gltf"));
        assert_eq!(mesh.warnings(), [""; 0]);
        assert!(
            near(color(&mesh, 0), right, 0.001),
            "{image}{info}: {:?}",
            color(&mesh, 0)
        );
    }
    fs::write(at.join("a.gltf"), document(r#""uri": "none.png""#, "")).unwrap();
    let mesh = read(&at.join("a.gltf"));
    assert!(
        mesh.warnings()[0].contains("none.png cannot be read"),
        "{:?}",
        mesh.warnings()
    );
    assert!(near(color(&mesh, 1), [1.0, 0.5, 1.0], 0.001));
}

/// An exporter wrote `Tr 1` for opaque materials until 2023.
#[test]
fn a_model_that_would_vanish_is_opaque() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("a.obj"), OBJ.replace("materials/", "")).unwrap();
    fs::write(at.join("a.mtl"), "newmtl wood\nKd 1 0 0\nTr 1\n").unwrap();
    let mesh = read(&at.join("a.obj"));
    assert_eq!(mesh.triangles().len(), 4);
    assert!(
        mesh.warnings()[0].contains("drawn opaque"),
        "{:?}",
        mesh.warnings()
    );
    assert_eq!(Surface::triangle(&mesh, 0).alpha, 1.0);
    // A part that cannot be seen is left out as ever.
    let two = OBJ
        .replace("materials/", "")
        .replace("f 2/5", "usemtl glass\nf 2/5");
    fs::write(at.join("a.obj"), two).unwrap();
    fs::write(
        at.join("a.mtl"),
        "newmtl wood\nKd 1 0 0\nnewmtl glass\nTr 1\n",
    )
    .unwrap();
    let mesh = read(&at.join("a.obj"));
    assert_eq!(mesh.triangles().len(), 2);
    assert!(
        mesh.warnings()[0].contains("opacity 0"),
        "{:?}",
        mesh.warnings()
    );
}
