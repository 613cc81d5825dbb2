//! Any bytes as a voxel file of any format: voxels or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shiftvox::graph::Silent;
use shiftvox::scene::{FORMATS, Format, ReadOptions, read_voxels_from};

fuzz_target!(|data: (u8, &[u8])| {
    let (choice, rest) = data;
    // The format's mark is given, so that no run has to guess it.
    let marks: Vec<&[u8]> = FORMATS.iter().flat_map(Format::voxel_marks).copied().collect();
    let bytes = [marks[usize::from(choice) % marks.len()], rest].concat();
    let mut count = 0u64;
    let sink = &mut |_| count += 1;
    if let Ok(info) = read_voxels_from(&bytes, "fuzz", &ReadOptions::default(), sink, &Silent) {
        assert_eq!(info.voxels, count);
    }
});
