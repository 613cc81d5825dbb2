//! `.vox` files: composed ones are read as they were written, real ones as recorded, wrong ones are refused.

use std::collections::BTreeSet;
use std::path::Path;

use proptest::prelude::*;
use shiftvox::graph::{Silent, Voxel};
use shiftvox::scene::{OutOfBounds, ReadOptions, SceneError, VoxWriter, VoxWritten, read_voxels};
use xxhash_rust::xxh3::xxh3_64;

use crate::input_support::{
    Attributes, Plain, VoxFile, cut_and_damaged, digest, read, read_plain, refused, shared, shipped,
};

/// Colours 1, 2, 3.
const THREE: [[u8; 4]; 3] = [[10, 20, 30, 255], [40, 50, 60, 0], [70, 80, 90, 255]];

fn by(oob: OutOfBounds) -> ReadOptions {
    ReadOptions {
        oob,
        ..ReadOptions::default()
    }
}

fn places(file: &VoxFile) -> Vec<[i32; 3]> {
    read_plain(&file.bytes()).iter().map(|v| v.0).collect()
}

fn one_voxel() -> VoxFile {
    VoxFile::new().model([1, 1, 1], &[[0, 0, 0, 1]])
}

/// A model of one voxel under a root, a group and two transforms.
fn two_places(first: Attributes<'_>, second: Attributes<'_>) -> VoxFile {
    VoxFile::new()
        .model([4, 2, 1], &[[3, 0, 0, 1]])
        .transform(0, &[], 1, -1, &[&[]])
        .group(1, &[2, 4])
        .transform(2, &[], 3, 0, &[first])
        .shape(3, &[(0, &[])])
        .transform(4, &[], 5, 1, &[second])
        .shape(5, &[(0, &[])])
}

#[test]
fn models_without_a_graph_keep_their_coordinates() {
    let file = VoxFile::new()
        .chunk(b"PACK", &2u32.to_le_bytes())
        .model([5, 6, 7], &[[4, 5, 6, 1], [0, 0, 0, 2]])
        .model([2, 2, 2], &[[0, 1, 0, 3], [0, 0, 0, 0]])
        .palette(&THREE)
        .bytes();
    // Alpha means nothing, and colour 0 means no voxel.
    let expected = [
        ([4, 5, 6], [10, 20, 30]),
        ([0, 0, 0], [40, 50, 60]),
        ([0, 1, 0], [70, 80, 90]),
    ];
    assert_eq!(read_plain(&file), expected);
    let (_, info) = read(&file, &ReadOptions::default()).unwrap();
    assert_eq!((info.voxels, info.stored_voxels), (3, 4));
    assert!(info.warnings[0].contains("1 voxels have colour index 0"));
    assert!(info.warnings[1].contains("2 models and no scene graph"));
}

#[test]
fn palettes_missing_short_and_odd() {
    let all: Vec<[u8; 4]> = (1..=255).map(|color| [0, 0, 0, color]).collect();
    let model = || VoxFile::new().model([1, 1, 1], &all);
    let colors = |file: VoxFile| {
        let voxels = read_plain(&file.bytes());
        voxels.iter().map(|v| v.1).collect::<Vec<_>>()
    };
    // MagicaVoxel's: index 1 is white, 4 the fourth step of blue, 255 the darkest grey.
    let default = colors(model());
    assert_eq!(
        [default[0], default[3], default[254]],
        [[255; 3], [255, 255, 102], [0x11; 3]]
    );
    assert_eq!(xxh3_64(default.as_flattened()), 0x6d5e2319522e8f50);
    let short = colors(model().palette(&THREE));
    assert_eq!((short[2], &short[3..]), ([70, 80, 90], &default[3..]));
    let (_, info) = read(&model().palette(&THREE).bytes(), &ReadOptions::default()).unwrap();
    assert!(info.warnings[0].contains("beyond the palette's 3 entries"));
    let full: Vec<[u8; 4]> = (0..=255).map(|i| [i, 255 - i, 7, 9]).collect();
    let expected: Vec<[u8; 3]> = (0..=254).map(|i| [i, 255 - i, 7]).collect();
    for palette in [&full[..], &full[..255]] {
        assert_eq!(colors(model().palette(palette)), expected);
    }
}

#[test]
fn a_model_placed_twice_and_turned() {
    // Pivot (2, 1, 0); the voxel's centre is (1.5, -0.5, 0.5). Byte 17 is x' = -y, y' = x.
    let file = two_places(&[("_t", "10 20 30")], &[("_r", "17"), ("_t", "-100 0 5")]);
    assert_eq!(places(&file), [[11, 19, 30], [-100, 1, 5]]);
}

#[test]
fn hidden_nodes_and_layers_are_left_out() {
    let file = two_places(&[], &[("_t", "9 0 0")])
        .layer(1, &[("_hidden", "1")])
        .layer(0, &[("_hidden", "0")]);
    assert_eq!(places(&file), [[1, -1, 0]]);
    let (_, info) = read(&file.bytes(), &ReadOptions::default()).unwrap();
    assert_eq!((info.instances, info.hidden_instances), (1, 1));
    // A hidden node hides what is below it.
    let file = one_voxel()
        .transform(0, &[("_hidden", "1")], 1, -1, &[&[]])
        .group(1, &[2])
        .transform(2, &[], 3, -1, &[&[]])
        .shape(3, &[(0, &[])]);
    assert!(places(&file).is_empty());
}

#[test]
fn the_first_key_frame_is_read() {
    let at = |first: &str, second: &str| {
        let frames: &[Attributes<'_>] = &[
            &[("_t", "50 0 0"), ("_f", "10")],
            &[("_t", "7 0 0"), ("_f", first)],
        ];
        let file = one_voxel()
            .model([3, 1, 1], &[[2, 0, 0, 1]])
            .transform(0, &[], 1, -1, frames)
            .shape(1, &[(0, &[("_f", second)]), (1, &[("_f", "20")])]);
        places(&file)
    };
    assert_eq!(at("0", "0"), [[7, 0, 0]]);
    // All later than 0, or together.
    assert_eq!(at("30", "20"), [[50, 0, 0], [51, 0, 0]]);
    assert_eq!(at("-3", "40"), [[8, 0, 0]]);
}

#[test]
fn of_equal_places_the_last_counts() {
    let mut file = one_voxel()
        .model([1, 1, 1], &[[0, 0, 0, 2]])
        .transform(0, &[], 1, -1, &[&[]])
        .group(1, &[2, 4, 6]);
    for (id, shape) in [(2, 3), (4, 5), (6, 3)] {
        file = file.transform(id, &[], shape, -1, &[&[]]);
    }
    let file = file
        .shape(3, &[(0, &[])])
        .shape(5, &[(1, &[])])
        .palette(&THREE);
    let colors = read_plain(&file.bytes()).into_iter().map(|v| v.1[0]);
    assert!(colors.eq([40, 10]));
}

/// VoxelShop writes such files: a byte outside `SIZE` means a number below 0, about the same pivot.
#[test]
fn voxels_outside_the_size_by_every_rule() {
    let stored = [[0, 19, 88, 1], [203, 72, 0, 1], [238, 0, 5, 1]];
    let file = VoxFile::new().model([20, 20, 90], &stored).bytes();
    for (oob, voxels, low, high) in [
        (OutOfBounds::Wrap, 3, [-53, 0, 0], [0, 72, 88]),
        (OutOfBounds::Keep, 3, [0, 0, 0], [238, 72, 88]),
        (OutOfBounds::Drop, 1, [0, 19, 88], [0, 19, 88]),
    ] {
        let (_, info) = read(&file, &by(oob)).unwrap();
        let found = (info.voxels, info.outside_size, info.bounds);
        assert_eq!(found, (voxels, 2, Some((low, high))), "{oob:?}");
    }
    let refused = read(&file, &by(OutOfBounds::Error))
        .unwrap_err()
        .to_string();
    let told = refused.contains("SIZE [20, 20, 90]") && refused.contains("wrap, keep or drop");
    assert!(told, "{refused}");
    // 250 in a size of 4 is -6; centre -6 - 2 + 1/2 = -7.5 along x.
    for (rotation, oob, index) in [
        ("4", OutOfBounds::Wrap, [-8, -1, 0]),
        ("17", OutOfBounds::Wrap, [0, -8, 0]),
        ("4", OutOfBounds::Keep, [248, -1, 0]),
    ] {
        let file = VoxFile::new()
            .model([4, 2, 1], &[[250, 0, 0, 1]])
            .transform(0, &[], 1, -1, &[&[("_r", rotation)]])
            .shape(1, &[(0, &[])]);
        assert_eq!(read(&file.bytes(), &by(oob)).unwrap().0[0].index, index);
    }
}

/// Stored voxels, voxels that are passed on, different indices, models, nodes; then a digest of the voxels in order
/// and of the palette.
fn summary(bytes: &[u8]) -> ([u64; 5], u64, u64) {
    let (_, info) = read(bytes, &ReadOptions::default()).unwrap();
    let voxels = read_plain(bytes);
    let distinct = voxels.iter().map(|v| v.0).collect::<BTreeSet<_>>().len() as u64;
    let [models, nodes] = [info.models, info.nodes].map(u64::from);
    let counts = [info.stored_voxels, info.voxels, distinct, models, nodes];
    (
        counts,
        digest(&voxels),
        xxh3_64(info.palette.as_flattened()),
    )
}

#[test]
fn real_files_are_as_recorded() {
    for (path, counts, voxels, palette) in [
        (
            "tests/data/sphere.vox",
            [2_103, 2_103, 2_103, 1, 0],
            0x01ce2d9ddff7bea7,
            0xc1406b60c2dd174b,
        ),
        (
            "tests/data/axes.vox",
            [4_372, 12_452, 12_452, 4, 28],
            0x22fbcb9192636d63,
            0x501e4d120fa075c4,
        ),
        (
            "tests/data/extended.vox",
            [4_854, 4_854, 4_854, 6, 14],
            0xc596a3633a7a0465,
            0x501e4d120fa075c4,
        ),
        (
            "assets/tree.vox",
            [428_739, 804_872, 768_068, 2, 8],
            0xa813829c8a2ecac8,
            0x37f62662fcea1bdf,
        ),
    ] {
        assert_eq!(summary(&shipped(path)), (counts, voxels, palette), "{path}");
    }
    let mut voxels = Vec::new();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/axes.vox");
    let mut sink = |v: Voxel| voxels.push((v.index, v.color));
    read_voxels(&path, &ReadOptions::default(), &mut sink, &Silent).unwrap();
    assert_eq!(voxels, read_plain(&shipped("tests/data/axes.vox")));
}

/// Voxels outside `SIZE` are where the twin, which fits its `SIZE`, has them.
#[test]
#[ignore = "needs the files of SHIFTVOX_DATA"]
fn voxelshop_files_equal_their_twins() {
    let at_origin = |bytes: &[u8]| {
        let mut voxels = read_plain(bytes);
        for axis in 0..3 {
            let low = voxels.iter().map(|(index, _)| index[axis]).min().unwrap();
            voxels.iter_mut().for_each(|(index, _)| index[axis] -= low);
        }
        voxels.sort_unstable();
        voxels
    };
    for (name, voxels, expected) in [
        ("black", 14_208, 0xeffe4aebe02fa307),
        ("castle", 2_628, 0x65d8e22d80e38e59),
        ("church", 10_182, 0x08ea8bcfab8e5114),
        ("clock", 1_728, 0xe71a9a910a3a716a),
        ("dragon", 40_265, 0xf7d76551ca3f854e),
    ] {
        let [wrapped, twin] = ["bb", "size"]
            .map(|folder| shared(&format!("vox/voxelshop/fit_to_{folder}/{name}.vox")));
        for bytes in [&wrapped, &twin] {
            assert_eq!(summary(bytes).0, [voxels, voxels, voxels, 1, 0], "{name}");
        }
        assert_eq!(at_origin(&wrapped), at_origin(&twin), "{name}");
        assert_eq!(summary(&twin).1, expected, "{name}");
    }
}

#[test]
fn messages_say_where_and_what() {
    let good = two_places(&[], &[]).bytes();
    let claims = |at: usize, value: u32| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    let model = || VoxFile::new().model([1, 1, 1], &[[0, 0, 0, 1]]);
    let moved = |first: Attributes<'_>| two_places(&[first[0]], &[]).bytes();
    refused([
        (
            b"DOOD is not a voxel".to_vec(),
            "test: not a known scene file: it begins with \"DOOD",
        ),
        (
            good[..good.len() - 5].to_vec(),
            "test: chunk \"MAIN\" at byte 8: expected 0 bytes of content and",
        ),
        (
            b"VOX ".to_vec(),
            "test: file header at byte 0: expected \"VOX \" and a version (8 bytes), found \"VOX \"",
        ),
        (
            claims(24, 4_000_000_000),
            "chunk \"SIZE\" at byte 20: expected 4000000000 bytes of content",
        ),
        (
            claims(56, 77),
            "chunk XYZI at byte 56: expected a number of voxels that fits the chunk, at most 1, found 77",
        ),
        (VoxFile::new().bytes(), "expected at least one model"),
        (
            VoxFile::new().chunk(b"XYZI", &[0; 4]).bytes(),
            "a chunk SIZE before each XYZI",
        ),
        (
            VoxFile::new().chunk(b"SIZE", &[0; 12]).bytes(),
            "a chunk XYZI after each SIZE",
        ),
        (
            VoxFile::new().chunk(b"SIZE", &[0; 8]).bytes(),
            "4 bytes of the size along z, found 0 bytes left",
        ),
        (model().chunk(b"RGBA", &[0; 1022]).bytes(), "chunk RGBA"),
        (model().chunk(b"RGBA", &[0; 1028]).bytes(), "1028 bytes"),
        (moved(&[("_r", "3")]), "chunk nTRN (node 2), attribute _r"),
        (
            moved(&[("_r", "5")]),
            "two different axes of 0, 1, 2, bits 4-6 signs, found 5",
        ),
        (
            moved(&[("_t", "1 2")]),
            "three whole numbers of 32 bits, found \"1 2\"",
        ),
        (moved(&[("_t", "1 2 3 4")]), "found \"1 2 3 4\""),
        (
            two_places(&[], &[]).shape(6, &[]).group(6, &[]).bytes(),
            "the id of the chunk nSHP (node 6)",
        ),
        (
            model()
                .transform(0, &[], 1, -1, &[&[]])
                .group(1, &[0])
                .bytes(),
            "without circles, found node 0",
        ),
        (model().group(0, &[0]).bytes(), "chunk nGRP (node 0)"),
        (
            model().transform(0, &[], 7, -1, &[&[]]).bytes(),
            "a node with id 7",
        ),
        (model().shape(3, &[(0, &[])]).bytes(), "the root has id 0"),
        (
            model().shape(0, &[(1, &[])]).bytes(),
            "chunk nSHP (node 0) at byte 64: expected a model from 0 to 0, found model 1",
        ),
    ]);
    let path = Path::new("/nowhere/at all.vox");
    let error = read_voxels(path, &ReadOptions::default(), &mut |_| (), &Silent).unwrap_err();
    assert!(matches!(error, SceneError::Io { .. }));
    let text = error.to_string();
    assert!(
        text.starts_with("/nowhere/at all.vox: cannot open the file: "),
        "{text}"
    );
}

#[test]
fn far_scenes_are_refused_as_too_large() {
    let at = |first: &str, second: &str| {
        let file = two_places(&[("_t", first)], &[("_t", second)]);
        read(&file.bytes(), &ReadOptions::default()).map(|(voxels, _)| voxels.len())
    };
    assert_eq!(at("-1048575 0 0", "1048575 0 0").unwrap(), 2);
    for (first, second, part) in [
        ("-1048576 0 0", "1048576 0 0", "at least 2097153 along x"),
        ("2147483647 0 0", "0 0 0", "x = 2147483648"),
    ] {
        let error = at(first, second).unwrap_err();
        let told = error.to_string();
        assert!(error.is_limit() && told.contains(part), "{told}");
    }
}

#[test]
fn deep_scenes_do_not_exhaust_the_stack() {
    let mut file = one_voxel();
    for id in 0..20_000 {
        file = file.transform(id, &[], id + 1, -1, &[&[("_t", "1 0 0")]]);
    }
    assert_eq!(places(&file.shape(20_000, &[(0, &[])])), [[20_000, 0, 0]]);
}

#[test]
fn truncations_are_errors_and_damage_never_panics() {
    let file = two_places(&[("_t", "1 2 3")], &[("_r", "17")])
        .layer(0, &[])
        .palette(&THREE)
        .bytes();
    cut_and_damaged(&file, file.len(), 40_000);
    for length in 20..file.len() {
        // The main chunk is made to fit, so its contents are cut and not the chunk itself.
        let mut bytes = file[..length].to_vec();
        bytes[16..20].copy_from_slice(&(length as u32 - 20).to_le_bytes());
        let _ = read(&bytes, &ReadOptions::default());
    }
    let nodes = one_voxel().chunks(&shipped("tests/data/extended.vox")[19_676..]);
    cut_and_damaged(&nodes.bytes(), 0, 4_000);
    cut_and_damaged(&shipped("tests/data/sphere.vox"), 0, 4_000);
}

fn written(voxels: impl IntoIterator<Item = Plain>) -> (Vec<u8>, VoxWritten) {
    let mut writer = VoxWriter::new();
    for (index, color) in voxels {
        writer.add(Voxel {
            index,
            color,
            normal: None,
        });
    }
    let mut bytes = Vec::new();
    let written = writer.write(&mut bytes).unwrap();
    (bytes, written)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn the_writer_keeps_every_voxel(
        voxels in prop::collection::btree_map(
            prop::array::uniform3(-700i32..700), any::<[u8; 3]>(), 0..200),
    ) {
        // A voxel given twice counts as it was given last; otherwise the order does not matter.
        let twice = voxels.keys().map(|&index| (index, [1, 2, 3]));
        let (bytes, report) = written(twice.chain(voxels.clone()));
        let (reversed, _) = written(voxels.clone().into_iter().rev());
        prop_assert!(bytes == reversed);
        prop_assert_eq!(report.voxels, voxels.len() as u64);
        prop_assert_eq!(report.colors_given, report.colors_kept);
        let (_, info) = read(&bytes, &ReadOptions::default()).unwrap();
        prop_assert_eq!(info.models, report.models);
        let mut read = read_plain(&bytes);
        read.sort_unstable();
        prop_assert_eq!(read, voxels.into_iter().collect::<Vec<_>>());
    }
}

#[test]
fn many_colours_are_reduced_to_255() {
    let given = |i: i32| [i % 16, i / 16 % 16, i / 256].map(|c| (16 * c) as u8);
    let (bytes, report) = written((0..4_000).map(|i| ([i, 0, -i], given(i))));
    let counts = (report.voxels, report.colors_given, report.colors_kept);
    assert_eq!(counts, (4_000, 4_000, 255));
    for (index, color) in read_plain(&bytes) {
        let given = given(index[0]);
        let near = (0..3).all(|c| given[c].abs_diff(color[c]) <= 40);
        assert!(near, "{given:?} {color:?}");
    }
    assert_eq!(xxh3_64(&bytes), 0xbb7eebada461b7e2);
}
