//! Any bytes as `.ply`: a cloud or an error, never a panic, never memory that the file does not justify.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shiftvox::graph::Silent;
use shiftvox::scene::{ReadOptions, read_voxels_from};

fuzz_target!(|rest: &[u8]| {
    let bytes = [&b"ply\n"[..], rest].concat();
    let mut count = 0u64;
    let sink = &mut |_| count += 1;
    if let Ok(info) = read_voxels_from(&bytes, "fuzz", &ReadOptions::default(), sink, &Silent) {
        assert_eq!(info.voxels, count);
    }
});
