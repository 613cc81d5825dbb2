//! The contents of files written by hand.

use shiftvox::graph::Silent;
use shiftvox_mesh::{ColorSpace, Mesh, MeshFormat, read, same_folder};

use super::shapes::{load, squares};
use super::shared::{files_of, has, soup};

/// Reads a mesh beside the library `a b.mtl`.
fn obj(text: &str, mtl: &str, mtl_colors: ColorSpace) -> Mesh {
    let library = files_of(|name| (name == "a b.mtl").then(|| mtl.into()));
    let text = text.as_bytes();
    read(
        text,
        MeshFormat::Obj,
        "a file",
        &library,
        mtl_colors,
        &Silent,
    )
    .unwrap()
}

fn materials(mesh: &Mesh) -> Vec<&str> {
    let name = |&m: &u32| &mesh.materials()[m as usize].name[..];
    mesh.material_of().iter().map(name).collect()
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
        let normals = if name == "obj" { 2 } else { 0 };
        assert_eq!(mesh.corner_normals().len(), normals, "{name}");
        let is_colored = ["ply little", "ply big"].contains(&name);
        assert_eq!(!mesh.vertex_colors().is_empty(), is_colored, "{name}");
        if name.starts_with("gl") {
            // Colours of the format are linear light.
            assert_eq!(mesh.materials()[1].diffuse, [1.0, 0.5, 0.0]);
        }
    }
}

#[test]
fn obj_files_have_materials_polygons_and_negative_indices() {
    let text = "mtllib a b.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0.5 2 0\nv 0 1 0\nusemtl red one\n\
        f -5 -4 -3 -2 -1\ng other\nusemtl blue\nf 1/ 2/ 3/\nl 1 2\np 1\nusemtl lost\nf 1 2 5\n\
        usemtl gone\nf 1 2 3\nmtllib none.mtl\n";
    let mtl = "# c\nKd 1 1 1\nNewMtl red one\n kd 0.5 0 0\nTR 0.25\nKe 0 0 0\nKe 0 2 0\nmap_Ke a.png\nnewmtl blue\nKd 0.5\nKd 0 0 1\nd -halo 0.5\n\
        map_Kd -mm 0 2 a.png\nmap_Ka a.png\nKd spectral x.rfl\nTf 1 0 0\nnewmtl gone\nd 0\nmap_Kd -clamp on\nmap_ke a.png\nmap_Ka a.png\nnewmtl \u{fc}\nKe 0 0 0\n";
    // sRGB 0.5 is 0.214 of the light; linear 0.5 stays.
    for (mtl_colors, red) in [(ColorSpace::Srgb, 0.214), (ColorSpace::Linear, 0.5)] {
        let mesh = obj(text, mtl, mtl_colors);
        let names = ["red one", "red one", "red one", "blue", "no material"];
        assert_eq!(materials(&mesh), names);
        assert_eq!(mesh.corner_normals().len(), 0);
        let [first, blue] = [0, 3].map(|n| &mesh.materials()[mesh.material_of()[n] as usize]);
        assert!((first.diffuse[0] - red).abs() < 1e-4);
        assert_eq!(first.diffuse[1..], [0.0; 2]);
        assert_eq!((first.alpha, blue.alpha), (0.75, 0.5));
        assert_eq!(blue.diffuse, [0.0, 0.0, 1.0]);
        let warnings = [
            "a b.mtl: line 15 is not understood",
            "a.png cannot be read",
            "none.mtl cannot be read",
            "1 triangles have no material",
            "1 of 6 triangles of a material with opacity 0",
            "2 lines, points and curves",
            "a b.mtl: 2 materials emit light",
            "a b.mtl: 1 materials colour the light behind them",
            "a b.mtl: 1 materials change the brightness of a picture",
            "a b.mtl: 1 materials have a picture of ambient light alone",
        ];
        has(mesh.warnings(), &warnings);
    }
}

#[test]
fn obj_files_may_have_coloured_vertices_and_odd_lines() {
    let text = b"# caf\xe9\nv 0 0 0 1 0 0.5\nv 1 0 0 1 1 1\nv 1 1 0 0 0 0\nf 1 2 3\n";
    let mesh = load(text, MeshFormat::Obj).unwrap();
    assert_eq!(mesh.vertex_colors(), [[255, 0, 128], [255; 3], [0; 3]]);
    // Without a material they are not darkened; a face without colours is grey.
    let text = "v 0 0 0 1 1 1.01\nv 1 0 0 0 0.5 0\nv 1 1 0 0 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
    let mesh = load(text.as_bytes(), MeshFormat::Obj).unwrap();
    assert_eq!(materials(&mesh), ["vertex colours", "no material"]);
    assert_eq!(
        mesh.materials()[mesh.material_of()[0] as usize].diffuse,
        [1.0; 3]
    );
    assert_eq!(mesh.vertex_colors()[..2], [[255; 3], [0, 128, 0]]);
    assert_eq!(mesh.warnings(), [""; 0]);
    let text = "v 0 0 0 200 60.4 10\nv 1 0 0 255 1 0 # a\nv 1 1 0 0 0 0\nf 1 2 3 #b\n";
    let mesh = load(text.as_bytes(), MeshFormat::Obj).unwrap();
    assert_eq!(mesh.vertex_colors(), [[200, 60, 10], [255, 1, 0], [0; 3]]);
    has(mesh.warnings(), &["taken as 0 to 255"]);
    // As ZBrush writes them, and an older word for a face.
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\n#MRGB ff0a0b0cffff0001\n#MRGB ff00ff02\nfo 1 2 3\n";
    let mesh = load(text.as_bytes(), MeshFormat::Obj).unwrap();
    assert_eq!(
        mesh.vertex_colors(),
        [[10, 11, 12], [255, 0, 1], [0, 255, 2]]
    );
    let text = b"v 0 0 0\rv 1 0 0\rv 1 1 0\rf 1 2 3\r";
    assert_eq!(load(text, MeshFormat::Obj).unwrap().triangles().len(), 1);
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\ncurv 0 1 1 2\nl 1 2\n";
    let mesh = load(text.as_bytes(), MeshFormat::Obj).unwrap();
    has(mesh.warnings(), &["2 lines, points and curves"]);
    // Byte order marks and continued lines.
    let text = "\u{feff}v 0 0 0\nv 1 \\\n0 0\nmtllib a b.mtl\n# C:\\models\\\nusemtl red\nv 0 1 0\n\
        f 1 \\\r\n2 \\\r\n3\r\n";
    let mtl = "\u{feff}newmtl red\nKd 0.5 \\\n0 0\n";
    let mesh = obj(text, mtl, ColorSpace::Srgb);
    assert_eq!(soup(&mesh), [[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]]);
    assert_eq!(materials(&mesh), ["red"]);
    assert_eq!(mesh.warnings(), [""; 0]);
}

/// An exporter wrote `Tr 1` for opaque materials until 2023.
#[test]
fn a_model_is_opaque_if_all_of_it_would_vanish() {
    let text =
        "mtllib a b.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nusemtl glass\nf 3 2 1\n";
    let glass = "newmtl red\nTr 1\nnewmtl glass\nTr 1\n";
    let mesh = obj(text, glass, ColorSpace::Srgb);
    has(mesh.warnings(), &["drawn opaque"]);
    assert_eq!(mesh.materials()[1].alpha, 1.0);
    assert_eq!(materials(&mesh), ["red", "glass"]);
    let mesh = obj(text, &glass.replacen("Tr 1", "Tr 0", 1), ColorSpace::Srgb);
    assert_eq!(materials(&mesh), ["red"]);
}

#[test]
fn one_line_names_several_libraries() {
    let text = "mtllib a.mtl b.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl red\nf 1 2 3\nusemtl blue\nf 3 2 1\n";
    let libraries = files_of(|name| match name {
        "a.mtl" => Some(b"newmtl red\n".to_vec()),
        "b.mtl" => Some(b"newmtl blue\n".to_vec()),
        _ => None,
    });
    let (text, colors) = (text.as_bytes(), ColorSpace::default());
    let mesh = read(text, MeshFormat::Obj, "a", &libraries, colors, &Silent).unwrap();
    assert_eq!(materials(&mesh), ["red", "blue"]);
    assert!(mesh.warnings().is_empty());
}

#[test]
fn only_the_folder_of_the_mesh_is_searched() {
    let folder = tempfile::tempdir().unwrap();
    let inside = folder.path().join("inside");
    std::fs::create_dir(&inside).unwrap();
    std::fs::write(folder.path().join("secret.mtl"), b"outside").unwrap();
    std::fs::write(inside.join("a.mtl"), b"inside").unwrap();
    let beside = same_folder(&inside);
    for name in "a.mtl ./a.mtl ../elsewhere/a.mtl /tmp/a.mtl C:\\models\\a.mtl".split(' ') {
        assert_eq!(beside(name).unwrap(), b"inside", "{name}");
    }
    for name in ["../secret.mtl", "..", "", "/"] {
        assert!(beside(name).is_err(), "{name}");
    }
}

#[test]
fn text_stl_files_have_several_solids() {
    let solid = |name: &str, z: u32| {
        let corner = |x: u32, y: u32| format!("vertex {x} {y} {z}\n");
        let corners = [corner(0, 0), corner(1, 0), corner(0, 1)].concat();
        format!(
            "solid {name}\nfacet normal 0 -nan(ind) 1\nouter loop\n{corners}endloop\nendfacet\nendsolid {name}\n"
        )
    };
    let text = ["a", "facet", "solid"].map(|name| solid(name, name.len() as u32));
    // A facet without a solid.
    let loose = solid("", 9);
    let loose = &loose["solid \n".len()..loose.len() - "endsolid \n".len()];
    let text = [&text[0], loose, &text[1], &text[2]];
    let mesh = load(text.concat().as_bytes(), MeshFormat::Stl).unwrap();
    let heights: Vec<f32> = soup(&mesh).iter().map(|corners| corners[0][2]).collect();
    assert_eq!(heights, [1.0, 9.0, 5.0, 5.0]);
}

/// Also where all digits of a line are those of whole numbers.
#[test]
fn colours_that_are_not_read_are_told() {
    let mut stl = squares()
        .into_iter()
        .find(|(name, ..)| *name == "stl binary")
        .unwrap()
        .2;
    stl[84 + 48] = 1;
    let mesh = load(&stl, MeshFormat::Stl).unwrap();
    has(mesh.warnings(), &["attributes of triangles"]);
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty int x\nproperty int y\nproperty int z\nelement material 1\n\
        property int ambient_red\nelement face 1\nproperty list int int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n1 1 0\n9\n3 0 1 2\n";
    let mesh = load(ply.as_bytes(), MeshFormat::Ply).unwrap();
    has(mesh.warnings(), &["materials were passed over"]);
}

#[test]
fn real_colours_of_ply_files_are_shares() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nCOLORS\
        element face 1\nproperty list uchar int vertex_indices\nOTHERS\
        end_header\n0 0 0@\n1 0 0@\n0 1 0@\n3 0 1 2#\n";
    let colors = "property float red\nproperty double green\nproperty float blue\n";
    let of_vertices = text.replace("COLORS", colors).replace("OTHERS", "");
    let of_vertices = of_vertices.replace('@', " 1 0.5 0").replace('#', "");
    let mesh = load(of_vertices.as_bytes(), MeshFormat::Ply).unwrap();
    assert_eq!(mesh.vertex_colors(), [[255, 128, 0]; 3]);
    let of_faces = text.replace("COLORS", "").replace("OTHERS", colors);
    let of_faces = of_faces.replace('@', "").replace('#', " 1 0 1");
    let mesh = load(of_faces.as_bytes(), MeshFormat::Ply).unwrap();
    let material = mesh.material_of()[0] as usize;
    assert_eq!(mesh.materials()[material].diffuse, [1.0, 0.0, 1.0]);
}

#[test]
fn opacities_of_ply_files_are_warned_of() {
    for (alphas, is_warned) in [
        ("uchar 255 255 254", true),
        ("uchar 255 255 255", false),
        ("float 1 1.0 1", false),
    ] {
        let words: Vec<&str> = alphas.split(' ').collect();
        let properties = format!("property {} alpha\n", words[0]);
        let header = super::shapes::ply_header("ascii", 3, &properties, "int vertex_indices");
        let [a, b, c] = [words[1], words[2], words[3]];
        let text = format!("{header}0 0 0 {a}\n1 0 0 {b}\n1 1 0 {c}\n3 0 1 2\n");
        let mesh = load(text.as_bytes(), MeshFormat::Ply).unwrap();
        let is_found = mesh.warnings() == ["opacities of vertices or faces were passed over"];
        assert_eq!(
            (is_found, mesh.warnings().len()),
            (is_warned, usize::from(is_warned))
        );
    }
}

#[test]
fn ply_files_have_strips_and_colours_of_faces() {
    let vertices =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty int x\nproperty int y\nproperty int z\n";
    let places = "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
    // Two strips, the second led to its second part by equal corners.
    let strips = "element tristrips 1\nproperty list int int vertex_indices\n";
    let strips = format!("{vertices}{strips}{places}12 0 1 2 3 -1 3 2 2 1 1 0 2\n");
    let mesh = load(strips.as_bytes(), MeshFormat::Ply).unwrap();
    let corner = |corner: [f32; 3]| corner.map(|c| c.to_string()).concat();
    let triangles: Vec<String> = soup(&mesh)
        .into_iter()
        .map(|t| t.map(corner).join(" "))
        .collect();
    let expected = ["000 100 010", "010 100 110", "100 000 010"];
    assert_eq!(
        (&triangles[..], mesh.warnings()),
        (&expected.map(str::to_owned)[..], &[][..])
    );
    let opened =
        shiftvox_mesh::open::open_bytes(strips.as_bytes(), "a.ply", &Default::default(), &Silent);
    assert_eq!(opened.unwrap().format, ".ply mesh");

    let face = "element face 3\nproperty list uchar int vertex_indices\nproperty uchar red\n\
        property uchar green\nproperty uchar blue\n";
    let faces = "3 0 1 2 255 0 0\n3 1 3 2 0 0 255\n3 0 3 2 255 0 0\n";
    let mesh = load(
        format!("{vertices}{face}{places}{faces}").as_bytes(),
        MeshFormat::Ply,
    )
    .unwrap();
    let color = |&m: &u32| mesh.materials()[m as usize].diffuse;
    let colors: Vec<_> = mesh.material_of().iter().map(color).collect();
    let [red, blue] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(
        (&colors[..], mesh.materials().len()),
        (&[red, blue, red][..], 4)
    );
    let both = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    let places = places.replace(" 0\n", " 0 9 9 9\n");
    let mesh = load(
        format!("{vertices}{both}{face}{places}{faces} 3 0 1 3 9 9 9").as_bytes(),
        MeshFormat::Ply,
    );
    has(
        mesh.unwrap().warnings(),
        &[
            "colours of faces were passed over",
            "what follows the last element of the header was not read",
        ],
    );
}
