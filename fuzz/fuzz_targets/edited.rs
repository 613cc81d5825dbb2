//! Reads bytes as `.vxg`, `.far` and `.tvx` files. Then edits fields of sound `.vxg`, `.far` and `.tvx` files, repairs lengths and
//! checksums, and draws what is accepted.
#![no_main]
#![allow(clippy::unwrap_used)]

#[path = "../../crates/mesh/tests/sealed/exercise.rs"]
mod exercise;
#[path = "../../crates/mesh/tests/sealed/seal.rs"]
mod seal;

use libfuzzer_sys::fuzz_target;
use shiftvox::graph::{MergeBy, Silent, merge, vxg};
use shiftvox_mesh::far::FarFile;
use shiftvox_mesh::textured::TexturedFile;

fuzz_target!(|data: &[u8]| {
    let is_graph = vxg::from_bytes(data).is_ok();
    let is_sound = FarFile::from_bytes(data).is_ok_and(|file| file.verify().is_ok());
    std::hint::black_box((is_graph, is_sound, TexturedFile::from_bytes(data).is_ok()));
    let (choices, _) = data.as_chunks();
    let choices = choices.iter().map(|&choice| u64::from_le_bytes(choice));
    if let Some((format, bytes)) = exercise::edited(choices) {
        let path = std::env::temp_dir().join(format!("edited-{}.vxg", std::process::id()));
        if exercise::exercise(format, &bytes, &path) && format == exercise::Format::Vxg {
            merging_keeps_cells(&bytes);
        }
    }
});

/// A cyclic graph may have more cells than anyone can wait for, so the first 200 are compared.
fn merging_keeps_cells(bytes: &[u8]) {
    let graph = vxg::from_bytes(bytes).unwrap();
    let (merged, _) = merge(&graph, MergeBy::ShapeAndAttributes, &Silent);
    for (one, other) in graph.voxels().zip(merged.voxels()).take(200) {
        assert_eq!((one.corner, one.level), (other.corner, other.level));
        assert_eq!(graph.color_of(one.node), merged.color_of(other.node));
        assert_eq!(graph.normal_of(one.node), merged.normal_of(other.node));
    }
}
