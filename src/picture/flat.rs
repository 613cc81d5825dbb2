//! The quickest picture: each sample's own colour, unlit.

use crate::frame::Frame;
use crate::graph::Graph;

/// Writes the colour of each sample's node, as the graph stores it, one entry
/// a sample, row by row; black where nothing is seen.
///
/// One plain loop on the calling thread. `colors` is made as long as the frame
/// and keeps its memory, so that frames of one size allocate once.
pub fn flat_colors(graph: &Graph, frame: &Frame, colors: &mut Vec<[u8; 3]>) {
    let of_node: &[[u8; 3]] = &graph.color;
    colors.clear();
    // The number of "no node" is beyond every graph's nodes.
    let color = |&node: &u32| of_node.get(node as usize).copied().unwrap_or_default();
    colors.extend(frame.node.iter().map(color));
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
