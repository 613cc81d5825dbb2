//! Writes small seed files for the target `vxg` into corpus/vxg; run in fuzz/.
//!
//! Each is a file stored by the program, or a few bytes from which the target composes one.

#[path = "../fuzz_targets/vxg_file.rs"]
mod vxg_file;

use std::error::Error;
use std::fs;

use shiftvox::graph::{
    BuildOptions, Builder, Graph, LinkedGraph, MergeBy, Silent, Voxel, merge, vxg,
};

fn tree(indices: &[[i32; 3]]) -> Result<Graph, Box<dyn Error>> {
    let mut builder = Builder::new(BuildOptions::default());
    builder.extend(indices.iter().map(|&index| Voxel {
        index,
        color: index.map(|c| (c * 37) as u8),
        normal: None,
    }));
    Ok(builder.finish(([0.5, -2.0, 1e6], 0.25), &Silent)?)
}

fn cyclic() -> Result<Graph, Box<dyn Error>> {
    let mut graph = LinkedGraph::new(9);
    let (zero, one, two) = (Some(0), Some(1), Some(2));
    graph.add_node([1, 2, 3], [zero, None, None, one, None, zero, two, None]);
    graph.add_node([1, 2, 3], [two, None, None, one, None, zero, two, None]);
    graph.add_node([9, 9, 9], [None; 8]);
    Ok(graph.build()?)
}

/// Depth, root, counts of level entries, masks, links and nodes; then the arrays.
const COMPOSED: [(&str, &[u8]); 4] = [
    ("leaf", &[0, 0, 0, 0, 0, 1, 7]),
    ("tree", &[1, 0, 3, 1, 0, 3, 0, 1, 3, 9, 1, 5, 6, 7]),
    (
        "dag",
        &[
            2, 0, 4, 2, 4, 3, 0, 1, 2, 3, 6, 9, 0, 2, 1, 1, 2, 2, 5, 6, 7,
        ],
    ),
    ("sponge", &[30, 0, 0, 1, 4, 1, 105, 0, 0, 0, 0, 0, 5]),
];

fn main() -> Result<(), Box<dyn Error>> {
    fs::create_dir_all("corpus/vxg")?;
    let corners = tree(&[[0; 3], [1, 0, 0], [1, 1, 0], [-5, 3, 2], [6; 3], [7, 6, 6]])?;
    let (dag, _) = merge(&corners, MergeBy::Shape, &Silent);
    let graphs = [
        ("tree", corners),
        ("dag", dag),
        ("cyclic", cyclic()?),
        ("voxel", tree(&[[-3, 4, 5]])?),
    ];
    for (name, graph) in graphs {
        let mut bytes = Vec::new();
        vxg::write_to(&graph, &mut bytes)?;
        vxg::from_bytes(&bytes)?;
        println!("{name}: {} bytes", bytes.len());
        // As it is, with checksums set, and the former without a file.
        for choice in [0, 1, 4] {
            let seed = [&[choice], &bytes[..]].concat();
            fs::write(format!("corpus/vxg/{name}_{choice}"), seed)?;
        }
    }
    for (name, bytes) in COMPOSED {
        vxg::from_bytes(&vxg_file::file_of(&vxg_file::graph_of(bytes)))?;
        let seed = [&[2], bytes].concat();
        fs::write(format!("corpus/vxg/composed_{name}"), seed)?;
    }
    Ok(())
}
