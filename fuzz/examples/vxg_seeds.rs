//! Writes small seed files for the target `vxg` into corpus/vxg; run in fuzz/.

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
        for choice in [0, 1, 4] {
            let seed = [&[choice], &bytes[..]].concat();
            fs::write(format!("corpus/vxg/{name}_{choice}"), seed)?;
        }
    }
    Ok(())
}
