//! Wrong files of every format: a message with file, place and reason, and no panic.

use shiftvox::scene::SceneError;
use shiftvox::split_mix::SplitMix;

use crate::clouds::{FORMATS, array, cloud, npy};
use crate::vox::{THREE, one_voxel, two_places};
use crate::vox_file::VoxFile;
use crate::{read, shipped};

/// The message names the file first and has `part`.
pub(crate) fn refused(bytes: &[u8], part: &str) -> SceneError {
    let error = read(bytes).expect_err(part);
    let text = error.to_string();
    let is_named = text.starts_with("test: ");
    assert!(is_named && text.contains(part), "\n{text}\nlacks\n{part}");
    error
}

/// Each row is a file's text, with `;` for line ends, and a part of the message. `PLY` means its first lines in
/// text, `POINTS` a header of two vertices.
const TEXTS: &str = "
DOOD is not a voxel | test: not a known scene file: it begins with \"DOOD
solid a; | has triangles and no voxels
# x;v 0 0 0; | has triangles and no voxels
{\"asset\":{}} | has triangles and no voxels
glTF\x02\0\0\0 | has triangles and no voxels
VOX  | test: file header at byte 0: expected \"VOX \" and a version (8 bytes), found \"VOX \"
ply;end_header; | a line \"format ... 1.0\"
ply;format ascii 2.0; | found \"format ascii 2.0\"
ply;format utf8 1.0; | binary_little_endian or binary_big_endian
PLY ; | the line \"end_header\", found the end of the file
PLY element vertex many; | header at byte 21: expected \"element NAME COUNT\" with a whole number, found \"element vertex m
PLY property int x; | a line \"element\" before the first property
PLY element vertex 1;property word x; | types char to double
PLY element vertex 1;property list float int x; | types char to double
PLY element face 0;end_header; | expected an element \"vertex\"
PLY element vertex 1;property int x;end_header; | the properties x, y and z
PLY element vertex 1;property int x;element face 1;end_header; | this is a .ply mesh, which has triangles and no voxels
PLY elephant; | format, element, property, comment or end_header
POINTS ; | vertex 0 at byte
POINTS 1 2 3;1 2; | vertex 1 at byte 100: expected a number for property z, found the end of the line
POINTS 1 2 x; | found \"x\"
POINTS 1 2 3 4; | found \"4\" after them
POINTS 0 0 3000000000; | fit 32 bits with sign, found z = 3000000000
POINTS 0 NaN 0;0 0 0; | vertex 0, property y at byte 94: expected a whole number, the voxel's index, found NaN
#binvox 3; | expected \"#binvox 1\" or \"#binvox 2\", found \"#binvox 3\"
#binvox 1;data; | header at byte 10: expected a line \"dim\"
#binvox 1;dim 0 1 1; | expected sizes from 1 to 2097151
#binvox 1;dim 1 1 2097152; | expected sizes from 1 to 2097151
#binvox 1;dim 1 1; | expected dim, translate, scale or data
#binvox 1;dim 1 1 1; | expected a line of at most 255 bytes
#binvox 1;dim 1 1 1;dim 1 1 1; | expected dim, translate
#binvox 1;dim 1 1 4;data;\x01\x05 | a run of at most 4 cells, found 5
#binvox 1;dim 2097151 2097151 2097151;data;\0\x7f | runs at byte 45: expected runs of 9223358842721533951 cells, found 127 cells
";

/// Element type, order and shape of an array of 12 bytes, and a part of the message.
const ARRAYS: [[&str; 4]; 10] = [
    ["'<i4'", "False", "(4,)", "(N, 7), found \"(4,), }\""],
    ["'<i4'", "False", "(2, 2)", "numpy.argwhere"],
    ["'<i4'", "False", "(1, 3, 1)", "numpy.argwhere"],
    ["'<i4'", "False", "(2, 3)", "array at byte 69: expected 24"],
    ["'<i4'", "False", "(18446744073709551615, 7)", "found 12"],
    ["'<i4'", "1", "(1, 3)", "fortran_order True or False"],
    ["'<c8'", "False", "(1, 3)", "floats of 4 or 8"],
    ["'<i3'", "False", "(1, 3)", "floats of 4 or 8"],
    ["[('x', '<i4')]", "False", "(1, 3)", "floats of 4 or 8"],
    ["'<i4'", "False", "1, 3", "(N, 7), found \"1, 3, }\""],
];

#[test]
fn messages_about_texts_and_arrays() {
    for row in TEXTS.lines().skip(1) {
        let (text, part) = row.split_once(" | ").unwrap();
        let points =
            "PLY element vertex 2;property int x;property int y;property int z;end_header;";
        let text = text.replace("POINTS ", points);
        let text = text.replace("PLY ", "ply;format ascii 1.0;");
        refused(text.replace(';', "\n").as_bytes(), part);
    }
    for (line, most) in [("ply\n", "4096 bytes"), ("#binvox 1\n", "255 bytes")] {
        refused((line.to_owned() + &"x".repeat(5000)).as_bytes(), most);
    }
    for [descr, order, shape, part] in ARRAYS {
        let text = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}");
        refused(&npy(1, &text, &[0; 12]), part);
    }
}

/// Format of a PLY or type of an array, columns or order, rows, and a part of the message.
const NUMBERS: &str = "
binary_little_endian | float x, float y, float z | 0 0 0; 1 0.5 2 | vertex 1, property y at byte 145: expected a whole number, the voxel's index, found 0.5
binary_little_endian | float x, float y, float z | inf 0 0 | found inf
binary_big_endian | int x, int y, int z, int red, int green, int blue | 0 0 0 256 0 0 | property red at byte
<f4 | rows | 0 0 0; 1 2 2.5 | row 1, column 2 at byte 93: expected a whole number, the voxel's index, found 2.5
<f8 | columns | NaN 0 0 | row 0, column 0
<i4 | rows | 0 0 0 1 -2 3 | expected a colour from 0 to 255, found -2
<i8 | columns | 0 0 0; 0 1e12 0 | row 1 at byte 80: expected voxel indices that fit 32 bits with sign, found y = 1000000000000
";

#[test]
fn messages_about_numbers() {
    for row in NUMBERS.lines().skip(1) {
        let [format, columns, rows, part] = row.split(" | ").collect::<Vec<_>>()[..] else {
            panic!("{row}");
        };
        let numbers = |row: &str| row.split(' ').map(|n| n.parse().unwrap()).collect();
        let rows: Vec<Vec<f64>> = rows.split("; ").map(numbers).collect();
        let bytes = match format.starts_with('<') {
            true => array(1, format, columns == "columns", &rows),
            false => cloud(format, columns, &rows),
        };
        refused(&bytes, part);
    }
    let short = cloud(FORMATS[1], "int x, int y, int z", &[[1.0, 2.0, 3.0]]);
    let part = "vertex 0 at byte 127: expected as many elements as the header says";
    refused(&short[..short.len() - 1], part);
    refused(&npy(1, "{'fortran_order': False}", &[]), "an entry 'descr'");
    refused(&npy(4, "{}", &[]), "version 1, 2 or 3, found 4");
    refused(&npy(2, "", &[])[..10], "byte 10: expected 2 bytes");
    let long = b"\x93NUMPY\x02\0\xff\xff\xff\x7f{}";
    refused(long, "one of 2147483647 bytes");
    // Counts of a header are not believed.
    let lists = "element vertex N;property list uint double w;property int x;property int y;property int z;";
    for format in FORMATS {
        for before in ["element nothing N;element a N;property double b;", ""] {
            let text =
                format!("ply;format {format} 1.0;{before}{lists}end_header;\x7f\x7f\x7f\x7f");
            let text = text.replace('N', &u64::MAX.to_string());
            refused(text.replace(';', "\n").as_bytes(), "found");
        }
    }
}

/// The parts of a `.vox` file, see [`compose`], and a part of the message.
const FILES: &str = "
XYZI 4 | a chunk SIZE before each XYZI
SIZE 12 | a chunk XYZI after each SIZE
SIZE 12; voxel | a chunk XYZI after each SIZE
SIZE 8 | 4 bytes of the size along z, found 0 bytes left
RGBA 4 | expected at least one model
voxel; RGBA 1022 | chunk RGBA
voxel; RGBA 1028 | 1028 bytes
turned 3 | chunk nTRN (node 2), attribute _r
turned 5 | two different axes of 0, 1, 2, bits 4-6 signs, found 5
turned 132 | found 132
placed 1 2 | three whole numbers of 32 bits, found \"1 2\"
placed 1 2 3 4 | found \"1 2 3 4\"
placed 0 0 0; shape 6; group 6 | the id of the chunk nSHP (node 6)
voxel; moved 0 1; group 1 0 | without circles, found node 0
voxel; group 0 0 | chunk nGRP (node 0)
voxel; moved 0 7 | a node with id 7
voxel; shape 3 0 | the root has id 0
voxel; shape 0 1 | chunk nSHP (node 0) at byte 64: expected a model from 0 to 0, found model 1
";

/// A file of nodes with their numbers, models of a voxel, two places of which one is turned or placed, and chunks with
/// their lengths.
fn compose(text: &str) -> VoxFile {
    text.split("; ").fold(VoxFile::default(), |file, item| {
        let (name, rest) = item.split_once(' ').unwrap_or((item, ""));
        let numbers: Vec<u32> = rest.split(' ').flat_map(str::parse).collect();
        match (name, &numbers[..]) {
            ("voxel", _) => file.model([1, 1, 1], &[[0, 0, 0, 1]]),
            ("turned", _) => two_places(&[("_r", rest)], &[]),
            ("placed", _) => two_places(&[("_t", rest)], &[]),
            ("moved", &[id, child]) => file.moved([id, child], &[]),
            ("group", [id, children @ ..]) => file.group(*id, children),
            ("shape", [id]) => file.shape(*id, &[]),
            ("shape", [id, model]) => file.shape(*id, &[(*model, &[])]),
            (id, [length, ..]) => file.chunk(
                id.as_bytes().try_into().unwrap(),
                &vec![0; *length as usize],
            ),
            _ => panic!("{item}"),
        }
    })
}

#[test]
fn messages_about_vox_files() {
    for row in FILES.lines().skip(1) {
        let (text, part) = row.split_once(" | ").unwrap();
        refused(&compose(text).bytes(), part);
    }
    let good = two_places(&[], &[]).bytes();
    let part = "test: chunk \"MAIN\" at byte 8: expected 0 bytes of content and";
    refused(&good[..good.len() - 5], part);
    for (at, value, part) in [
        (12, 4, "\"MAIN\" at byte 8"),
        (24, 4_000_000_000u32, "\"SIZE\" at byte 20: expected 40000"),
        (56, 77, "fits the chunk, at most 1, found 77"),
    ] {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        refused(&bytes, part);
    }
    // Scenes that are too large.
    let apart = |first, second| two_places(&[("_t", first)], &[("_t", second)]).bytes();
    let (voxels, _) = read(&apart("-1048575 0 0", "1048575 0 0")).unwrap();
    assert_eq!(voxels.len(), 2);
    for (first, second, part) in [
        ("-1048576 0 0", "1048576 0 0", "at least 2097153 along x"),
        ("2147483647 0 0", "0 0 0", "x = 2147483648"),
    ] {
        assert!(refused(&apart(first, second), part).is_limit());
    }
}

/// No beginning shorter than `whole` is accepted, and no damage panics.
pub(crate) fn cut_and_damaged(bytes: &[u8], whole: usize, rounds: u64) {
    for length in 0..whole {
        assert!(read(&bytes[..length]).is_err(), "{length}");
    }
    for seed in 0..rounds {
        let mut dice = SplitMix::new(seed);
        let mut damaged = bytes.to_vec();
        for _ in 0..=dice.below(4) {
            let byte = &mut damaged[dice.below(bytes.len() as u64) as usize];
            let others = [0, 255, *byte ^ 1 << dice.below(8), dice.bits() as u8];
            *byte = others[dice.below(4) as usize];
        }
        let _ = read(&damaged);
    }
}

#[test]
fn truncations_are_errors_and_damage_never_panics() {
    let columns = "short x, short y, short z, uchar red, uchar green, uchar blue";
    for format in FORMATS {
        let bytes = cloud(format, columns, &[[-5.0, 6.0, 7.0, 8.0, 9.0, 10.0]; 3]);
        // In text, the last number may lose digits, or the last line its end, unseen.
        let unseen = if format == "ascii" { 2 } else { 0 };
        cut_and_damaged(&bytes, bytes.len() - unseen, 20_000);
    }
    for fortran in [false, true] {
        let bytes = array(1, ">i2", fortran, &[[5.0, 6.0, 7.0]; 5]);
        cut_and_damaged(&bytes, bytes.len(), 40_000);
    }
    let grid = b"#binvox 1\ndim 2 3 4\ntranslate 0 1 2e-3\nscale 7\ndata\n\x00\x05\x01\x03\x00\x10";
    cut_and_damaged(grid, grid.len(), 20_000);
    let file = two_places(&[("_t", "1 2 3")], &[("_r", "17")]);
    let file = file.layer(0, &[]).palette(&THREE).bytes();
    cut_and_damaged(&file, file.len(), 40_000);
    for length in 20..file.len() {
        // The main chunk is made to fit, so its contents are cut and not the chunk itself.
        let mut bytes = file[..length].to_vec();
        bytes[16..20].copy_from_slice(&(length as u32 - 20).to_le_bytes());
        let _ = read(&bytes);
    }
    let nodes = one_voxel().chunks(&shipped("tests/data/extended.vox")[19_676..]);
    cut_and_damaged(&nodes.bytes(), 0, 4_000);
    cut_and_damaged(&shipped("tests/data/sphere.vox"), 0, 4_000);
}
