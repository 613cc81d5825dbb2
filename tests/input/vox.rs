//! `.vox` files: composed ones are read as they were written, real ones as recorded.

use std::collections::BTreeSet;

use proptest::prelude::*;
use shiftvox::graph::Voxel;
use shiftvox::scene::{VoxWriter, VoxWritten};
use xxhash_rust::xxh3::xxh3_64;

use crate::vox_file::{Attributes, VoxFile};
use crate::{Plain, digest, read, read_plain, shipped};

pub(crate) const THREE: [[u8; 4]; 3] = [[10, 20, 30, 255], [40, 50, 60, 0], [70, 80, 90, 255]];

fn places(file: &VoxFile) -> Vec<[i32; 3]> {
    read_plain(&file.bytes()).iter().map(|v| v.0).collect()
}

pub(crate) fn one_voxel() -> VoxFile {
    VoxFile::default().model([1, 1, 1], &[[0, 0, 0, 1]])
}

/// A model of one voxel under a root, a group and two transforms, on the layers 0 and 1.
pub(crate) fn two_places(first: Attributes<'_>, second: Attributes<'_>) -> VoxFile {
    VoxFile::default()
        .model([4, 2, 1], &[[3, 0, 0, 1]])
        .moved([0, 1], &[])
        .group(1, &[2, 4])
        .transform([2, 3], &[], 0, &[first])
        .shape(3, &[(0, &[])])
        .transform([4, 5], &[], 1, &[second])
        .shape(5, &[(0, &[])])
}

#[test]
fn models_without_a_graph_keep_their_coordinates() {
    let file = VoxFile::default()
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
    let (_, info) = read(&[file, vec![0; 3]].concat()).unwrap();
    let said = ["3 bytes after", "1 voxels have", "2 models and no"];
    let warned = info.warnings.iter().zip(said);
    assert!(warned.clone().count() == 3 && { warned }.all(|(w, said)| w.contains(said)));
}

#[test]
fn palettes_missing_short_and_full() {
    let all: Vec<[u8; 4]> = (1..=255).map(|color| [0, 0, 0, color]).collect();
    let model = VoxFile::default().model([1, 1, 1], &all);
    let colors = |file: VoxFile| -> Vec<[u8; 3]> {
        let voxels = read_plain(&file.bytes());
        voxels.iter().map(|v| v.1).collect()
    };
    // MagicaVoxel's: index 1 is white, 4 the fourth step of blue, 255 the darkest grey.
    let default = colors(model.clone());
    let three = [default[0], default[3], default[254]];
    assert_eq!(three, [[255; 3], [255, 255, 102], [0x11; 3]]);
    assert_eq!(xxh3_64(default.as_flattened()), 0x6d5e2319522e8f50);
    let file = model.clone().palette(&THREE);
    let (_, info) = read(&file.bytes()).unwrap();
    assert!(info.warnings[0].contains("beyond the palette's 3 entries"));
    let short = colors(file);
    assert_eq!((short[2], &short[3..]), ([70, 80, 90], &default[3..]));
    let full: Vec<[u8; 4]> = (0..=255).map(|i| [i, 255 - i, 7, 9]).collect();
    let expected: Vec<[u8; 3]> = (0..=254).map(|i| [i, 255 - i, 7]).collect();
    for palette in [&full[..], &full[..255]] {
        assert_eq!(colors(model.clone().palette(palette)), expected);
    }
}

#[test]
fn hidden_nodes_and_layers_are_left_out() {
    let file = two_places(&[], &[("_t", "9 0 0")])
        .layer(1, &[("_hidden", "1")])
        .layer(0, &[("_hidden", "0")]);
    assert_eq!(places(&file), [[1, -1, 0]]);
    let (_, info) = read(&file.bytes()).unwrap();
    assert_eq!(info.warnings, ["1 hidden models were left out"]);
    // A hidden node hides what is below it.
    let file = one_voxel()
        .transform([0, 1], &[("_hidden", "1")], u32::MAX, &[&[]])
        .group(1, &[2])
        .shape(2, &[(0, &[])]);
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
            .transform([0, 1], &[], u32::MAX, frames)
            .shape(1, &[(0, &[("_f", second)]), (1, &[("_f", "20")])]);
        places(&file)
    };
    assert_eq!(at("0", "0"), [[7, 0, 0]]);
    // All later than 0, or together.
    assert_eq!(at("30", "20"), [[50, 0, 0], [51, 0, 0]]);
    assert_eq!(at("-3", "40"), [[8, 0, 0]]);
}

/// VoxelShop writes such files: a byte outside `SIZE` means a number below 0, about the same pivot.
#[test]
fn voxels_outside_the_size_are_taken_modulo_256() {
    let stored = [[0, 19, 88, 1], [203, 72, 0, 1], [238, 0, 5, 1]];
    let file = VoxFile::default().model([20, 20, 90], &stored).bytes();
    let (voxels, info) = read(&file).unwrap();
    let found: Vec<[i32; 3]> = voxels.iter().map(|v| v.index).collect();
    assert_eq!(found, [[0, 19, 88], [-53, 72, 0], [-18, 0, 5]]);
    assert!(info.warnings[0].starts_with("2 voxels lie outside their model's SIZE"));
    // 250 in a size of 4 is -6; centre -6 - 2 + 1/2 = -7.5 along x.
    for (rotation, index) in [("4", [-8, -1, 0]), ("17", [0, -8, 0])] {
        let file = VoxFile::default().model([4, 2, 1], &[[250, 0, 0, 1]]);
        let file = file
            .moved([0, 1], &[("_r", rotation)])
            .shape(1, &[(0, &[])]);
        assert_eq!(places(&file), [index]);
    }
}

/// Voxels that are passed on, and different indices; then a digest of the voxels in order and of the palette.
#[rustfmt::skip]
const REAL: [(&str, [usize; 2], u64, u64); 4] = [
    ("tests/data/sphere.vox", [2_103, 2_103], 0x01ce2d9ddff7bea7, 0xc1406b60c2dd174b),
    ("tests/data/axes.vox", [12_452, 12_452], 0x22fbcb9192636d63, 0x501e4d120fa075c4),
    ("tests/data/extended.vox", [4_854, 4_854], 0xc596a3633a7a0465, 0x501e4d120fa075c4),
    ("assets/tree.vox", [804_872, 768_068], 0x405666bfa9e8c1ee, 0x37f62662fcea1bdf),
];

#[test]
fn real_files_are_as_recorded() {
    for (path, counts, voxels, palette) in REAL {
        let (found, info) = read(&shipped(path)).unwrap();
        let found: Vec<Plain> = found.into_iter().map(|v| (v.index, v.color)).collect();
        let distinct = found.iter().map(|v| v.0).collect::<BTreeSet<_>>();
        let found_counts = [found.len(), distinct.len()];
        let digests = (digest(&found), xxh3_64(info.palette.as_flattened()));
        assert_eq!(
            (found_counts, digests),
            (counts, (voxels, palette)),
            "{path}"
        );
    }
}

fn written(voxels: impl IntoIterator<Item = Plain>) -> (Vec<u8>, VoxWritten) {
    let mut writer = VoxWriter::new();
    for (index, color) in voxels {
        let normal = None;
        writer.add(Voxel {
            index,
            color,
            normal,
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
