//! Files written by hand, and their contents.

use std::collections::HashMap;
use std::io;

use shiftvox::graph::Silent;
use shiftvox_mesh::{self, Beside, ColorSpace, LoadOptions, Mesh, MeshFormat};

use super::shapes::{data_uri, gltf_json, load, soup, square_buffer, squares};

/// Files by name.
struct Shelf(HashMap<&'static str, Vec<u8>>);

impl Beside for Shelf {
    fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        let found = self.0.get(name).cloned();
        found.ok_or_else(|| io::Error::new(io::ErrorKind::NotFound, "not on the shelf"))
    }
}

fn load_with(
    bytes: &[u8],
    format: MeshFormat,
    files: &[(&'static str, &[u8])],
    options: &LoadOptions,
) -> Mesh {
    let shelf = Shelf(
        files
            .iter()
            .map(|(name, bytes)| (*name, bytes.to_vec()))
            .collect(),
    );
    shiftvox_mesh::read(bytes, format, "a file", &shelf, options, &Silent).unwrap()
}

fn with(bytes: &[u8], files: &[(&'static str, &[u8])]) -> Mesh {
    load_with(bytes, MeshFormat::Obj, files, &LoadOptions::default())
}

#[test]
fn one_square_in_every_format_is_the_same_square() {
    let expected = [
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]],
        [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
    ];
    for (name, format, bytes) in squares() {
        let mesh = load(&bytes, format).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(soup(&mesh), expected, "{name}");
        assert_eq!(mesh.positions().len(), 4, "{name}");
        assert_eq!(mesh.warnings(), [""; 0], "{name}");
        assert_eq!(
            mesh.corner_normals().len(),
            if name == "obj" { 2 } else { 0 }
        );
        assert_eq!(
            mesh.vertex_colors().is_empty(),
            !name.starts_with("ply b") && !name.starts_with("ply l")
        );
    }
}

#[test]
fn wavefront_with_materials_polygons_and_negative_indices() {
    let obj = b"mtllib some colours.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0.5 2 0\nv 0 1 0\nusemtl red one\nf -5 -4 -3 -2 -1\n\
        g other\nusemtl blue\nf 1/ 2/ 3/\nl 1 2\np 1\nusemtl lost\nf 1 2 5\nusemtl gone\nf 1 2 3\n";
    let mtl = b"newmtl red one\nKd 0.5 0 0\nnewmtl blue\nKd 0 0 1\nd 0.5\nmap_Kd a.png\nnewmtl gone\nd 0\n";
    let mesh = with(obj, &[("some colours.mtl", mtl)]);
    assert_eq!(mesh.triangles().len(), 5);
    let of = |triangle: usize| &mesh.materials()[mesh.material_of()[triangle] as usize];
    assert_eq!(of(2).name, "red one");
    assert_eq!((of(3).name.as_str(), of(3).alpha), ("blue", 0.5));
    assert_eq!(of(4).name, "no material");
    assert_eq!(mesh.corner_normals().len(), 0);
    let warnings = mesh.warnings().join("; ");
    for part in [
        "a.png cannot be read",
        "1 triangles have no material",
        "1 of 6 triangles of a material with opacity 0",
    ] {
        assert!(warnings.contains(part), "{part}: {warnings}");
    }
    // sRGB 0.5 is 0.214 of the light; as linear light it is itself.
    assert!((of(0).diffuse[0] - 0.2140).abs() < 1e-4);
    let linear = LoadOptions {
        mtl_colors: ColorSpace::Linear,
    };
    let mesh = load_with(obj, MeshFormat::Obj, &[("some colours.mtl", mtl)], &linear);
    assert_eq!(mesh.materials()[1].diffuse, [0.5, 0.0, 0.0]);
}

#[test]
fn wavefront_without_its_library_is_drawn_in_grey() {
    let mesh = with(
        b"mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl a\nf 1 2 3\n",
        &[],
    );
    assert!(
        mesh.warnings()[0].contains("none.mtl cannot be read"),
        "{:?}",
        mesh.warnings()
    );
    assert_eq!(
        mesh.materials()[mesh.material_of()[0] as usize].name,
        "no material"
    );
}

#[test]
fn wavefront_colours_of_vertices_and_bytes_that_are_no_text() {
    let mesh = with(
        b"# caf\xe9\nv 0 0 0 1 0 0.5\nv 1 0 0 1 1 1\nv 1 1 0 0 0 0\nf 1 2 3\n",
        &[],
    );
    assert_eq!(mesh.vertex_colors(), [[255, 0, 128], [255; 3], [0; 3]]);
}

#[test]
fn nodes_of_gltf_move_their_meshes() {
    let uri = data_uri(&square_buffer());
    let moved = gltf_json(&uri, "\"translation\": [1, 2, 3], \"scale\": [2, 1, 1], ");
    let mesh = load(moved.as_bytes(), MeshFormat::Gltf).unwrap();
    assert_eq!(
        soup(&mesh)[0],
        [[1.0, 2.0, 3.0], [3.0, 2.0, 3.0], [3.0, 3.0, 3.0]]
    );
    // A quarter turn about z, then a mirror image as a matrix: it turns the corners' order.
    let turned = gltf_json(
        &uri,
        "\"rotation\": [0, 0, 0.7071067811865476, 0.7071067811865476], ",
    );
    let mesh = load(turned.as_bytes(), MeshFormat::Gltf).unwrap();
    assert!((mesh.positions()[1][1] - 1.0).abs() < 1e-6);
    let mirrored = gltf_json(&uri, "\"matrix\": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], ");
    let mesh = load(mirrored.as_bytes(), MeshFormat::Gltf).unwrap();
    assert_eq!(
        soup(&mesh)[0],
        [[0.0; 3], [-1.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]
    );
    // Linear light, as the format has it.
    assert_eq!(mesh.materials()[1].diffuse, [1.0, 0.5, 0.0]);
}

#[test]
fn buffers_of_gltf_may_be_files() {
    let json = gltf_json("a%20b.bin", "");
    let mesh = load_with(
        json.as_bytes(),
        MeshFormat::Gltf,
        &[("a b.bin", &square_buffer())],
        &LoadOptions::default(),
    );
    assert_eq!(mesh.triangles().len(), 2);
    let error = load(json.as_bytes(), MeshFormat::Gltf)
        .unwrap_err()
        .to_string();
    assert!(
        error.starts_with("a file: buffer 0: expected the file \"a b.bin\" beside the mesh"),
        "{error}"
    );
}

#[test]
fn files_are_looked_for_in_the_folder_of_the_mesh_only() {
    let folder = tempfile::tempdir().unwrap();
    let inside = folder.path().join("inside");
    std::fs::create_dir(&inside).unwrap();
    std::fs::write(folder.path().join("secret.mtl"), b"outside").unwrap();
    std::fs::write(inside.join("a.mtl"), b"inside").unwrap();
    let beside = shiftvox_mesh::SameFolder::new(&inside);
    for name in [
        "a.mtl",
        "./a.mtl",
        "../elsewhere/a.mtl",
        "/tmp/a.mtl",
        "C:\\models\\a.mtl",
    ] {
        assert_eq!(beside.read(name).unwrap(), b"inside", "{name}");
    }
    for name in ["../secret.mtl", "..", "", "/"] {
        assert!(beside.read(name).is_err(), "{name}");
    }
}

#[test]
fn wavefront_of_other_editors_marks_and_continued_lines() {
    let obj = "\u{feff}v 0 0 0\nv 1 \\\n0 0\nmtllib a.mtl\n# C:\\models\\\nusemtl red\nv 0 1 0\nf 1 \\\r\n2 \\\r\n3\r\n";
    let mtl = "\u{feff}newmtl red\nKd 0.5 \\\n0 0\n";
    let mesh = with(obj.as_bytes(), &[("a.mtl", mtl.as_bytes())]);
    assert_eq!(soup(&mesh), [[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]]);
    assert_eq!(mesh.materials()[mesh.material_of()[0] as usize].name, "red");
    assert_eq!(mesh.warnings(), [""; 0]);
    // Lines are counted as the file has them.
    let wrong = b"v 0 0 0\nv 1 \\\n0 0\nv 0 1 x\nf 1 2 3\n";
    let refused = load(wrong, MeshFormat::Obj).unwrap_err().to_string();
    assert!(refused.contains("vertex at line 4"), "{refused}");
}
