//! Choices that compose a `.vox` whose scene graph shares nodes. It is read or rejected within the limit of voxels.

use shiftvox::graph::Silent;
use shiftvox::scene::{ReadOptions, SceneFile};

use crate::vox_file;

const MOST: u64 = 1 << 16;

pub(crate) fn run(bytes: &[u8]) {
    // Bytes, then zeros.
    let mut bytes = bytes.iter();
    let mut below = |end| u32::from(bytes.next().copied().unwrap_or(0)) % end;
    let is_wild = below(2) == 1;
    // Going down every path of a larger graph takes too long.
    let inner = below(if is_wild { 64 } else { 12 });
    let scene = vox_file::Scene::compose(inner, is_wild, &mut below);
    let options = ReadOptions {
        most_voxels: MOST,
        ..ReadOptions::default()
    };
    let (mut count, mut last) = (0u64, std::collections::BTreeSet::new());
    let sink = &mut |voxel: shiftvox::graph::Voxel| {
        count += 1;
        last.insert(voxel.index);
    };
    let bytes = scene.file().bytes();
    let result = SceneFile::in_memory(&bytes, "fuzz").and_then(|file| file.read_voxels(&options, sink, &Silent));
    assert!(count <= MOST);
    assert!(is_wild || result.is_err() || last.iter().eq(scene.voxels().keys()));
}
