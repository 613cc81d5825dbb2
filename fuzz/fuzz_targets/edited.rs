//! A `.vxg`, `.far` or `.tvx` file. Then 64 bits that choose a sound one and 64 for each edit of a field, with repaired
//! lengths and checksums. An accepted file is drawn.

use shiftvox::graph::{MergeBy, Silent, merge, vxg};

use crate::exercise::{self, Format};

pub(crate) fn run(format: Format, bytes: &[u8]) {
    std::hint::black_box(exercise::is_sound(format, bytes));
    let (choices, _) = bytes.as_chunks();
    let choices = choices.iter().map(|&choice| u64::from_le_bytes(choice));
    if let Some((_, bytes)) = exercise::edited(&[format], choices) {
        let path = std::env::temp_dir().join(format!("edited-{}.vxg", std::process::id()));
        if exercise::exercise(format, &bytes, &path) && format == Format::Vxg {
            merging_keeps_cells(&bytes);
        }
    }
}

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
