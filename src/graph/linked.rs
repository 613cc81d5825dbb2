//! Small graphs made by hand, which may be cyclic.

use super::{Graph, MAX_DEPTH, PackedNormal, Placement, Store};

/// Collects nodes. Their children may be any nodes.
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
/// # Ok::<(), shiftvox::graph::linked::LinkedError>(())
/// ```
#[derive(Debug, Clone)]
pub struct LinkedGraph {
    depth: u32,
    root: u32,
    nodes: Vec<LinkedNode>,
    placement: Placement,
}

#[derive(Debug, Clone)]
struct LinkedNode {
    color: [u8; 3],
    normal: PackedNormal,
    children: [Option<u32>; 8],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum LinkedError {
    /// Deeper than coordinates reach.
    #[error("a graph has at most {MAX_DEPTH} levels below the root, not {0}")]
    Depth(u32),
    /// The root was not added, or there are no nodes.
    #[error("the root is node {root}, but there are {nodes} nodes")]
    Root { root: u32, nodes: usize },
    /// A child was not added.
    #[error("child {octant} of node {node} is node {child}, but there are {nodes} nodes")]
    Child {
        node: usize,
        octant: usize,
        child: u32,
        nodes: usize,
    },
    /// More than 32 bits number.
    #[error("{0} nodes are too many for a graph made by hand")]
    TooMany(usize),
}

/// Most nodes: their child lists stay within 32 bits.
const MAX_NODES: usize = (u32::MAX / 8) as usize;

impl LinkedGraph {
    /// A graph without nodes of `2^depth` finest voxels a side. Its root is the first added node.
    pub fn new(depth: u32) -> Self {
        Self {
            depth,
            root: 0,
            nodes: Vec::new(),
            placement: Placement::default(),
        }
    }

    /// Adds a node and returns its number: 0, 1, 2, ... Children are by octant, `x << 2 | y << 1 | z`, and may be added
    /// later. A node without children is solid.
    pub fn add_node(&mut self, color: [u8; 3], children: [Option<u32>; 8]) -> u32 {
        self.add_node_with_normal(color, PackedNormal::NONE, children)
    }

    pub fn add_node_with_normal(
        &mut self,
        color: [u8; 3],
        normal: PackedNormal,
        children: [Option<u32>; 8],
    ) -> u32 {
        let number = self.nodes.len().min(u32::MAX as usize) as u32;
        self.nodes.push(LinkedNode {
            color,
            normal,
            children,
        });
        number
    }

    /// Builds the graph. Colours and normals are not averaged. Fails when it is too deep, or the root or a child was
    /// not added.
    pub fn build(&self) -> Result<Graph, LinkedError> {
        let nodes = self.nodes.len();
        if self.depth > MAX_DEPTH {
            return Err(LinkedError::Depth(self.depth));
        }
        if nodes > MAX_NODES {
            return Err(LinkedError::TooMany(nodes));
        }
        if self.root as usize >= nodes {
            let root = self.root;
            return Err(LinkedError::Root { root, nodes });
        }
        let mut masks = Vec::with_capacity(nodes);
        let mut firsts = Vec::with_capacity(nodes);
        let mut links = Vec::new();
        for (number, node) in self.nodes.iter().enumerate() {
            let mut mask = 0u8;
            firsts.push(links.len() as u32);
            for (octant, child) in node.children.iter().enumerate() {
                let Some(child) = *child else { continue };
                if child as usize >= nodes {
                    return Err(LinkedError::Child {
                        node: number,
                        octant,
                        child,
                        nodes,
                    });
                }
                mask |= 1 << octant;
                links.push(child);
            }
            masks.push(mask);
        }
        let mut graph = Graph {
            depth: self.depth,
            root: self.root,
            mask: masks.into(),
            first: firsts.into(),
            links: links.into(),
            color: self.nodes.iter().map(|n| n.color).collect(),
            normal: self.nodes.iter().map(|n| n.normal).collect(),
            opacity: Store::default(),
            level_start: Vec::new(),
            voxels: 0,
            placement: self.placement,
        };
        graph.voxels = graph.count_voxels();
        Ok(graph)
    }
}
