//! Reads arbitrary bytes as a `.vxg` file and walks what comes of them.
//!
//! `cargo +nightly fuzz run vxg -- -runs=1000000 -max_len=2048`
//!
//! Checksums are made to fit half of the inputs, or nothing behind them would be reached.
#![no_main]

use std::hint::black_box;
use std::io::Write;

use libfuzzer_sys::fuzz_target;
use shiftvox::graph::{Graph, MergeBy, Silent, merge, vxg};
use xxhash_rust::xxh3::xxh3_64;

fn u64_at(bytes: &[u8], at: usize) -> usize {
    let mut eight = [0; 8];
    eight.copy_from_slice(&bytes[at..at + 8]);
    u64::from_le_bytes(eight) as usize
}

/// Sets the lengths and checksums that the contents should have.
fn seal(bytes: &mut [u8]) {
    if bytes.len() < 512 {
        return;
    }
    let length = (bytes.len() as u64).to_le_bytes();
    bytes[16..24].copy_from_slice(&length);
    for entry in [128, 160, 192, 224, 256] {
        let (offset, length) = (u64_at(bytes, entry + 8), u64_at(bytes, entry + 16));
        let end = offset.saturating_add(length);
        if let Some(section) = bytes.get(offset..end) {
            let sum = xxh3_64(section).to_le_bytes();
            bytes[entry + 24..entry + 32].copy_from_slice(&sum);
        }
    }
    let sum = xxh3_64(&bytes[..504]).to_le_bytes();
    bytes[504..512].copy_from_slice(&sum);
}

fn exercise(graph: &Graph) {
    for cell in graph.voxels().take(500) {
        black_box((graph.color_of(cell.node), graph.normal_of(cell.node).decode()));
        black_box(graph.file_index(&cell));
    }
    black_box((graph.validate().is_ok(), graph.count_voxels(), graph.nodes_per_level()));
    black_box(merge(graph, MergeBy::ShapeAndAttributes, &Silent).0.len());
}

fuzz_target!(|data: &[u8]| {
    let Some((&choice, rest)) = data.split_first() else {
        return;
    };
    let mut bytes = rest.to_vec();
    if choice & 1 == 1 {
        seal(&mut bytes);
    }
    let owned = vxg::from_bytes(&bytes);
    if let Ok(graph) = &owned {
        assert!(graph.validate().is_ok());
        // There is one way to store a graph.
        let mut again = Vec::new();
        assert!(vxg::write_to(graph, &mut again).is_ok());
        // Only reserved parts of the header may differ.
        assert_eq!(again.len(), bytes.len());
        assert_eq!(again[512..], bytes[512..]);
        exercise(graph);
    }
    // The lazy way, which accepts damaged contents: a file for one input in eight.
    if choice & 0b1110 == 0 {
        let Ok(mut file) = tempfile() else { return };
        if file.1.write_all(&bytes).is_err() {
            return;
        }
        let opened = vxg::open(&file.0);
        assert_eq!(vxg::verify(&file.0).is_ok(), owned.is_ok());
        if let Ok(graph) = opened {
            exercise(&graph);
        }
        drop(file.1);
        let _ = std::fs::remove_file(&file.0);
    }
});

/// A file of this process in the folder for temporary files.
fn tempfile() -> std::io::Result<(std::path::PathBuf, std::fs::File)> {
    let name = format!("shiftvox-fuzz-{}.vxg", std::process::id());
    let path = std::env::temp_dir().join(name);
    let _ = std::fs::remove_file(&path);
    Ok((path.clone(), std::fs::File::create(&path)?))
}
