//! Scene graphs that share nodes: a small file may place a model as often as it likes, and is read, or refused, for what
//! it comes to.

use crate::input_support::{VoxFile, read};
use shiftvox::graph::Silent;
use shiftvox::scene::{NoMeshes, OpenOptions, ReadOptions, SceneError, open_bytes};

/// One slab of 256 x 256, placed `2^levels` times: each level is a group whose children are twice the next one,
/// moved by the two translations.
fn slab(levels: u32, apart: [&str; 2]) -> Vec<u8> {
    let voxels: Vec<[u8; 4]> = (0..=255u8)
        .flat_map(|y| (0..=255).map(move |x| [x, y, 0, 1]))
        .collect();
    let mut file = VoxFile::new().model([256, 256, 1], &voxels);
    file = file.transform(0, &[], 1, -1, &[&[]]);
    for level in 0..levels {
        let group = 1 + 3 * level;
        file = file.group(group, &[group + 1, group + 2]);
        for (side, by) in [(1, apart[0]), (2, apart[1])] {
            let by = by.replace('N', &(1u64 << level).to_string());
            file = file.transform(group + side, &[], group + 3, -1, &[&[("_t", &by)]]);
        }
    }
    file.shape(1 + 3 * levels, &[(0, &[])]).bytes()
}

#[test]
fn a_model_at_one_place_costs_once_however_often_it_is_placed_there() {
    let file = slab(17, ["0 0 0", "0 0 0"]);
    assert!(file.len() < 270_000);
    let (voxels, info) = read(&file, &ReadOptions::default()).unwrap();
    assert_eq!((voxels.len(), info.instances), (65_536, 1 << 17));
    let said = "131071 placements put a model where it is already";
    assert!(info.warnings[0].starts_with(said), "{:?}", info.warnings);
    let opened = open_bytes(
        &file,
        "slab.vox",
        &OpenOptions::default(),
        &NoMeshes,
        &Silent,
    )
    .unwrap();
    assert_eq!(opened.graph.voxels, 65_536);
}

#[test]
fn of_equal_places_the_last_counts() {
    let place = |file: VoxFile, id: u32, shape: u32| file.transform(id, &[], shape, -1, &[&[]]);
    let mut file = VoxFile::new()
        .model([1, 1, 1], &[[0, 0, 0, 1]])
        .model([1, 1, 1], &[[0, 0, 0, 2]])
        .transform(0, &[], 1, -1, &[&[]])
        .group(1, &[2, 4, 6]);
    for (id, shape) in [(2, 3), (4, 5), (6, 3)] {
        file = place(file, id, shape);
    }
    let file = file
        .shape(3, &[(0, &[])])
        .shape(5, &[(1, &[])])
        .palette(&[[1, 1, 1, 255], [2, 2, 2, 255]]);
    let (voxels, _) = read(&file.bytes(), &ReadOptions::default()).unwrap();
    let colors: Vec<u8> = voxels.iter().map(|voxel| voxel.color[0]).collect();
    assert_eq!(colors, [2, 1]);
}

#[test]
fn more_voxels_than_are_wanted_are_refused_before_the_first() {
    let file = slab(10, ["0 0 0", "0 0 N"]);
    let most = |most_voxels| ReadOptions {
        most_voxels,
        ..ReadOptions::default()
    };
    let all = 65_536 << 10;
    let mut seen = 0u64;
    let mut count = |options: &ReadOptions| {
        let sink = &mut |_| seen += 1;
        let read = shiftvox::scene::read_voxels_from(&file, "slab.vox", options, sink, &Silent);
        (read, std::mem::take(&mut seen))
    };
    let (refused, seen) = count(&most(all - 1));
    let refused = refused.unwrap_err();
    assert!(matches!(refused, SceneError::TooMany { voxels, .. } if voxels == all));
    assert!(refused.is_limit());
    assert!(refused.to_string().contains("slab.vox"), "{refused}");
    assert_eq!(seen, 0);
    let (read, seen) = count(&most(all));
    assert_eq!((read.unwrap().voxels, seen), (all, all));
}

#[test]
fn a_scene_of_too_many_voxels_is_a_limit_with_figures() {
    // 2^17 places a voxel apart: 2^33 voxels.
    let file = slab(17, ["0 0 0", "0 0 N"]);
    let refused = open_bytes(
        &file,
        "slab.vox",
        &OpenOptions::default(),
        &NoMeshes,
        &Silent,
    )
    .unwrap_err();
    assert!(refused.is_limit());
    let told = refused.to_string();
    assert!(
        told.starts_with("slab.vox: 8589934592 voxels or more"),
        "{told}"
    );
}

#[test]
fn models_of_a_shape_count_as_visits() {
    // 2^17 visits of a shape with 256 models.
    let models = vec![(0, &[][..]); 256];
    let mut file =
        VoxFile::new()
            .model([1, 1, 1], &[[0, 0, 0, 1]])
            .transform(0, &[], 1, -1, &[&[]]);
    for level in 1..=17 {
        file = file.group(level, &[level + 1, level + 1]);
    }
    let file = file.shape(18, &models).bytes();
    let refused = read(&file, &ReadOptions::default()).unwrap_err();
    assert!(refused.is_limit(), "{refused}");
}
