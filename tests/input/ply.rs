//! PLY clouds: every encoding and type, clear refusals, and the writer.

use std::io::Cursor;

use proptest::prelude::*;
use shiftvox::graph::{PackedNormal, Voxel};
use shiftvox::scene::{FileKind, ReadOptions, SceneError, detect, write_ply};

use crate::input_support::{cut_and_damaged, read, read_plain, refused};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Encoding {
    Ascii,
    Little,
    Big,
}

const ENCODINGS: [Encoding; 3] = [Encoding::Ascii, Encoding::Little, Encoding::Big];

/// A body of numbers by columns of (type, name), for any encoding.
fn cloud(encoding: Encoding, columns: &[(&str, &str)], rows: &[Vec<f64>]) -> Vec<u8> {
    let name = match encoding {
        Encoding::Ascii => "ascii",
        Encoding::Little => "binary_little_endian",
        Encoding::Big => "binary_big_endian",
    };
    let mut text = format!(
        "ply\nformat {name} 1.0\ncomment made here\nelement vertex {}\n",
        rows.len()
    );
    for (kind, name) in columns {
        text += &format!("property {kind} {name}\n");
    }
    let mut bytes = (text + "end_header\n").into_bytes();
    for row in rows {
        if encoding == Encoding::Ascii {
            let words: Vec<String> = row.iter().map(f64::to_string).collect();
            bytes.extend((words.join(" ") + "\n").bytes());
            continue;
        }
        for ((kind, _), value) in columns.iter().zip(row) {
            let mut number = match *kind {
                "char" => (*value as i8).to_le_bytes().to_vec(),
                "uchar" | "uint8" => (*value as u8).to_le_bytes().to_vec(),
                "short" => (*value as i16).to_le_bytes().to_vec(),
                "ushort" => (*value as u16).to_le_bytes().to_vec(),
                "int" | "int32" => (*value as i32).to_le_bytes().to_vec(),
                "uint" => (*value as u32).to_le_bytes().to_vec(),
                "float" | "float32" => (*value as f32).to_le_bytes().to_vec(),
                _ => value.to_le_bytes().to_vec(),
            };
            if encoding == Encoding::Big {
                number.reverse();
            }
            bytes.extend(number);
        }
    }
    bytes
}

fn positions(kind: &'static str) -> Vec<(&'static str, &'static str)> {
    vec![(kind, "x"), (kind, "y"), (kind, "z")]
}

#[test]
fn positions_of_every_type() {
    let signed = [
        "char", "short", "int", "int32", "float", "float32", "double",
    ]
    .map(|kind| (kind, [-7, 0, 100]));
    let unsigned = ["uchar", "uint8", "ushort", "uint"].map(|kind| (kind, [250, 3, 0]));
    for encoding in ENCODINGS {
        for (kind, index) in signed.iter().chain(&unsigned) {
            let row = index.map(f64::from).to_vec();
            let bytes = cloud(encoding, &positions(kind), &[row.clone(), row]);
            assert_eq!(
                read_plain(&bytes),
                [(*index, [200; 3]); 2],
                "{encoding:?} {kind}"
            );
        }
    }
}

#[test]
fn colours_by_any_name_and_in_any_place() {
    for encoding in ENCODINGS {
        for prefix in [
            "red green blue",
            "diffuse_red diffuse_green diffuse_blue",
            "r g b",
        ] {
            let names: Vec<&str> = prefix.split(' ').collect();
            let columns = [
                ("uchar", names[2]),
                ("float", "x"),
                ("uchar", "alpha"),
                ("uchar", names[0]),
                ("float", "y"),
                ("uchar", names[1]),
                ("float", "z"),
            ];
            let row = vec![3.0, 10.0, 0.0, 1.0, 20.0, 2.0, 30.0];
            let bytes = cloud(encoding, &columns, &[row]);
            assert_eq!(
                read_plain(&bytes),
                [([10, 20, 30], [1, 2, 3])],
                "{encoding:?} {prefix}"
            );
        }
        let mut columns = positions("int");
        columns.extend([("float", "red"), ("float", "green"), ("float", "blue")]);
        let bytes = cloud(encoding, &columns, &[vec![0.0, 0.0, 0.0, 0.0, 0.5, 1.0]]);
        // In text, 0 and 1 are written as whole numbers, which are bytes.
        let blue = if encoding == Encoding::Ascii { 1 } else { 255 };
        assert_eq!(read_plain(&bytes), [([0; 3], [0, 128, blue])]);
    }
}

#[test]
fn normals_are_packed() {
    let mut columns = positions("int");
    columns.extend([("float", "nx"), ("float", "ny"), ("float", "nz")]);
    let rows = [
        vec![0.0, 0.0, 0.0, 0.0, 0.0, 2.0],
        vec![1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    ];
    let bytes = cloud(Encoding::Little, &columns, &rows);
    assert_eq!(detect(&bytes, bytes.len() as u64), Some(FileKind::Ply));
    let (voxels, info) = read(&bytes, &ReadOptions::default()).unwrap();
    assert!(info.has_normals && !info.has_colors);
    assert!(voxels[0].normal.is_some());
    assert_eq!(voxels[1].normal, None);
}

#[test]
fn other_elements_and_lists_are_passed_over() {
    let text = b"ply\r\nformat ascii 1.0\r\nobj_info x\r\nelement camera 2\r\nproperty float a\r\nelement vertex 2\r\nproperty list uchar int near\r\nproperty int x\r\nproperty int y\r\nproperty int z\r\nelement face 0\r\nproperty list uchar int vertex_indices\r\nend_header\r\n1\r\n2\r\n2 8 9 1 2 3\r\n\r\n0 4 5 6";
    assert_eq!(
        read_plain(text),
        [([1, 2, 3], [200; 3]), ([4, 5, 6], [200; 3])]
    );
    let mut binary = b"ply\nformat binary_big_endian 1.0\nelement camera 1\nproperty list uchar short a\nproperty float b\nelement tag 2\nproperty uchar a\nelement vertex 1\nproperty list int double w\nproperty char x\nproperty char y\nproperty char z\nend_header\n".to_vec();
    binary.extend([2, 0, 1, 0, 2, 0, 0, 0, 0, 7, 7, 0, 0, 0, 1]);
    binary.extend([0; 8]);
    binary.extend([1, 2, 255]);
    assert_eq!(read_plain(&binary), [([1, 2, -1], [200; 3])]);
}

#[test]
fn meshes_are_told_from_clouds() {
    let text = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let error = read(text, &ReadOptions::default()).unwrap_err();
    assert!(
        matches!(
            error,
            SceneError::Mesh {
                kind: FileKind::PlyMesh,
                ..
            }
        ),
        "{error}"
    );
    for mesh in [
        &b"glTF\x02\0\0\0"[..],
        b"solid a\n",
        b"# x\nv 0 0 0\n",
        b"{\"asset\":{}}",
    ] {
        refused([(mesh.to_vec(), "has triangles and no voxels")]);
    }
}

#[test]
fn messages_say_where_and_what() {
    let int = positions("int");
    let float = positions("float");
    let mut colored = int.clone();
    colored.extend([("int", "red"), ("int", "green"), ("int", "blue")]);
    let header = |lines: &str| format!("ply\nformat ascii 1.0\n{lines}end_header\n").into_bytes();
    let xyz = "element vertex 2\nproperty int x\nproperty int y\nproperty int z\n";
    let mut cut = cloud(Encoding::Little, &int, &[vec![1.0, 2.0, 3.0]]);
    cut.pop();
    refused([
        (
            cloud(
                Encoding::Little,
                &float,
                &[vec![0.0; 3], vec![1.0, 0.5, 2.0]],
            ),
            "vertex 1, property y at byte 145: expected a whole number, the voxel's index, found 0.5; only clouds whose positions are voxel indices",
        ),
        (
            cloud(Encoding::Ascii, &float, &[vec![0.0, f64::NAN, 0.0]]),
            "found NaN",
        ),
        (
            cloud(Encoding::Little, &float, &[vec![f64::INFINITY, 0.0, 0.0]]),
            "found inf",
        ),
        (
            cloud(Encoding::Ascii, &int, &[vec![3e9, 0.0, 0.0]]),
            "fit 32 bits with sign, found x = 3000000000",
        ),
        (
            cloud(
                Encoding::Big,
                &colored,
                &[vec![0.0, 0.0, 0.0, 256.0, 0.0, 0.0]],
            ),
            "property red at byte",
        ),
        (
            cut,
            "vertex 0 at byte 127: expected as many elements as the header says, found the end of the file",
        ),
    ]);
    let body = |row: &str| String::from_utf8(header(xyz)).unwrap() + row;
    let types = "types char to double";
    let long = "ply\n".to_owned() + &"x".repeat(5_000);
    for (text, part) in [
        (body(""), "vertex 0 at byte"),
        (
            body("1 2 3\n1 2\n"),
            "vertex 1 at byte 100: expected a number for property z, found the end of the line",
        ),
        (body("1 2 x\n"), "found \"x\""),
        (body("1 2 3 4\n"), "found \"4\" after them"),
        ("ply\nend_header\n".into(), "a line \"format ... 1.0\""),
        (
            "ply\nformat ascii 2.0\n".into(),
            "found \"format ascii 2.0\"",
        ),
        (
            "ply\nformat utf8 1.0\n".into(),
            "binary_little_endian or binary_big_endian",
        ),
        (
            "ply\nformat ascii 1.0\n".into(),
            "the line \"end_header\", found the end of the file",
        ),
        (long, "lines of at most 4096 bytes"),
    ] {
        refused([(text.into_bytes(), part)]);
    }
    for (lines, part) in [
        (
            "element vertex many\n",
            "header at byte 21: expected \"element NAME COUNT\" with a whole number, found \"element vertex m",
        ),
        (
            "property int x\n",
            "a line \"element\" before the first property",
        ),
        ("element vertex 1\nproperty word x\n", types),
        ("element vertex 1\nproperty list float int x\n", types),
        ("element face 0\n", "expected an element \"vertex\""),
        (
            "element vertex 1\nproperty int x\n",
            "the properties x, y and z",
        ),
        (
            "elephant\n",
            "format, element, property, comment or end_header",
        ),
    ] {
        refused([(header(lines), part)]);
    }
}

#[test]
fn counts_of_the_header_are_not_believed() {
    let huge = u64::MAX;
    for format in ["ascii", "binary_little_endian"] {
        let text = format!(
            "ply\nformat {format} 1.0\nelement nothing {huge}\nelement a {huge}\nproperty double b\nelement vertex {huge}\nproperty int x\nproperty int y\nproperty int z\nend_header\n"
        );
        refused([(text.into_bytes(), "found the end of the file")]);
        let lists = format!(
            "ply\nformat {format} 1.0\nelement vertex {huge}\nproperty list uint double w\nproperty int x\nproperty int y\nproperty int z\nend_header\n\u{7f}\u{7f}\u{7f}\u{7f}"
        );
        assert!(read(lists.as_bytes(), &ReadOptions::default()).is_err());
    }
}

#[test]
fn truncations_are_errors_and_damage_never_panics() {
    let mut columns = positions("short");
    columns.extend([("uchar", "red"), ("uchar", "green"), ("uchar", "blue")]);
    let rows = vec![vec![-5.0, 6.0, 7.0, 8.0, 9.0, 10.0]; 3];
    for encoding in ENCODINGS {
        let bytes = cloud(encoding, &columns, &rows);
        // In text, the last number may lose digits, or the last line its end, unseen.
        let unseen = if encoding == Encoding::Ascii { 2 } else { 0 };
        cut_and_damaged(&bytes, bytes.len() - unseen, 20_000);
    }
}

fn written(voxels: &[Voxel], normals: bool) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let count = write_ply(&mut file, voxels.iter().copied(), normals).unwrap();
    assert_eq!(count, voxels.len() as u64);
    file.into_inner()
}

#[test]
fn the_written_file_byte_for_byte() {
    let voxel = Voxel {
        index: [1, -2, 300],
        color: [7, 8, 9],
        normal: Some(PackedNormal::encode(glam::DVec3::Z)),
    };
    let other = Voxel {
        normal: None,
        ..voxel
    };
    let head = "ply\nformat binary_little_endian 1.0\n\
        comment voxel indices: a vertex (i, j, k) is the cell from i to i + 1 along each axis\n\
        element vertex 2\ncomment --------------------\nproperty int x\nproperty int y\nproperty int z\n\
        property uchar red\nproperty uchar green\nproperty uchar blue\n";
    let row = [1, 0, 0, 0, 254, 255, 255, 255, 44, 1, 0, 0, 7, 8, 9];
    let bare = [head.as_bytes(), b"end_header\n", &row, &row].concat();
    assert_eq!(written(&[voxel, other], false), bare);
    let head =
        head.to_owned() + "property float nx\nproperty float ny\nproperty float nz\nend_header\n";
    let normal = [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x80, 0x3f];
    let full = [head.as_bytes(), &row, &normal, &row, &[0; 12]].concat();
    assert_eq!(written(&[voxel, other], true), full);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn the_writer_keeps_every_voxel(
        voxels in prop::collection::vec(
            (prop::array::uniform3(-500_000i32..500_000), any::<[u8; 3]>(), any::<u16>()), 0..100),
        normals in any::<bool>(),
    ) {
        let voxels: Vec<Voxel> = voxels.into_iter().map(|(index, color, normal)| {
            let normal = (normals && normal > 999).then_some(PackedNormal(normal));
            Voxel { index, color, normal }
        }).collect();
        let (again, info) = read(&written(&voxels, normals), &ReadOptions::default()).unwrap();
        prop_assert_eq!(info.has_normals, normals);
        prop_assert_eq!(again.len(), voxels.len());
        for (a, v) in again.iter().zip(&voxels) {
            prop_assert_eq!((a.index, a.color), (v.index, v.color));
            // Some directions have two packings, so directions are compared.
            let same = match (a.normal, v.normal) {
                (Some(a), Some(v)) => a.decode().unwrap().dot(v.decode().unwrap()) > 1.0 - 1e-9,
                (a, v) => a == v,
            };
            prop_assert!(same, "{:?} {:?}", a, v);
        }
    }
}
