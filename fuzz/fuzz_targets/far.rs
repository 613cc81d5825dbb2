//! Any bytes as a `.far` file: refused, or read and drawn. Checksums are made
//! right first, so that the fields behind them are reached.

#![no_main]

use libfuzzer_sys::fuzz_target;
use shiftvox::far::FarFile;
use shiftvox::far::view::{FarViewer, ViewOptions};
use shiftvox::mesh::raster::View;
use xxhash_rust::xxh3::xxh3_64;

/// Bytes of the header, and of a node.
const RECORD: usize = 128;

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = bytes.to_vec();
    let _ = FarFile::from_bytes(&bytes);
    if bytes.len() < 2 * RECORD {
        return;
    }
    let most = bytes.len() / RECORD - 1;
    let nodes = u64::from_le_bytes(std::array::from_fn(|i| bytes[24 + i])) as usize;
    let end = RECORD * (1 + nodes.min(most));
    let sum = xxh3_64(&bytes[RECORD..end]).to_le_bytes();
    bytes[96..104].copy_from_slice(&sum);
    let sum = xxh3_64(&bytes[..120]).to_le_bytes();
    bytes[120..128].copy_from_slice(&sum);
    let Ok(file) = FarFile::from_bytes(&bytes) else {
        return;
    };
    let (low, high) = file.bounds();
    let size = (high - low).length();
    let forward = glam::DVec3::Z;
    let view = View {
        eye: (low + high) / 2.0 - forward * 2.0 * size,
        right: glam::DVec3::X,
        up: glam::DVec3::Y,
        forward,
        focal_px: 16.0,
        width: 16,
        height: 16,
        near: 1e-6 * size,
    };
    let options = ViewOptions {
        voxel_px: 16.0,
        ..ViewOptions::default()
    };
    // Whatever is in it: a picture or a refusal.
    let _ = FarViewer::new(&file).draw(&view, &options);
});
