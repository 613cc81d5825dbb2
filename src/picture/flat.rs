//! The quickest picture: each sample's own colour, unlit.

use crate::frame::{Frame, NO_NODE};
use crate::graph::Graph;

/// Samples that are looked at together: where none shows anything, none is looked up.
const TOGETHER: usize = 16;
/// Samples that are worth a thread's while.
const SHARE: usize = 1 << 15;

/// Writes the colour of each sample's node, as the graph stores it, one entry
/// a sample, row by row; black where nothing is seen.
///
/// On the threads of the current pool. `colors` is made as long as the frame
/// and keeps its memory, so that frames of one size allocate once.
pub fn flat_colors(graph: &Graph, frame: &Frame, colors: &mut Vec<[u8; 3]>) {
    let of_node: &[[u8; 3]] = &graph.color;
    colors.resize(frame.node.len(), [0; 3]);
    write_colors(of_node, &frame.node, colors, rayon::current_num_threads());
}

/// Halves the samples until each thread has a few shares.
fn write_colors(of_node: &[[u8; 3]], nodes: &[u32], colors: &mut [[u8; 3]], threads: usize) {
    if threads > 1 && nodes.len() > SHARE {
        let half = nodes.len() / 2 / TOGETHER * TOGETHER;
        let (upper, lower) = nodes.split_at(half);
        let (to_upper, to_lower) = colors.split_at_mut(half);
        rayon::join(
            || write_colors(of_node, upper, to_upper, threads),
            || write_colors(of_node, lower, to_lower, threads),
        );
        return;
    }
    let chunks = nodes.chunks(TOGETHER).zip(colors.chunks_mut(TOGETHER));
    for (nodes, colors) in chunks {
        if nodes
            .iter()
            .fold(true, |all, &node| all & (node == NO_NODE))
        {
            colors.fill([0; 3]);
            continue;
        }
        for (&node, color) in nodes.iter().zip(colors) {
            // The number of "no node" is beyond every graph's nodes.
            *color = of_node.get(node as usize).copied().unwrap_or_default();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::{Placement, Store};

    #[test]
    fn samples_become_colors_and_nothing_black() {
        let graph = Graph {
            depth: 1,
            root: 0,
            mask: Store::from(vec![0b11]),
            first: Store::from(vec![1]),
            links: Store::from(vec![]),
            color: Store::from(vec![[9, 9, 9], [1, 2, 3], [4, 5, 6]]),
            normal: Store::from(vec![]),
            level_start: vec![],
            voxels: 2,
            placement: Placement::default(),
        };
        let mut frame = Frame::new(2, 2, false);
        frame.node[1] = 2;
        frame.node[3] = 1;
        let mut colors = vec![[7; 3]; 9];
        flat_colors(&graph, &frame, &mut colors);
        assert_eq!(colors, [[0; 3], [4, 5, 6], [0; 3], [1, 2, 3]]);
    }
}
