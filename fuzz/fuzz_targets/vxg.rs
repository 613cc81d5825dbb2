//! Reads bytes as a `.vxg` file and walks the result. The first byte chooses: the file itself, or with a layout and
//! checksums that fit.
#![no_main]

#[allow(dead_code)]
#[path = "../../crates/mesh/tests/sealed/seal.rs"]
mod sealed;

use std::fs::File;
use std::hint::black_box;
use std::io::Write;
use std::path::PathBuf;

use libfuzzer_sys::fuzz_target;
use shiftvox::graph::{Graph, MergeBy, Silent, merge, vxg};

/// Cells that are looked at; a cyclic graph may have more than anyone can wait for.
const CELLS: usize = 200;

/// Looks at a graph, sound or not, and merges it.
fn exercise(graph: &Graph) -> Graph {
    for cell in graph.voxels().take(CELLS) {
        let attributes = (graph.color_of(cell.node), graph.normal_of(cell.node));
        black_box((attributes.0, attributes.1.decode(), graph.file_index(&cell)));
    }
    black_box(graph.nodes_per_level());
    merge(graph, MergeBy::ShapeAndAttributes, &Silent).0
}

/// Checks an accepted graph. Storing it validates it.
fn check_sound(graph: &Graph, bytes: &[u8]) {
    // There is one way to store a graph; only reserved parts of the header may differ.
    let mut again = Vec::new();
    assert!(vxg::write_to(graph, &mut again).is_ok());
    assert_eq!(again.len(), bytes.len());
    assert_eq!(again[512..], bytes[512..]);
    // Merging keeps every cell.
    let merged = exercise(graph);
    assert!(merged.validate().is_ok());
    let cells = graph.voxels().zip(merged.voxels()).take(CELLS);
    for (one, other) in cells {
        assert_eq!((one.corner, one.level), (other.corner, other.level));
        assert_eq!(graph.color_of(one.node), merged.color_of(other.node));
        assert_eq!(graph.normal_of(one.node), merged.normal_of(other.node));
    }
}

fuzz_target!(|data: &[u8]| {
    let Some((&choice, rest)) = data.split_first() else {
        return;
    };
    let bytes = match choice & 3 {
        0 => rest.to_vec(),
        way => match sealed::vxg(rest.to_vec(), way > 1) {
            Some(bytes) => bytes,
            None => return,
        },
    };
    let owned = vxg::from_bytes(&bytes);
    if let Ok(graph) = &owned {
        check_sound(graph, &bytes);
    }
    // The lazy way, which accepts damaged contents: a file for one input in four.
    if choice & 0b1100 == 0 {
        let Ok((path, mut file)) = temporary_file() else {
            return;
        };
        if file.write_all(&bytes).is_err() {
            return;
        }
        let opened = vxg::open(&path);
        assert_eq!(vxg::verify(&path).is_ok(), owned.is_ok());
        assert!(opened.is_ok() || owned.is_err());
        // A sound one has been looked at.
        if let (Ok(graph), Err(_)) = (opened, owned) {
            black_box((graph.validate().is_ok(), graph.count_voxels()));
            exercise(&graph);
        }
        drop(file);
        let _ = std::fs::remove_file(&path);
    }
});

fn temporary_file() -> std::io::Result<(PathBuf, File)> {
    let name = format!("shiftvox-fuzz-{}.vxg", std::process::id());
    let path = std::env::temp_dir().join(name);
    // Never truncated: a map of the one before may still be there.
    let _ = std::fs::remove_file(&path);
    let file = File::create(&path)?;
    Ok((path, file))
}
