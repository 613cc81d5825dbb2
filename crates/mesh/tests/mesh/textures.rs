//! Textures in files, and on triangles and voxels.

use std::f64::consts::PI;
use std::fs;
use std::io::Cursor;
use std::path::Path;

use image::{DynamicImage, ImageFormat, Rgba, RgbaImage};
use serde_json::{Value, json};
use shiftvox::graph::Silent;
use shiftvox_mesh::open::read_mesh;
use shiftvox_mesh::{Mesh, SceneOptions, Surface, srgb_to_linear};

use super::shapes::{data_uri, gltf_json, square_buffer};
use super::shared::has;

/// A picture with halves of two colours. The lower quarter is transparent, where the format has opacity.
fn halves(left: [u8; 3], right: [u8; 3], format: ImageFormat) -> Vec<u8> {
    let color = |x, y| {
        let [r, g, b] = if x < 32 { left } else { right };
        Rgba([r, g, b, if y < 48 { 255 } else { 0 }])
    };
    let mut picture = DynamicImage::from(RgbaImage::from_fn(64, 64, color));
    if format == ImageFormat::Jpeg {
        picture = picture.to_rgb8().into();
    }
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// The colour in the middle of a triangle.
#[track_caller]
fn check(mesh: &Mesh, triangle: usize, expected: [f64; 3], within: f64) {
    let (color, _) = Surface::triangle(mesh, triangle).at([1.0 / 3.0; 3], 0.0);
    let color = color.to_array();
    let is_near = (0..3).all(|k| (color[k] - expected[k]).abs() <= within);
    assert!(is_near, "{triangle}: {color:?}, expected {expected:?}");
}

fn read(path: &Path) -> Mesh {
    read_mesh(path, Default::default(), None, &Silent)
        .unwrap()
        .0
}

/// Six triangles on a picture. The first two have their middles in its left half, the third in the right half. The others
/// lie in a repetition of the left half, in the transparent part, and nowhere.
const OBJ: &str = "mtllib a.mtl\nusemtl wood\nv 0 0 0\nv 1 0 0\nv 1 1 0\n\
    vt 0.02 0.98\nvt 0.45 0.98\nvt 0.02 0.3\nf 1/1 2/2 3/3\n\
    vt 0 1\nvt 1 1\nvt 0 0.25\nf 1/4 2/5 3/6\n\
    vt 0.6 0.1\nvt 0.9 0.1\nvt 0.6 0.9\nf 1/7 2/8 3/9\n\
    vt -3.9 5.3\nvt -3.6 5.3\nvt -3.9 5.9\nf 1/10 2/11 3/12\n\
    vt 0.1 0.1\nvt 0.4 0.1\nvt 0.4 0.2\nf 1/13 2/14 3/15\n\
    vt nan 0.1\nf 1/16 2/14 3/15\n";

#[test]
fn obj_files_have_textures() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let materials = at.join("materials");
    fs::create_dir_all(materials.join("pictures")).unwrap();
    let mtl = "newmtl wood\nKd 1 0.5 1\nmap_Kd -clamp off -mm 0 1 pictures/wood grain.png\n";
    fs::write(materials.join("a.mtl"), mtl).unwrap();
    fs::write(at.join("a.obj"), OBJ.replace("a.mtl", "materials/a.mtl")).unwrap();
    let picture = materials.join("pictures/wood grain.png");
    // sRGB 0.5 is 0.214 of the light.
    let (left, right, plain) = ([1.0, 0.214, 0.0], [0.0, 0.0, 1.0], [1.0, 0.214, 1.0]);
    for format in [
        ImageFormat::Bmp,
        ImageFormat::Jpeg,
        ImageFormat::Png,
        ImageFormat::Tga,
        ImageFormat::WebP,
    ] {
        let mut expected = vec![left, left, right, left, left, plain];
        if format != ImageFormat::Jpeg {
            // A clear triangle is left out.
            expected.remove(4);
        }
        let extension = format.extensions_str()[0];
        let picture = picture.with_extension(extension);
        let mtl = mtl.replace(".png", &format!(".{extension}"));
        fs::write(materials.join("a.mtl"), mtl).unwrap();
        fs::write(&picture, halves([255, 255, 0], [0, 0, 255], format)).unwrap();
        let mesh = read(&at.join("a.obj"));
        has(mesh.warnings(), &["1 triangles had texture coordinates"]);
        assert_eq!(mesh.warnings().len(), 1);
        assert_eq!(mesh.triangles().len(), expected.len());
        for (triangle, expected) in expected.into_iter().enumerate() {
            check(&mesh, triangle, expected, 0.02);
        }
    }
    // 32 bits per texel, of which none are said to be opacity.
    let tga = [
        &[0, 0, 2][..],
        &[0; 9],
        &[1, 0, 1, 0, 32, 0],
        &[0, 255, 255, 0],
    ]
    .concat();
    fs::write(picture.with_extension("tga"), tga).unwrap();
    fs::write(materials.join("a.mtl"), mtl.replace(".png", ".tga")).unwrap();
    let mesh = read(&at.join("a.obj"));
    check(&mesh, 2, left, 0.02);
    assert_eq!(Surface::triangle(&mesh, 2).at([1.0 / 3.0; 3], 0.0).1, 1.0);
    // 16 bits per texel, the first of which is opacity: one is clear.
    let tga = [
        &[0, 0, 2][..],
        &[0; 9],
        &[2, 0, 1, 0, 16, 1],
        &[0, 124, 31, 128],
    ];
    fs::write(picture.with_extension("tga"), tga.concat()).unwrap();
    let mesh = read(&at.join("a.obj"));
    let opacity = |triangle| Surface::triangle(&mesh, triangle).at([1.0 / 3.0; 3], 0.0).1;
    assert!(opacity(0) < 0.5 && opacity(2) > 0.5);
    // The middle of the third triangle is at (0.7, 0.37), of the fourth at (-3.77, 5.5).
    for (options, third, fourth) in [
        ("-clamp on -s 1 1 1", right, left),
        ("-o -0.5", left, right),
        ("-s 1.5 1 -o -0.5 0 0 -clamp on", right, left),
    ] {
        fs::write(
            &picture,
            halves([255, 255, 0], [0, 0, 255], ImageFormat::Jpeg),
        )
        .unwrap();
        fs::write(materials.join("a.mtl"), mtl.replace("-clamp off", options)).unwrap();
        let mesh = read(&at.join("a.obj"));
        check(&mesh, 2, third, 0.02);
        check(&mesh, 3, fourth, 0.02);
    }
    fs::write(materials.join("a.mtl"), mtl).unwrap();
    let jpeg = halves([255, 255, 0], [0, 0, 255], ImageFormat::Jpeg);
    fs::write(&picture, &jpeg[..jpeg.len() - 9]).unwrap();
    let mesh = read(&at.join("a.obj"));
    has(mesh.warnings(), &["wood grain.png is cut short"]);
    check(&mesh, 0, left, 0.02);
    // Other capitals, and a face without coordinates.
    fs::write(materials.join("a.mtl"), mtl.replace("map_Kd", "MAP_kd")).unwrap();
    fs::write(
        at.join("b.obj"),
        OBJ.replace("a.mtl", "materials/a.mtl") + "f 1 2 3\n",
    )
    .unwrap();
    let mesh = read(&at.join("b.obj"));
    has(
        mesh.warnings(),
        &["1 triangles have a texture, but no texture coordinates"],
    );
    check(&mesh, 0, left, 0.02);
    // A warning names an unreadable texture, and the plain colour is kept.
    fs::write(&picture, "no picture").unwrap();
    let mesh = read(&at.join("a.obj"));
    has(mesh.warnings(), &["wood grain.png cannot be read"]);
    check(&mesh, 2, plain, 0.001);
    for (name, bytes, expected) in [
        (
            "b.tga",
            &b"II*\0"[..],
            "it is TIFF; convert it to PNG, for example with magick",
        ),
        ("a.png", b"\xabKTX 20", "gltf-transform ktxdecompress"),
        ("a.TGA", b"\0\0\x02", "a.TGA cannot be read"),
        ("a.txt", b"\0\0\x02", "not BMP, JPEG, PNG, WebP, or TGA"),
        ("b.tga", b"\0\0\x04", "not BMP, JPEG, PNG, WebP, or TGA"),
    ] {
        fs::write(materials.join(name), bytes).unwrap();
        let mtl = mtl.replace("pictures/wood grain.png", name);
        fs::write(materials.join("a.mtl"), mtl).unwrap();
        has(read(&at.join("a.obj")).warnings(), &[expected]);
    }
}

/// Of four triangles, each in a half of one of two pictures; of the last the number is wrong.
const PLY: &str = "ply\nformat ascii 1.0\ncomment TextureFile a picture.png\ncomment TextureFile b.png\nelement vertex 3\n\
    property float x\nproperty float y\nproperty float z\nVERTEX\
    element face 4\nproperty list uchar int vertex_indices\nFACE\
    end_header\n0 0 0@\n1 0 0@\n1 1 0@\n3 0 1 2#0\n3 0 1 2#1\n3 0 1 2#0\n3 0 1 2#2\n";

#[test]
fn ply_files_have_textures() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    for (name, right) in [("a picture.png", [0, 255, 0]), ("b.png", [0, 0, 255])] {
        let picture = halves([255, 0, 0], right, ImageFormat::Png);
        fs::write(folder.path().join(name), picture).unwrap();
    }
    let grey = [srgb_to_linear(200); 3].map(f64::from);
    let colors = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], grey];
    let lists = "property list uchar float texcoord\nproperty int texnumber\n";
    let of_faces = PLY.replace("VERTEX", "").replace("FACE", lists);
    let of_faces = of_faces
        .replace('@', "")
        .replace('#', " 6 0.6 0.95 0.9 0.95 0.9 0.6 ");
    let read_as = |text: &str| {
        fs::write(&path, text).unwrap();
        read(&path)
    };
    let mesh = read_as(&of_faces);
    assert_eq!(mesh.warnings(), [""; 0]);
    for (triangle, color) in colors.into_iter().enumerate() {
        check(&mesh, triangle, color, 0.001);
    }
    for names in ["texture_u texture_v", "s t", "u v"] {
        let properties = format!(
            "property float {}\n",
            names.replace(' ', "\nproperty float ")
        );
        let properties =
            properties + "property uchar red\nproperty uchar green\nproperty uchar blue\n";
        let text = PLY
            .replace("VERTEX", &properties)
            .replace("FACE", "property int texnumber\n");
        let text = text
            .replacen('@', " 0.6 0.95 9 9 9", 1)
            .replacen('@', " 0.9 0.95 9 9 9", 1);
        let text = text.replace('@', " 0.9 0.6 9 9 9").replace('#', " ");
        let mesh = read_as(&text);
        has(mesh.warnings(), &["colours were passed over"]);
        for (triangle, color) in colors.into_iter().enumerate() {
            check(&mesh, triangle, color, 0.001);
        }
        // Without the pictures the vertices have their colours.
        let mesh = read_as(&text.replace("TextureFile ", "TextureFile none"));
        has(
            mesh.warnings(),
            &["nonea picture.png cannot be read", "noneb.png"],
        );
        assert_eq!(mesh.vertex_colors(), [[9; 3]; 3]);
    }
    let mesh = read_as(&of_faces.replacen(" 6 0.6 0.95 0.9 0.95 0.9 0.6 ", " 0 ", 1));
    has(
        mesh.warnings(),
        &["1 faces have a texture, but no texture coordinates"],
    );
    let mesh = read_as(&of_faces.replace("texcoord", "other"));
    has(mesh.warnings(), &["the texture was passed over"]);
}

#[test]
fn gltf_files_have_textures() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    let png = halves([255, 0, 0], [0, 255, 0], ImageFormat::Png);
    fs::write(folder.path().join("a picture.png"), &png).unwrap();
    // Corners on the right half of the picture.
    let corners = [[0.6f32, 0.1], [0.9, 0.1], [0.9, 0.7], [0.6, 0.7]];
    let corners = corners
        .map(|corner| corner.map(f32::to_le_bytes).concat())
        .concat();
    let bytes = [square_buffer(), corners, png.clone()].concat();
    let mut json = gltf_json(&data_uri(&bytes));
    json["buffers"][0]["byteLength"] = bytes.len().into();
    let views = json["bufferViews"].as_array_mut().unwrap();
    views.push(json!({"buffer": 0, "byteOffset": 60, "byteLength": 32}));
    views.push(json!({"buffer": 0, "byteOffset": 92, "byteLength": png.len()}));
    let uvs = json!({"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"});
    json["accessors"].as_array_mut().unwrap().push(uvs);
    json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(2);
    json["textures"] = json!([{"source": 0}]);
    let mut mesh_as = |mode: &str, image: Value, transform: Value| {
        let texture = json!({
            "index": 0, "texCoord": 1, "extensions": {"KHR_texture_transform": transform},
        });
        json["materials"][0]["pbrMetallicRoughness"] =
            json!({"baseColorFactor": [1, 0.5, 1, 1], "baseColorTexture": texture});
        json["images"] = json!([image]);
        json["materials"][0]["alphaMode"] = mode.into();
        fs::write(&path, json.to_string()).unwrap();
        read(&path)
    };
    let picture = || json!({"uri": "a%20picture.png"});
    for (mode, opacity) in [("OPAQUE", 1.0), ("MASK", 0.0), ("BLEND", 0.0)] {
        // The middle of the first triangle is in the transparent part.
        let mesh = mesh_as(mode, picture(), json!({"offset": [0, 0.5]}));
        let found = Surface::triangle(&mesh, 0).at([1.0 / 3.0; 3], 0.0).1;
        assert_eq!(found, opacity, "{mode}");
    }
    let mut mesh = |image: Value, transform: Value| mesh_as("MASK", image, transform);
    let (green, red) = ([0.0, 0.5, 0.0], [1.0, 0.0, 0.0]);
    let in_buffer = json!({"bufferView": 3, "mimeType": "image/png"});
    let in_address = json!({"uri": data_uri(&png)});
    let moved = json!({"offset": [0.5, 0]});
    // (u, v) becomes (v, -u), less than the transparent part.
    let turned = json!({"rotation": PI / 2.0, "scale": [0.3, 0.7], "offset": [0, 0.6]});
    for (image, transform, color) in [
        (picture(), json!({}), green),
        (in_buffer.clone(), json!({}), green),
        (in_address, moved, red),
        (in_buffer.clone(), json!({"scale": [0.5, 1]}), red),
        (in_buffer, turned, red),
    ] {
        let mesh = mesh(image, transform);
        assert_eq!(mesh.warnings(), [""; 0]);
        check(&mesh, 0, color, 0.001);
    }
    let mesh = mesh(json!({"uri": "none.png"}), json!({}));
    has(mesh.warnings(), &["none.png cannot be read"]);
    let plain = [1.0, 0.5, 1.0];
    check(&mesh, 1, plain, 0.001);
    // The middle of the first triangle is beyond the right edge. The older extension gives its colour.
    let texture = json!({
        "index": 0, "texCoord": 1, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0]}},
    });
    let older = json!({"diffuseFactor": [1, 0.5, 1, 1], "diffuseTexture": texture});
    json["materials"][0]["extensions"] = json!({"KHR_materials_pbrSpecularGlossiness": older});
    json["materials"][0]["pbrMetallicRoughness"] = json!({"baseColorFactor": [0, 0, 0, 1]});
    json["images"] = json!([picture()]);
    json["textures"] = json!([{"source": 0, "sampler": 0}]);
    for (wrap, color) in [(10497, red), (33071, green), (33648, green)] {
        json["samplers"] = json!([{"wrapS": wrap}]);
        fs::write(&path, json.to_string()).unwrap();
        check(&read(&path), 0, color, 0.001);
    }
    // Green, mirrored.
    for (extension, expected) in [
        ("EXT_texture_webp", None),
        (
            "KHR_texture_basisu",
            Some(
                "PNG, JPEG or WebP, but that of KHR_texture_basisu; convert it with gltf-transform ktx",
            ),
        ),
    ] {
        let source = json!({extension: {"source": 0}});
        json["textures"] = json!([{"extensions": source, "sampler": 0, "source": 9}]);
        json["extensionsRequired"] = json!([extension]);
        fs::write(&path, json.to_string()).unwrap();
        let mesh = read(&path);
        has(mesh.warnings(), expected.as_slice());
        check(
            &mesh,
            0,
            if expected.is_some() { plain } else { green },
            0.001,
        );
    }
    // A WebP that cannot be read, in place of which there is a PNG.
    let source = json!({"EXT_texture_webp": {"source": 1}});
    json["textures"] = json!([{"extensions": source, "sampler": 0, "source": 0}]);
    json["images"] = json!([picture(), {"uri": "none.webp"}]);
    fs::write(&path, json.to_string()).unwrap();
    let mesh = read(&path);
    has(mesh.warnings(), &["none.webp cannot be read"]);
    check(&mesh, 0, green, 0.001);
    json["materials"][0]["alphaCutoff"] = json!(1.5);
    fs::write(&path, json.to_string()).unwrap();
    let told = "no triangle is seen: the textures are clear wherever a triangle shows them";
    has(read(&path).warnings(), &["none.webp cannot be read", told]);
}

/// Opaque voxels have holes where a card is faint. Voxels with opacities do not.
#[test]
fn faint_cards_are_voxels_with_opacities() {
    let folder = tempfile::tempdir().unwrap();
    let faint = RgbaImage::from_pixel(8, 8, Rgba([255, 255, 255, 40]));
    faint.save(folder.path().join("smoke.png")).unwrap();
    let mtl = "newmtl smoke\nmap_Kd smoke.png\nmap_d smoke.png\nnewmtl brick\n";
    fs::write(folder.path().join("a.mtl"), mtl).unwrap();
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\n\
               vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl smoke\nf 1/1 2/2 3/3 4/4\n\
               usemtl brick\nf 1 4 5\n";
    let path = folder.path().join("a.obj");
    fs::write(&path, obj).unwrap();
    let [opaque, with_opacities] = [false, true].map(|opacities| {
        let options = SceneOptions::new().mesh_depth(4).opacities(opacities);
        options.open(&path).unwrap().voxels()
    });
    // The card has 16 x 16.
    assert!(opaque + 200 < with_opacities, "{opaque} {with_opacities}");
}
