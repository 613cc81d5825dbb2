//! Composed `.vox` files are read exactly as they were written.

#![allow(clippy::unwrap_used, reason = "test helpers may panic")]

use crate::input_support::{Attributes, Plain, VoxFile, message, read, read_plain, shipped};
use proptest::prelude::*;
use shiftvox::graph::Voxel;
use shiftvox::scene::{OutOfBounds, ReadOptions, VoxWriter};

/// Colours 1, 2, 3.
pub(crate) const THREE: [[u8; 4]; 3] = [[10, 20, 30, 255], [40, 50, 60, 0], [70, 80, 90, 255]];

#[test]
fn a_bare_model_keeps_its_coordinates() {
    let file = VoxFile::new()
        .model([5, 6, 7], &[[4, 5, 6, 1], [0, 0, 0, 2]])
        .palette(&THREE);
    // Colour 2 has alpha 0, which means nothing.
    assert_eq!(
        read_plain(&file.bytes()),
        [([4, 5, 6], [10, 20, 30]), ([0, 0, 0], [40, 50, 60])]
    );
}

#[test]
fn several_bare_models_are_all_read() {
    let file = VoxFile::new()
        .chunk(b"PACK", &2u32.to_le_bytes())
        .model([2, 2, 2], &[[1, 1, 1, 1]])
        .model([2, 2, 2], &[[0, 1, 0, 3]])
        .palette(&THREE)
        .bytes();
    let (_, info) = read(&file, &ReadOptions::default()).unwrap();
    assert!(info.warnings[0].contains("2 models and no scene graph"));
    let both = [([1, 1, 1], [10, 20, 30]), ([0, 1, 0], [70, 80, 90])];
    assert_eq!(read_plain(&file), both);
}

#[test]
fn palettes_missing_short_and_odd() {
    let model = || VoxFile::new().model([1, 1, 1], &[[0, 0, 0, 1], [0, 0, 0, 4], [0, 0, 0, 255]]);
    let colors = |file: VoxFile| {
        read_plain(&file.bytes())
            .iter()
            .map(|v| v.1)
            .collect::<Vec<_>>()
    };
    // MagicaVoxel's: index 1 is white, 4 the fourth step of blue, 255 the darkest grey.
    let default = [[255, 255, 255], [255, 255, 102], [0x11, 0x11, 0x11]];
    assert_eq!(colors(model()), default);
    assert_eq!(
        colors(model().palette(&THREE)),
        [[10, 20, 30], default[1], default[2]]
    );
    let (_, info) = read(&model().palette(&THREE).bytes(), &ReadOptions::default()).unwrap();
    assert!(info.warnings[0].contains("beyond the palette's 3 entries"));
    let full: Vec<[u8; 4]> = (0..=255).map(|i| [i, 255 - i, 7, 9]).collect();
    let expected = [[0, 255, 7], [3, 252, 7], [254, 1, 7]];
    assert_eq!(colors(model().palette(&full)), expected);
    assert_eq!(colors(model().palette(&full[..255])), expected);
    assert!(message(&model().chunk(b"RGBA", &[0; 1022]).bytes()).contains("chunk RGBA"));
    assert!(message(&model().chunk(b"RGBA", &[0; 1028]).bytes()).contains("1028 bytes"));
    // The editor's order of the palette changes no colour.
    let order: Vec<u8> = (0..=255u8).rev().collect();
    assert_eq!(
        colors(model().palette(&full).chunk(b"IMAP", &order)),
        expected
    );
    assert!(message(&model().chunk(b"IMAP", &[0; 16]).bytes()).contains("256 bytes"));
}

#[test]
fn colour_index_zero_is_no_voxel() {
    let file = VoxFile::new()
        .model([1, 1, 2], &[[0, 0, 0, 0], [0, 0, 1, 1]])
        .bytes();
    let (voxels, info) = read(&file, &ReadOptions::default()).unwrap();
    assert_eq!((voxels.len(), info.stored_voxels), (1, 2));
    assert!(info.warnings[0].contains("1 voxels have colour index 0"));
}

/// A model of one voxel under a root, a group and two transforms.
pub(crate) fn two_places(first: Attributes<'_>, second: Attributes<'_>) -> VoxFile {
    VoxFile::new()
        .model([4, 2, 1], &[[3, 0, 0, 1]])
        .transform(0, &[], 1, -1, &[&[]])
        .group(1, &[2, 4])
        .transform(2, &[], 3, 0, &[first])
        .shape(3, &[(0, &[])])
        .transform(4, &[], 5, 1, &[second])
        .shape(5, &[(0, &[])])
}

pub(crate) fn places(file: &VoxFile, options: &ReadOptions) -> Vec<[i32; 3]> {
    read(&file.bytes(), options)
        .unwrap()
        .0
        .iter()
        .map(|v| v.index)
        .collect()
}

#[test]
fn a_model_placed_twice_and_turned() {
    // Pivot (2, 1, 0); the voxel's centre is (1.5, -0.5, 0.5). Byte 17 is x' = -y, y' = x.
    let file = two_places(&[("_t", "10 20 30")], &[("_r", "17"), ("_t", "-100 0 5")]);
    let expected = vec![[11, 19, 30], [-100, 1, 5]];
    assert_eq!(places(&file, &ReadOptions::default()), expected);
}

#[test]
fn hidden_nodes_and_layers_are_left_out() {
    let layer = |file: VoxFile| {
        file.layer(1, &[("_hidden", "1")])
            .layer(0, &[("_hidden", "0")])
    };
    let file = layer(two_places(&[], &[("_t", "9 0 0")]));
    let (voxels, info) = read(&file.bytes(), &ReadOptions::default()).unwrap();
    assert_eq!((voxels.len(), voxels[0].index), (1, [1, -1, 0]));
    assert_eq!((info.instances, info.hidden_instances), (1, 1));
    // A hidden node hides what is below it.
    let file = VoxFile::new()
        .model([1, 1, 1], &[[0, 0, 0, 1]])
        .transform(0, &[("_hidden", "1")], 1, -1, &[&[]])
        .group(1, &[2])
        .transform(2, &[], 3, -1, &[&[]])
        .shape(3, &[(0, &[])]);
    assert!(places(&file, &ReadOptions::default()).is_empty());
}

#[test]
fn the_first_key_frame_is_read() {
    let file = |first: &str, second: &str| {
        VoxFile::new()
            .model([1, 1, 1], &[[0, 0, 0, 1]])
            .model([3, 1, 1], &[[2, 0, 0, 1]])
            .transform(
                0,
                &[],
                1,
                -1,
                &[
                    &[("_t", "50 0 0"), ("_f", "10")],
                    &[("_t", "7 0 0"), ("_f", first)],
                ],
            )
            .shape(1, &[(0, &[("_f", second)]), (1, &[("_f", "20")])])
    };
    let at = |first, second| places(&file(first, second), &ReadOptions::default());
    assert_eq!(at("0", "0"), [[7, 0, 0]]);
    // All later than 0, or together.
    assert_eq!(at("30", "20"), [[50, 0, 0], [51, 0, 0]]);
    assert_eq!(at("-3", "40"), [[8, 0, 0]]);
}

#[test]
fn wrapped_voxels_turn_about_the_same_pivot() {
    // 250 in a size of 4 is -6; centre -6 - 2 + 1/2 = -7.5 along x.
    let file = |r| {
        VoxFile::new()
            .model([4, 2, 1], &[[250, 0, 0, 1]])
            .transform(0, &[], 1, -1, &[&[("_r", r)]])
            .shape(1, &[(0, &[])])
    };
    assert_eq!(places(&file("4"), &ReadOptions::default()), [[-8, -1, 0]]);
    assert_eq!(places(&file("17"), &ReadOptions::default()), [[0, -8, 0]]);
    let keep = ReadOptions {
        oob: OutOfBounds::Keep,
        ..ReadOptions::default()
    };
    assert_eq!(places(&file("4"), &keep), [[248, -1, 0]]);
}

/// Where floating point puts a voxel, step by step up the scene graph.
fn by_matrices(p: [u8; 3], size: [u32; 3], steps: &[(u8, [i32; 3])]) -> [i32; 3] {
    let mut v: [f64; 3] = std::array::from_fn(|a| f64::from(p[a]) + 0.5 - f64::from(size[a] / 2));
    for (rotation, translation) in steps {
        let matrix = dot_vox::Rotation::from_byte(*rotation).to_cols_array_2d();
        v = std::array::from_fn(|row| {
            let turned: f64 = (0..3).map(|col| f64::from(matrix[col][row]) * v[col]).sum();
            turned + f64::from(translation[row])
        });
    }
    v.map(|x| x.floor() as i32)
}

fn rotation() -> impl Strategy<Value = u8> {
    let axes = prop::sample::select(vec![1u8, 2, 4, 6, 8, 9]);
    (axes, 0u8..8).prop_map(|(axes, signs)| axes | signs << 4)
}

fn placement() -> impl Strategy<Value = (u8, [i32; 3])> {
    (rotation(), prop::array::uniform3(-5_000i32..5_000))
}

type Model = ([u32; 3], Vec<[u8; 4]>);

fn model() -> impl Strategy<Value = Model> {
    prop::array::uniform3(1u32..=256).prop_flat_map(|size| {
        let coordinate = |n: u32| 0..=(n - 1) as u8;
        let voxel = (
            coordinate(size[0]),
            coordinate(size[1]),
            coordinate(size[2]),
            1..=255u8,
        )
            .prop_map(|(x, y, z, c)| [x, y, z, c]);
        (Just(size), prop::collection::vec(voxel, 0..40))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn written_scenes_read_back_exactly(
        models in prop::collection::vec(model(), 1..4),
        outer in placement(),
        places in prop::collection::vec((any::<prop::sample::Index>(), placement(), placement()), 0..5),
        palette in prop::collection::vec(any::<[u8; 4]>(), 255..=256),
    ) {
        let mut file = VoxFile::new();
        for (size, voxels) in &models {
            file = file.model(*size, voxels);
        }
        let texts = |(r, t): (u8, [i32; 3])| (r.to_string(), format!("{} {} {}", t[0], t[1], t[2]));
        let (r, t) = texts(outer);
        let ids: Vec<u32> = (0..places.len() as u32).map(|i| 2 + 3 * i).collect();
        file = file
            .transform(0, &[], 1, -1, &[&[("_r", &r), ("_t", &t)]])
            .group(1, &ids);
        let mut expected: Vec<Plain> = Vec::new();
        for (id, (which, middle, inner)) in ids.iter().zip(&places) {
            let number = which.index(models.len());
            let (r, t) = texts(*middle);
            file = file.transform(*id, &[], id + 1, 0, &[&[("_r", &r), ("_t", &t)]]);
            let (r, t) = texts(*inner);
            file = file
                .transform(id + 1, &[], id + 2, 0, &[&[("_t", &t), ("_r", &r)]])
                .shape(id + 2, &[(number as u32, &[])]);
            let (size, voxels) = &models[number];
            for [x, y, z, c] in voxels {
                let [red, green, blue, _] = palette[usize::from(*c) - 1];
                let index = by_matrices([*x, *y, *z], *size, &[*inner, *middle, outer]);
                expected.push((index, [red, green, blue]));
            }
        }
        prop_assert_eq!(read_plain(&file.palette(&palette).bytes()), expected);
    }

    #[test]
    fn the_writer_keeps_every_voxel(
        voxels in prop::collection::btree_map(
            prop::array::uniform3(-700i32..700), any::<[u8; 3]>(), 0..200),
    ) {
        let mut writer = VoxWriter::new();
        for (index, color) in &voxels {
            // A voxel given twice counts as it was given last.
            writer.add(Voxel { index: *index, color: [1, 2, 3], normal: None });
            writer.add(Voxel { index: *index, color: *color, normal: None });
        }
        let mut bytes = Vec::new();
        let written = writer.write(&mut bytes).unwrap();
        prop_assert_eq!(written.voxels, voxels.len() as u64);
        prop_assert_eq!(written.colors_given, written.colors_kept);
        let mut read = read_plain(&bytes);
        read.sort_unstable();
        prop_assert_eq!(&read, &voxels.into_iter().collect::<Vec<_>>());
        // dot_vox reads the same models.
        let data = dot_vox::load_bytes(&bytes).unwrap();
        prop_assert_eq!(data.models.iter().map(|m| m.voxels.len()).sum::<usize>(), read.len());
        prop_assert_eq!(data.models.len(), written.models as usize);
    }
}

#[test]
fn real_files_survive_a_round_trip() {
    for name in ["sphere.vox", "axes.vox", "extended.vox"] {
        let (voxels, _) = read(&shipped(name), &ReadOptions::default()).unwrap();
        let write = |voxels: &mut dyn Iterator<Item = Voxel>| {
            let mut writer = VoxWriter::new();
            voxels.for_each(|voxel| writer.add(voxel));
            let mut bytes = Vec::new();
            writer.write(&mut bytes).unwrap();
            bytes
        };
        let bytes = write(&mut voxels.iter().copied());
        let mut again = read_plain(&bytes);
        again.sort_unstable();
        let mut plain: Vec<Plain> = voxels.iter().map(|v| (v.index, v.color)).collect();
        plain.sort_unstable();
        assert!(again == plain, "{name}");
        assert!(
            bytes == write(&mut voxels.iter().rev().copied()),
            "the order does not matter: {name}"
        );
    }
}

#[test]
fn many_colours_are_reduced_to_255() {
    let mut writer = VoxWriter::new();
    for i in 0..4_000 {
        let color = [
            (i % 16 * 16) as u8,
            (i / 16 % 16 * 16) as u8,
            (i / 256 * 16) as u8,
        ];
        writer.add(Voxel {
            index: [i, 0, -i],
            color,
            normal: None,
        });
    }
    let mut bytes = Vec::new();
    let written = writer.write(&mut bytes).unwrap();
    assert_eq!(
        (written.voxels, written.colors_given, written.colors_kept),
        (4_000, 4_000, 255)
    );
    for (index, color) in read_plain(&bytes) {
        let i = index[0];
        let given = [
            (i % 16 * 16) as u8,
            (i / 16 % 16 * 16) as u8,
            (i / 256 * 16) as u8,
        ];
        assert!(
            (0..3).all(|c| given[c].abs_diff(color[c]) <= 40),
            "{given:?} {color:?}"
        );
    }
}
