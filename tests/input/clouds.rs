//! Lists of voxel indices, PLY and NumPy, of every type and order, and grids of binvox.

use std::io::Cursor;

use proptest::prelude::*;
use shiftvox::graph::{PackedNormal, Voxel};
use shiftvox::scene::{ReadOptions, write_ply};

use crate::{Plain, read, read_plain, read_with};

/// Of PLY.
pub(crate) const FORMATS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

/// A number of a type, by its name in PLY or in NumPy.
fn number(kind: &str, is_big: bool, value: f64) -> Vec<u8> {
    let mut bytes = match kind {
        "char" | "i1" => (value as i8).to_le_bytes().to_vec(),
        "uchar" | "uint8" | "u1" => (value as u8).to_le_bytes().to_vec(),
        "short" | "i2" => (value as i16).to_le_bytes().to_vec(),
        "ushort" | "u2" => (value as u16).to_le_bytes().to_vec(),
        "int" | "int32" | "i4" => (value as i32).to_le_bytes().to_vec(),
        "uint" | "u4" => (value as u32).to_le_bytes().to_vec(),
        "i8" => (value as i64).to_le_bytes().to_vec(),
        "u8" => (value as u64).to_le_bytes().to_vec(),
        "float" | "float32" | "f4" => (value as f32).to_le_bytes().to_vec(),
        _ => value.to_le_bytes().to_vec(),
    };
    if is_big {
        bytes.reverse();
    }
    bytes
}

/// A PLY of vertices with columns such as `int x, float red`.
pub(crate) fn cloud(format: &str, columns: &str, rows: &[impl AsRef<[f64]>]) -> Vec<u8> {
    let count = rows.len();
    let properties = columns.replace(", ", "\nproperty ");
    let mut bytes = format!(
        "ply\nformat {format} 1.0\ncomment made here\nelement vertex {count}\nproperty {properties}\nend_header\n"
    )
    .into_bytes();
    for row in rows.iter().map(AsRef::as_ref) {
        if format == "ascii" {
            let words: Vec<String> = row.iter().map(f64::to_string).collect();
            bytes.extend((words.join(" ") + "\n").bytes());
            continue;
        }
        for (column, value) in columns.split(", ").zip(row) {
            let (kind, _) = column.split_once(' ').unwrap();
            bytes.extend(number(kind, format == FORMATS[2], *value));
        }
    }
    bytes
}

/// An array file with the given header text and numbers.
pub(crate) fn npy(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
    let length = (header.len() as u32).to_le_bytes();
    let length = &length[..if version == 1 { 2 } else { 4 }];
    let begin = [b"\x93NUMPY", &[version, 0][..], length];
    [&begin.concat(), header.as_bytes(), data].concat()
}

pub(crate) fn array(
    version: u8,
    descr: &str,
    fortran: bool,
    rows: &[impl AsRef<[f64]>],
) -> Vec<u8> {
    let (count, columns) = (rows.len(), rows.first().map_or(3, |row| row.as_ref().len()));
    let order = if fortran { "True" } else { "False" };
    let header = format!(
        "{{'descr': '{descr}', 'fortran_order': {order}, 'shape': ({count}, {columns}), }}   \n"
    );
    let value = |i: usize| match fortran {
        true => rows[i % count].as_ref()[i / count],
        false => rows[i / columns].as_ref()[i % columns],
    };
    let number = |i| number(&descr[1..], descr.starts_with('>'), value(i));
    let data: Vec<u8> = (0..count * columns).flat_map(number).collect();
    npy(version, &header, &data)
}

#[test]
fn arrays_of_every_type_order_and_version() {
    let types = "|i1 <i2 <i4 <i8 |u1 <u2 <u4 <u8 <f4 <f8 <i1 >i2 >i4 >i8 =u1 >u2 >u4 >u8 >f4 >f8";
    for descr in types.split(' ') {
        let sign = if descr.contains('u') { 1 } else { -1 };
        // More rows than are read at a time, so that blocks meet.
        let indices = (0..9_000).map(|i| [sign * (i % 120), i / 120, i % 7]);
        for (fortran, version) in [false, true].map(|f| [1, 2, 3].map(|v| (f, v))).concat() {
            // A version has indices alone, another colours, the third one more column.
            let columns = [3, 6, 7][usize::from(version) - 1];
            let row = |[x, y, z]: [i32; 3]| [x, y, z, 10 + z, 20, 30, 0].map(f64::from);
            let rows: Vec<_> = indices.clone().map(row).collect();
            let rows: Vec<_> = rows.iter().map(|row| &row[..columns]).collect();
            let color = |z: i32| {
                if columns == 3 {
                    [200; 3]
                } else {
                    [10 + z as u8, 20, 30]
                }
            };
            let expected = indices.clone().map(|index| (index, color(index[2])));
            let (voxels, _) = read(&array(version, descr, fortran, &rows)).unwrap();
            let voxels = voxels.iter().map(|v| (v.index, v.color));
            assert!(voxels.eq(expected), "{descr} {fortran} {version}");
        }
    }
    assert!(read_plain(&array(1, "<i4", false, &[[0.0; 3]; 0])).is_empty());
}

#[test]
fn clouds_of_every_type_with_colours_of_any_name() {
    let signed = "char short int int32 float float32 double";
    let types = signed.split(' ').map(|kind| (kind, [-7, 0, 100]));
    let unsigned = "uchar uint8 ushort uint".split(' ');
    for (kind, index) in types.chain(unsigned.map(|kind| (kind, [250, 3, 0]))) {
        let columns = format!("{kind} x, {kind} y, {kind} z");
        let row = index.map(f64::from);
        for format in FORMATS {
            let read = read_plain(&cloud(format, &columns, &[row, row]));
            assert_eq!(read, [(index, [200; 3]); 2], "{format} {kind}");
        }
    }
    let rgb = |[r, g, b]: [&str; 3]| {
        format!("uchar {b}, float x, uchar alpha, uchar {r}, float y, uchar {g}, float z")
    };
    let diffuse = ["diffuse_red", "diffuse_green", "diffuse_blue"];
    for columns in [["red", "green", "blue"], diffuse, ["r", "g", "b"]].map(rgb) {
        for format in FORMATS {
            let bytes = cloud(format, &columns, &[[3.0, 10.0, 0.0, 1.0, 20.0, 2.0, 30.0]]);
            assert_eq!(read_plain(&bytes), [([10, 20, 30], [1, 2, 3])], "{columns}");
        }
    }
    for format in FORMATS {
        let columns = "int x, int y, int z, float red, float green, float blue";
        let bytes = cloud(format, columns, &[[0.0, 0.0, 0.0, 0.0, 0.5, 1.0]]);
        assert_eq!(read_plain(&bytes), [([0; 3], [0, 128, 255])]);
    }
}

#[test]
fn clouds_with_normals_lists_and_other_elements() {
    let columns = "int x, int y, int z, float nx, float ny, float nz";
    let rows = [[0.0, 0.0, 0.0, 0.0, 0.0, 2.0], [0.0; 6]];
    let (voxels, _) = read(&cloud(FORMATS[1], columns, &rows)).unwrap();
    assert!(voxels[0].normal.is_some() && voxels[1].normal.is_none());
    let text = b"ply\r\nformat ascii 1.0\r\nobj_info x\r\nelement camera 2\r\nproperty float a\r\nelement vertex 2\r\nproperty list uchar int near\r\nproperty int x\r\nproperty int y\r\nproperty int z\r\nelement face 0\r\nproperty list uchar int vertex_indices\r\nend_header\r\n1\r\n2\r\n2 8 9 1 2 3\r\n\r\n0 4 5 6";
    let gray = [200; 3];
    assert_eq!(read_plain(text), [([1, 2, 3], gray), ([4, 5, 6], gray)]);
    let mut binary = b"ply\nformat binary_big_endian 1.0\nelement camera 1\nproperty list uchar short a\nproperty float b\nelement tag 2\nproperty uchar a\nelement vertex 1\nproperty list int double w\nproperty char x\nproperty char y\nproperty char z\nend_header\n".to_vec();
    binary.extend([2, 0, 1, 0, 2, 0, 0, 0, 0, 7, 7, 0, 0, 0, 1]);
    binary.extend([0; 8]);
    binary.extend([1, 2, 255]);
    assert_eq!(read_plain(&binary), [([1, 2, -1], gray)]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn the_writer_of_clouds_keeps_every_voxel(
        voxels in prop::collection::vec(
            (prop::array::uniform3(-500_000i32..500_000), any::<[u8; 3]>(), any::<u16>()), 0..100),
        normals in any::<bool>(),
    ) {
        let voxels: Vec<Voxel> = voxels.into_iter().map(|(index, color, normal)| {
            // Of the numbers with the same direction, the one that a direction gets.
            let number = if normals && normal > 999 { normal } else { 0 };
            let normal = PackedNormal(number).decode().map(PackedNormal::encode);
            Voxel { index, color, normal }
        }).collect();
        let mut file = Cursor::new(Vec::new());
        let count = write_ply(&mut file, voxels.iter().copied(), normals).unwrap();
        prop_assert_eq!(count, voxels.len() as u64);
        let (again, _) = read(file.get_ref()).unwrap();
        prop_assert_eq!(again, voxels);
    }

    /// In a grid y runs fastest, then z, then x.
    #[test]
    fn runs_of_any_length_give_their_cells(
        ([x, z, y], cells) in [1usize..7, 1usize..7, 1usize..7].prop_flat_map(|sizes| {
            let cells = sizes.iter().product::<usize>();
            (Just(sizes), prop::collection::vec(prop::sample::select(&[0u8, 0, 1, 255][..]), cells))
        }),
        longest in 1usize..256,
    ) {
        let header = format!("#binvox 2\ndim {x} {z} {y}\ntranslate -0.5 1 2e-3\nscale 7.25\ndata\n");
        let mut bytes = header.into_bytes();
        for run in cells.chunk_by(|a, b| a == b) {
            for part in run.chunks(longest) {
                bytes.extend([part[0], part.len() as u8]);
            }
        }
        let filled = (0..cells.len()).filter(|&cell| cells[cell] != 0);
        let at = |cell| [cell / (z * y), cell % y, cell / y % z].map(|i| i as i32);
        let expected: Vec<Plain> = filled.map(|cell| (at(cell), [200; 3])).collect();
        let options = |most_voxels| ReadOptions { most_voxels, ..ReadOptions::default() };
        let count = expected.len() as u64;
        if count > 0 {
            prop_assert!(read_with(&bytes, &options(count - 1)).unwrap_err().is_limit());
        }
        prop_assert_eq!(read_plain(&bytes), expected);
        let (_, info) = read_with(&[&bytes, &b"more"[..]].concat(), &options(count)).unwrap();
        prop_assert_eq!(info.warnings, ["4 bytes after the last run were not read"]);
    }
}
