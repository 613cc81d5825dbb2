//! Any bytes as a voxel file of any format: voxels or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shiftvox::graph::Silent;
use shiftvox::scene::{FORMATS, Format, OutOfBounds, ReadOptions, read_voxels_from};

const MOST: u64 = 1 << 20;

fuzz_target!(|data: (u8, &[u8])| {
    let (choice, rest) = data;
    // The format's mark is given, so that no run has to guess it.
    let marks: Vec<&[u8]> = FORMATS.iter().flat_map(Format::voxel_marks).copied().collect();
    let mark = marks[usize::from(choice) % marks.len()];
    let mut bytes = mark.to_vec();
    if mark == b"VOX " {
        bytes.extend(b"\x96\0\0\0MAIN\0\0\0\0");
        bytes.extend((rest.len() as u32).to_le_bytes());
    }
    bytes.extend(rest);
    use OutOfBounds::{Drop, Error, Keep, Wrap};
    let options = ReadOptions {
        oob: [Wrap, Keep, Drop, Error][usize::from(choice) / marks.len() % 4],
        most_voxels: MOST,
    };
    let mut count = 0u64;
    let result = read_voxels_from(&bytes, "fuzz", &options, &mut |_| count += 1, &Silent);
    assert!(count <= MOST);
    if let Ok(info) = result {
        assert_eq!(info.voxels, count);
    }
});
