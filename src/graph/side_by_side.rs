//! A linked graph without links.

use super::{Graph, Store};

impl Graph {
    /// The same object without links: a node in several lists occurs in each of them. The root comes first, so node `n`
    /// above 0 is entry `n - 1` of `links`. `None` where there are too many nodes for 32 bits.
    ///
    /// ```
    /// use shiftvox::graph::LinkedGraph;
    ///
    /// // Two nodes, each with the other and itself below it: a root and two lists of two.
    /// let mut graph = LinkedGraph::new(4);
    /// graph.add_node([255, 0, 0], [Some(1), None, None, None, None, None, None, Some(0)]);
    /// graph.add_node([0, 0, 255], [None, Some(0), Some(1), None, None, None, None, None]);
    /// let graph = graph.build()?.side_by_side().unwrap();
    /// assert_eq!(graph.mask[..], [0x81, 0x06, 0x81, 0x81, 0x06]);
    /// assert_eq!(graph.first[..], [1, 3, 1, 1, 3]);
    /// assert!(graph.links.is_empty() && graph.validate().is_ok());
    /// # Ok::<(), shiftvox::graph::Invalid>(())
    /// ```
    pub fn side_by_side(&self) -> Option<Self> {
        if self.links.is_empty() {
            return Some(self.clone());
        }
        if self.links.len() >= u32::MAX as usize - 1 {
            return None;
        }
        let view = self.view();
        let nodes = || [self.root].into_iter().chain(self.links.iter().copied());
        // Wraps only in a damaged file.
        let first_of = |node| match view.mask(node) {
            0 => 0,
            _ => view.first(node).wrapping_add(1),
        };
        let opacity = match self.opacity.is_empty() {
            true => Store::default(),
            false => nodes().map(|node| view.opacity_of(node)).collect(),
        };
        Some(Self {
            depth: self.depth,
            mask: nodes().map(|node| view.mask(node)).collect(),
            first: nodes().map(first_of).collect(),
            color: nodes().map(|node| self.color_of(node)).collect(),
            normal: nodes().map(|node| self.normal_of(node)).collect(),
            opacity,
            voxels: self.voxels,
            placement: self.placement,
            ..Self::default()
        })
    }
}
