//! Reads bytes as a `.vxg` file and walks the graph: a graph or an error, never a panic.
//!
//! Chance never passes a checksum. So the first byte selects one of three ways: the other bytes are the file, the file
//! before its checksums are corrected, or choices that compose one.
#![no_main]

mod vxg_file;

use std::fs::File;
use std::hint::black_box;
use std::io::Write;
use std::path::PathBuf;

use libfuzzer_sys::fuzz_target;
use shiftvox::graph::{Graph, MergeBy, Silent, merge, vxg};

/// Limit of visited cells; a cyclic graph may have endlessly many.
const CELLS: usize = 200;

/// Walks a graph, sound or not, as a picture does, and merges it.
fn exercise(graph: &Graph) -> Graph {
    for cell in graph.voxels().take(CELLS) {
        let attributes = (graph.color_of(cell.node), graph.normal_of(cell.node));
        black_box((attributes.0, attributes.1.decode(), graph.file_index(&cell)));
    }
    black_box(graph.nodes_per_level());
    merge(graph, MergeBy::ShapeAndAttributes, &Silent).0
}

/// Checks an accepted graph. Storing validates it.
fn check_sound(graph: &Graph, bytes: &[u8], composed: bool) {
    // Storing is unique, except for reserved parts of the header.
    let mut again = Vec::new();
    assert!(vxg::write_to(graph, &mut again).is_ok());
    let from = if composed { 0 } else { 512 };
    assert_eq!(again.len(), bytes.len());
    assert_eq!(again[from..], bytes[from..]);
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
    let (bytes, sound) = match choice & 3 {
        0 => (rest.to_vec(), None),
        1 => {
            let mut bytes = rest.to_vec();
            vxg_file::seal(&mut bytes);
            (bytes, None)
        }
        _ => {
            let graph = vxg_file::graph_of(rest);
            // The level table has room for `MAX_DEPTH + 2` entries.
            let sound = graph.level_start.len() <= 32 && graph.validate().is_ok();
            (vxg_file::file_of(&graph), Some(sound))
        }
    };
    let owned = vxg::from_bytes(&bytes);
    if let Some(sound) = sound {
        assert_eq!(owned.is_ok(), sound);
    }
    if let Ok(graph) = &owned {
        check_sound(graph, &bytes, sound.is_some());
    }
    // Lazy reading accepts damaged contents. It is tested with one input in four.
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
        // A sound one has been checked above.
        if let (Ok(graph), Err(_)) = (opened, owned) {
            black_box((graph.validate().is_ok(), graph.count_voxels()));
            exercise(&graph);
        }
        drop(file);
        let _ = std::fs::remove_file(&path);
    }
});

/// This process's temporary file.
fn temporary_file() -> std::io::Result<(PathBuf, File)> {
    let name = format!("shiftvox-fuzz-{}.vxg", std::process::id());
    let path = std::env::temp_dir().join(name);
    // Never truncated: the previous file may still be mapped.
    let _ = std::fs::remove_file(&path);
    let file = File::create(&path)?;
    Ok((path, file))
}
