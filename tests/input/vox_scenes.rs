//! `.vox` scene graphs that share nodes. Small files place a model very often.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use shiftvox::graph::Silent;
use shiftvox::scene::{
    NoMeshes, OpenError, OpenOptions, Opened, ReadOptions, SceneError, SceneFile, open_bytes,
};
use shiftvox::split_mix::SplitMix;

use crate::read;
use crate::vox::one_voxel;
use crate::vox_file::{Scene, VoxFile};
use crate::wrong::refused;

fn scene(seed: u64, inner: u32, is_wild: bool) -> Scene {
    let mut dice = SplitMix::new(seed);
    Scene::compose(inner, is_wild, &mut |end| dice.below(u64::from(end)) as u32)
}

#[test]
fn shared_graphs_are_what_they_unfold_to() {
    let palette: Vec<[u8; 4]> = (1..=255).map(|i| [i, 0, 0, 255]).collect();
    for seed in 0..400 {
        let scene = scene(seed, 1 + seed as u32 % 12, false);
        let (voxels, _) = read(&scene.file().palette(&palette).bytes()).unwrap();
        let found: BTreeMap<[i32; 3], u8> = voxels.iter().map(|v| (v.index, v.color[0])).collect();
        assert_eq!(found, scene.voxels(), "seed {seed}");
    }
}

fn open(file: &[u8]) -> Result<Opened, OpenError> {
    open_bytes(file, "a.vox", &OpenOptions::default(), &NoMeshes, &Silent)
}

#[test]
fn graphs_of_any_sharing_are_read_or_refused_in_time() {
    let started = Instant::now();
    for seed in 0..120 {
        let file = scene(seed, 30 + seed as u32 * 2, seed % 2 == 0).file();
        // Some hold no voxels, and how much memory is free decides of others.
        if let Ok(opened) = open(&file.bytes()) {
            assert!(opened.graph.voxels < 1 << 24);
        }
    }
    let took = started.elapsed();
    assert!(took < Duration::from_secs(30), "{took:?}");
}

/// One slab of 256 x 256, placed `2^levels` times: each level is a group whose children are twice the next one, at
/// `2^level * apart` voxels along z.
fn slab(levels: u32, apart: u64) -> Vec<u8> {
    let row = |y| (0..=255).map(move |x| [x, y, 0, 1]);
    let voxels: Vec<[u8; 4]> = (0..=255).flat_map(row).collect();
    let mut file = VoxFile::default().model([256, 256, 1], &voxels);
    for level in 0..levels {
        let group = 3 * level;
        let by = format!("0 0 {}", apart << level);
        file = file
            .group(group, &[group + 1, group + 2])
            .moved([group + 1, group + 3], &[])
            .moved([group + 2, group + 3], &[("_t", &by)]);
    }
    file.shape(3 * levels, &[(0, &[])]).bytes()
}

#[test]
fn a_model_at_one_place_costs_once_however_often_it_is_placed_there() {
    let file = slab(17, 0);
    let (voxels, info) = read(&file).unwrap();
    assert_eq!(voxels.len(), 65_536);
    let said = "131071 placements put a model where it is already";
    assert!(info.warnings[0].starts_with(said), "{:?}", info.warnings);
    assert_eq!(open(&file).unwrap().graph.voxels, 65_536);
}

#[test]
fn more_voxels_than_are_wanted_are_refused_before_the_first() {
    let file = slab(10, 1);
    let all = 65_536 << 10;
    let count = |most_voxels| {
        let options = ReadOptions {
            most_voxels,
            ..ReadOptions::default()
        };
        let mut seen = 0u64;
        let file = SceneFile::in_memory(&file, "slab").unwrap();
        let read = file.read_voxels(&options, &mut |_| seen += 1, &Silent);
        (read, seen)
    };
    let (refused, seen) = count(all - 1);
    let refused = refused.unwrap_err();
    assert!(matches!(refused, SceneError::TooMany { voxels, .. } if voxels == all));
    assert!(refused.is_limit() && seen == 0, "{refused}");
    let (read, seen) = count(all);
    assert!(read.is_ok() && seen == all);
    // 2^17 places a voxel apart: 2^33 voxels.
    let refused = open(&slab(17, 1)).unwrap_err();
    let told = refused.to_string();
    let is_told = told.starts_with("a.vox: 8589934592 voxels or more");
    assert!(refused.is_limit() && is_told, "{told}");
}

#[test]
fn shared_nodes_and_models_count_as_visits() {
    // Groups one below the other, of twice the next one each.
    for (floors, models) in [(40, 1), (17, 256)] {
        let mut file = one_voxel();
        for floor in 0..floors {
            file = file.group(floor, &[floor + 1, floor + 1]);
        }
        let file = file.shape(floors, &vec![(0, &[][..]); models]).bytes();
        assert!(refused(&file, "at most 1048576 placed nodes").is_limit());
    }
}

#[test]
fn deep_scenes_do_not_exhaust_the_stack() {
    let mut file = one_voxel();
    for id in 0..20_000 {
        file = file.moved([id, id + 1], &[("_t", "1 0 0")]);
    }
    let (voxels, _) = read(&file.shape(20_000, &[(0, &[])]).bytes()).unwrap();
    assert_eq!(voxels[0].index, [20_000, 0, 0]);
}
