//! Voxel files and generators.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

mod blocks;
mod clouds;
mod generators;
mod points;
mod vox;
mod vox_file;
mod vox_scenes;
mod wrong;

use std::path::Path;

use shiftvox::graph::{Silent, Voxel};
use shiftvox::scene::{ReadOptions, SceneError, SceneFile, SceneInfo};
use xxhash_rust::xxh3::Xxh3;

/// Index and colour.
type Plain = ([i32; 3], [u8; 3]);

fn read_with(bytes: &[u8], options: &ReadOptions) -> Result<(Vec<Voxel>, SceneInfo), SceneError> {
    let mut voxels = Vec::new();
    let file = SceneFile::in_memory(bytes, "test")?;
    let info = file.read_voxels(options, &mut |v| voxels.push(v), &Silent)?;
    Ok((voxels, info))
}

fn read(bytes: &[u8]) -> Result<(Vec<Voxel>, SceneInfo), SceneError> {
    read_with(bytes, &ReadOptions::default())
}

/// Index and colour of each voxel, in the file's order.
fn read_plain(bytes: &[u8]) -> Vec<Plain> {
    let (voxels, _) = read(bytes).unwrap();
    voxels.into_iter().map(|v| (v.index, v.color)).collect()
}

fn digest(voxels: &[Plain]) -> u64 {
    let mut hash = Xxh3::new();
    for (index, color) in voxels {
        index.iter().for_each(|c| hash.update(&c.to_le_bytes()));
        hash.update(color);
    }
    hash.digest()
}

fn shipped(path: &str) -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap()
}
