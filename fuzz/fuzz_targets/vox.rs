//! Any bytes as `.vox`: a scene or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shiftvox::graph::Silent;
use shiftvox::scene::{OutOfBounds, ReadOptions, read_voxels_from};

const MOST: u64 = 1 << 20;

fuzz_target!(|data: (u8, &[u8])| {
    let (choice, rest) = data;
    let oob = [
        OutOfBounds::Wrap,
        OutOfBounds::Keep,
        OutOfBounds::Drop,
        OutOfBounds::Error,
    ][usize::from(choice & 3)];
    let options = ReadOptions {
        oob,
        most_voxels: MOST,
    };
    // Magic and main chunk are given, so that no run has to guess them.
    let mut bytes = b"VOX \x96\0\0\0MAIN\0\0\0\0".to_vec();
    bytes.extend((rest.len() as u32).to_le_bytes());
    bytes.extend(rest);
    let mut count = 0u64;
    let result = read_voxels_from(&bytes, "fuzz", &options, &mut |_| count += 1, &Silent);
    assert!(count <= MOST);
    if let Ok(info) = result {
        assert_eq!(info.voxels, count);
    }
});
