//! A byte of options, then a voxel file without its mark; of `.vox`, the chunks within `MAIN`. Voxels or an error.

use shiftvox::graph::Silent;
use shiftvox::scene::{FORMATS, ReadOptions, SceneFile};

const MOST: u64 = 1 << 20;

pub(crate) fn run(ending: &str, bytes: &[u8]) {
    let Some((&choice, rest)) = bytes.split_first() else {
        return;
    };
    // The format's mark is given, so that no run has to guess it.
    let mut rows = FORMATS.iter().filter(|row| row.ending[1..] == *ending);
    let row = rows.next().unwrap_or_else(|| panic!("{ending} is no format of voxels"));
    let marks = row.voxel_marks();
    let mark = marks.get(usize::from(choice) % 64 % marks.len().max(1)).copied().unwrap_or_default();
    let mut bytes = mark.to_vec();
    if mark == b"VOX " {
        bytes.extend(b"\x96\0\0\0MAIN\0\0\0\0");
        bytes.extend((rest.len() as u32).to_le_bytes());
    }
    bytes.extend(rest);
    let options = ReadOptions {
        voxel_size: [None, Some(0.5), Some(1e-3), Some(1e30)][usize::from(choice) / 64],
        most_voxels: MOST,
    };
    let mut count = 0u64;
    let _ = SceneFile::in_memory(&bytes, "fuzz").and_then(|file| file.read_voxels(&options, &mut |_| count += 1, &Silent));
    assert!(count <= MOST);
}
