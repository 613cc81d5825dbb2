//! Clouds of points: PLY and NumPy with real numbers, text, and PCD.

use shiftvox::graph::Silent;
use shiftvox::scene::{NoMeshes, OpenOptions, ReadOptions, open_bytes};

use crate::clouds::{FORMATS, array, cloud};
use crate::wrong::refused;
use crate::{Plain, read, read_plain, read_with};

fn sized(size: f64) -> ReadOptions {
    ReadOptions {
        voxel_size: Some(size),
        ..ReadOptions::default()
    }
}

#[track_caller]
fn check(bytes: &[u8], size: Option<f64>, expected: &[Plain]) {
    let options = size.map_or_else(ReadOptions::default, sized);
    let (voxels, info) = read_with(bytes, &options).unwrap();
    let voxels: Vec<Plain> = voxels.iter().map(|v| (v.index, v.color)).collect();
    assert_eq!((&voxels[..], info.voxel_size), (expected, size));
}

const POINTS: [[f64; 3]; 3] = [[0.0, -0.25, 0.5], [0.74, 25.5, -0.5], [f64::NAN, 0.0, 0.0]];
const GRAY: [u8; 3] = [200; 3];
const VOXELS: [Plain; 2] = [([0, -1, 1], GRAY), ([1, 51, -1], GRAY)];

#[test]
fn points_fill_the_voxels_that_contain_them() {
    for format in FORMATS {
        let bytes = cloud(format, "double x, double y, double z", &POINTS);
        check(&bytes, Some(0.5), &VOXELS);
        let (_, info) = read_with(&bytes, &sized(0.5)).unwrap();
        let told = "1 points whose coordinates are infinite or not numbers were left out";
        assert_eq!(info.warnings, [told]);
        // The extent of 25.75, divided by 256.
        refused(&bytes, "vertex 0, property y at byte ");
        refused(
            &bytes,
            "need a voxel's size: --voxel-size 0.1 gives about 256 voxels",
        );
    }
    check(&array(1, "<f8", false, &POINTS), Some(0.5), &VOXELS);
    check(
        &array(1, "<f8", true, &[[4.0, 5.0, 6.0]]),
        Some(2.0),
        &[([2, 2, 3], GRAY)],
    );
    refused(&array(1, "<f8", true, &POINTS), "--voxel-size 0.1 gives");
    refused(
        &array(1, "<f8", true, &[[0.5; 3]]),
        "give the voxel's size by --voxel-size",
    );
    // World coordinates stay those of the file.
    let options = OpenOptions {
        read: sized(0.5),
        ..OpenOptions::default()
    };
    let bytes = cloud(FORMATS[0], "float x, float y, float z", &POINTS[..2]);
    let graph = open_bytes(&bytes, "a", &options, &NoMeshes, &Silent)
        .unwrap()
        .graph;
    assert_eq!((graph.placement.voxel_size, graph.voxels), (0.5, 2));
}

#[test]
fn text_of_points_with_colours_and_other_columns() {
    let gray = |index| (index, GRAY);
    let [a, b] = [[1, 2, 3], [-4, 5, 6]];
    for (text, expected) in [
        ("1 2 3\n-4 5 6\n", [gray(a), gray(b)]),
        (
            "\u{feff}# a\n//X,Y,Z\nx,y,z\n2\n1.0,2.0,3.0\r\n\n-4;5 6e0",
            [gray(a), gray(b)],
        ),
        (
            "1 2 3 10 20 30\n-4 5 6 0 0 255\n",
            [(a, [10, 20, 30]), (b, [0, 0, 255])],
        ),
        (
            "1 2 3 99 10 20 30\n-4 5 6 0.5 0 0 255\n",
            [(a, [10, 20, 30]), (b, [0, 0, 255])],
        ),
        // Normals and intensities.
        ("1 2 3 0.0 1.0 0.0\n-4 5 6 1 0 0\n", [gray(a), gray(b)]),
        ("1 2 3 7\n-4 5 6 300\n", [gray(a), gray(b)]),
    ] {
        assert_eq!(read_plain(text.as_bytes()), expected, "{text}");
    }
    let (_, info) = read_with(b"1 2 3 0.5 0.5 1\n", &ReadOptions::default()).unwrap();
    assert!(info.warnings[0].starts_with("columns from 4 of 6 are not drawn"));
    check(b"0 -0.25 0.5\n0.74 25.5 -0.5\n", Some(0.5), &VOXELS);
    for (text, part) in [
        (
            "1 2 3\n1 2\n",
            "line 2 at byte 6: expected 3 numbers, found \"1 2\"",
        ),
        (
            "1 2 3\n\n1 2 x\n",
            "line 3 at byte 7: expected a number, found \"x\"",
        ),
        ("x\n1 2 3\nx1 2 3\n", "line 3 at byte 8: expected a number"),
        (
            "1 2 3 1 2 3\n1 2 3 1 2 256\n",
            "line 2 at byte 12: expected colours from 0 to 255",
        ),
        (
            "1 2 3 0 0 1\n4 5 6 0 0 -1\n",
            "such as normals, leave the columns out",
        ),
        ("1 2 3.5\n", "line 1 at byte 0: expected a whole number"),
        ("1 2\n", "not a known scene file"),
    ] {
        refused(text.as_bytes(), part);
    }
}

const PCD: &str = "# .PCD v0.7\nVERSION 0.7\nFIELDS pad x y z rgb normal_x normal_y normal_z\n\
    SIZE 2 8 4 4 4 4 4 4\nTYPE U F F F F F F F\nCOUNT 3 1 1 1 1 1 1 1\nWIDTH 2\nHEIGHT 1\n\
    VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ";

/// A change of a sound file, and a part of the message.
const WRONG_PCD: &str = r#"ascii => binary_compressed | pcl_convert_pcd_ascii_binary IN.pcd OUT.pcd 1
DATA ascii => DATA | expected FIELDS, SIZE, TYPE, COUNT
WIDTH 1 => WIDTH x | header at byte 55: expected a whole number, found "WIDTH x"
WIDTH 1\n =>  | a line POINTS, or WIDTH and HEIGHT
x y z => u v w | the fields x, y and z
x y z => x y | SIZE, TYPE and COUNT of 3 fields, found 4, 4 and 3
I U F U => I U F X | expected the types I and U of 1 to 8 bytes or F of 4 or 8, found "X 4"
WIDTH => COUNT 1 1 1 99999\nWIDTH | in 65536 bytes at most, found 99999
HEIGHT 1 => HEIGHT 2 | point 1 at byte 97: expected 2 points, found the end
1 2 3 1 => 1 2 1 | point 0 at byte 83: expected 4 numbers, found "1 2 1315860"
DATA ascii\n1 2 3 1315860\n =>  | expected a line DATA, found the end of the file"#;

pub(crate) fn pcd() -> Vec<u8> {
    let mut bytes = [PCD, "binary\n"].concat().into_bytes();
    for (x, z, color) in [(1f64, 0.5f32, 0x0a_141e_u32), (f64::NAN, 0.0, 0)] {
        bytes.extend([7; 6]);
        bytes.extend(x.to_le_bytes());
        let reals = [-3.0, z, f32::from_bits(color), 0.0, 0.0, 1.0];
        bytes.extend(reals.map(f32::to_le_bytes).concat());
    }
    bytes
}

#[test]
fn clouds_of_the_point_cloud_library() {
    let rgb = f32::from_bits(0x0a_141e);
    let text = format!("{PCD}ascii\n7 7 7 1 -3 0.5 {rgb:e} 0 0 1\n7 7 7 nan -3 0 0 0 0 1\n");
    for bytes in [text.as_bytes(), &pcd()] {
        check(bytes, Some(0.5), &[([2, -6, 1], [10, 20, 30])]);
        let (voxels, _) = read_with(bytes, &sized(0.5)).unwrap();
        assert!(voxels[0].normal.is_some());
        refused(bytes, "point 0 at byte ");
    }
    // Also a colour whose bits are no number.
    let mut bytes = pcd();
    let first_color = bytes.len() - 2 * 38 + 22;
    bytes[first_color + 2..][..2].copy_from_slice(&[0x80, 0xff]);
    check(&bytes, Some(0.5), &[([2, -6, 1], [0x80, 20, 30])]);
    let plain = "VERSION .7\nFIELDS x y z rgba\nSIZE 4 4 4 4\nTYPE I U F U\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2 3 1315860\n";
    assert_eq!(read_plain(plain.as_bytes()), [([1, 2, 3], [20, 20, 20])]);
    refused(
        &pcd()[..pcd().len() - 1],
        "point 1 at byte 236: expected 2 points, found the end",
    );
    for row in WRONG_PCD.lines() {
        let (change, part) = row.split_once(" | ").unwrap();
        let (from, to) = change.split_once(" => ").unwrap();
        let [from, to] = [from, to].map(|text| text.replace("\\n", "\n"));
        refused(plain.replace(&from, &to).as_bytes(), part);
    }
    assert!(read(PCD.replace("POINTS 2", "POINTS 99999999999").as_bytes()).is_err());
}
