//! Numpy arrays: every type, both orders, every version, clear refusals.

use crate::input_support::{cut_and_damaged, read, read_plain, refused};
use shiftvox::scene::{FileKind, ReadOptions, detect};

/// An array file with the given header text and numbers.
fn file(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY".to_vec();
    bytes.extend([version, 0]);
    if version == 1 {
        bytes.extend((header.len() as u16).to_le_bytes());
    } else {
        bytes.extend((header.len() as u32).to_le_bytes());
    }
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

fn number(descr: &str, value: f64) -> Vec<u8> {
    let mut bytes = match &descr[1..] {
        "i1" => (value as i8).to_le_bytes().to_vec(),
        "i2" => (value as i16).to_le_bytes().to_vec(),
        "i4" => (value as i32).to_le_bytes().to_vec(),
        "i8" => (value as i64).to_le_bytes().to_vec(),
        "u1" => (value as u8).to_le_bytes().to_vec(),
        "u2" => (value as u16).to_le_bytes().to_vec(),
        "u4" => (value as u32).to_le_bytes().to_vec(),
        "u8" => (value as u64).to_le_bytes().to_vec(),
        "f4" => (value as f32).to_le_bytes().to_vec(),
        _ => value.to_le_bytes().to_vec(),
    };
    if descr.starts_with('>') {
        bytes.reverse();
    }
    bytes
}

fn array(version: u8, descr: &str, fortran: bool, rows: &[Vec<f64>]) -> Vec<u8> {
    let columns = rows.first().map_or(3, Vec::len);
    let order = if fortran { "True" } else { "False" };
    let header = format!(
        "{{'descr': '{descr}', 'fortran_order': {order}, 'shape': ({}, {columns}), }}   \n",
        rows.len()
    );
    let mut data = Vec::new();
    if fortran {
        for column in 0..columns {
            rows.iter()
                .for_each(|row| data.extend(number(descr, row[column])));
        }
    } else {
        rows.iter()
            .flatten()
            .for_each(|value| data.extend(number(descr, *value)));
    }
    file(version, &header, &data)
}

const TYPES: [&str; 20] = [
    "|i1", "<i2", "<i4", "<i8", "|u1", "<u2", "<u4", "<u8", "<f4", "<f8", "<i1", ">i2", ">i4",
    ">i8", "=u1", ">u2", ">u4", ">u8", ">f4", ">f8",
];

#[test]
fn every_type_order_and_version() {
    for descr in TYPES {
        let sign = if descr.contains('u') { 1 } else { -1 };
        // More rows than are read at a time, so that blocks meet.
        let indices = (0..9_000).map(|i| [sign * (i % 120), i / 120, i % 7]);
        let rows: Vec<_> = indices.clone().map(|i| i.map(f64::from).to_vec()).collect();
        let expected: Vec<_> = indices.map(|index| (index, [200u8; 3])).collect();
        for fortran in [false, true] {
            for version in [1, 2, 3] {
                let bytes = array(version, descr, fortran, &rows);
                assert!(
                    read_plain(&bytes) == expected,
                    "{descr} {fortran} {version}"
                );
            }
        }
    }
    assert!(read_plain(&array(1, "<i4", false, &[])).is_empty());
}

#[test]
fn colours_in_further_columns() {
    for fortran in [false, true] {
        for extra in [vec![], vec![0.0]] {
            let row = |n: f64| [vec![n, 2.0, 3.0, 10.0 + n, 20.0, 30.0], extra.clone()].concat();
            let bytes = array(1, "<i4", fortran, &[row(0.0), row(1.0)]);
            let expected = [([0, 2, 3], [10, 20, 30]), ([1, 2, 3], [11, 20, 30])];
            assert_eq!(read_plain(&bytes), expected);
            let (_, info) = read(&bytes, &ReadOptions::default()).unwrap();
            assert!(info.has_colors);
            assert_eq!(detect(&bytes, bytes.len() as u64), Some(FileKind::Npy));
        }
    }
}

#[test]
fn messages_say_where_and_what() {
    let header = |descr: &str, order: &str, shape: &str| {
        let text = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}");
        file(1, &text, &[0; 12])
    };
    let shape = |shape: &str| header("'<i4'", "False", shape);
    refused([
        (
            array(1, "<f4", false, &[vec![0.0; 3], vec![1.0, 2.0, 2.5]]),
            "row 1, column 2 at byte 93: expected a whole number of 64 bits, the voxel's index, found 2.5",
        ),
        (
            array(1, "<f8", true, &[vec![f64::NAN; 3]]),
            "row 0, column 0",
        ),
        (
            array(1, "<i4", false, &[vec![0.0, 0.0, 0.0, 1.0, -2.0, 3.0]]),
            "expected a colour from 0 to 255, found -2",
        ),
        (
            array(1, "<i8", true, &[vec![0.0; 3], vec![0.0, 1e12, 0.0]]),
            "row 1 at byte 80: expected voxel indices that fit 32 bits with sign, found y = 1000000000000",
        ),
        (
            shape("(4,)"),
            "a shape (N, 3), (N, 6) or (N, 7), found \"(4,), }\"",
        ),
        (shape("(2, 2)"), "numpy.argwhere"),
        (shape("(1, 3, 1)"), "numpy.argwhere"),
        (
            shape("(18446744073709551615, 7)"),
            "expected 516508834063867445220 bytes of numbers, as the header says, found 12",
        ),
        (shape("(2, 3)"), "array at byte 69: expected 24 bytes"),
        (
            header("'<c8'", "False", "(1, 3)"),
            "integers of 1 to 8 bytes or floats",
        ),
        (
            header("[('x', '<i4')]", "False", "(1, 3)"),
            "integers of 1 to 8 bytes or floats",
        ),
        (
            header("'<i4'", "1", "(1, 3)"),
            "fortran_order True or False",
        ),
        (file(1, "{'fortran_order': False}", &[]), "an entry 'descr'"),
        (file(4, "{}", &[]), "format version 1, 2 or 3, found 4"),
        (
            file(2, "", &[])[..10].to_vec(),
            "header at byte 10: expected 2 bytes of header",
        ),
        (
            b"\x93NUMPY\x02\0\xff\xff\xff\x7f{}".to_vec(),
            "one of 2147483647 bytes",
        ),
    ]);
}

#[test]
fn truncations_are_errors_and_damage_never_panics() {
    for fortran in [false, true] {
        let bytes = array(1, ">i2", fortran, &vec![vec![5.0, 6.0, 7.0]; 5]);
        cut_and_damaged(&bytes, bytes.len(), 40_000);
    }
}
