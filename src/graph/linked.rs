//! Small graphs made by hand, which may be cyclic.

use super::{Graph, Invalid, PackedNormal};

/// Collects nodes. Their children may be any nodes; the root is the first.
///
/// ```
/// use shiftvox::graph::LinkedGraph;
///
/// // A Sierpinski tetrahedron is one node whose children 0, 3, 5 and 6 are itself.
/// let mut graph = LinkedGraph::new(5);
/// let itself = Some(0);
/// graph.add_node([255, 0, 0], [itself, None, None, itself, None, itself, itself, None]);
/// let graph = graph.build()?;
/// assert_eq!(graph.voxels, 4u64.pow(5));
/// # Ok::<(), shiftvox::graph::Invalid>(())
/// ```
#[derive(Debug, Clone)]
pub struct LinkedGraph {
    depth: u32,
    nodes: Vec<([u8; 3], [Option<u32>; 8])>,
}

impl LinkedGraph {
    pub fn new(depth: u32) -> Self {
        let nodes = Vec::new();
        Self { depth, nodes }
    }

    /// Returns the node's number. Children are by octant, `x << 2 | y << 1 | z`, and may be added later.
    pub fn add_node(&mut self, color: [u8; 3], children: [Option<u32>; 8]) -> u32 {
        let number = self.nodes.len().min(u32::MAX as usize) as u32;
        self.nodes.push((color, children));
        number
    }

    pub fn build(&self) -> Result<Graph, Invalid> {
        let mut mask = Vec::with_capacity(self.nodes.len());
        let mut first = Vec::with_capacity(self.nodes.len());
        let mut links = Vec::new();
        for (_, children) in &self.nodes {
            first.push(links.len() as u32);
            links.extend(children.iter().flatten());
            let bits = (0..8).filter(|&octant| children[octant].is_some());
            mask.push(bits.fold(0u8, |mask, octant| mask | 1 << octant));
        }
        let mut graph = Graph {
            depth: self.depth,
            mask: mask.into(),
            first: first.into(),
            links: links.into(),
            color: self.nodes.iter().map(|(color, _)| *color).collect(),
            normal: vec![PackedNormal::NONE; self.nodes.len()].into(),
            ..Graph::default()
        };
        graph.validate_shape()?;
        graph.validate_children()?;
        graph.voxels = graph.count_voxels();
        Ok(graph)
    }
}
