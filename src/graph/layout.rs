//! Where a hardware reads nodes: in words of eight bytes.

use std::ops::Range;

use super::GraphView;

/// How nodes lie in a hardware's memory. A node is a word: which children it has, which of them are leaves, and
/// where they begin. A *brick* is a node two levels above the finest voxels, in two words: 64 bits, one for
/// each of its voxels, which of its children are leaves, and where children and voxels begin. Its children are
/// not read at all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct NodeLayout {
    /// Whether a node says which of its children are leaves, so that a leaf need not be read.
    pub leaf_masks: bool,
    bricks: Option<Bricks>,
}

/// The level of bricks, and the first node there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Bricks {
    level: u32,
    first: u32,
}

impl NodeLayout {
    /// Of a graph's nodes. Only trees that are stored level by level have bricks: there a
    /// brick's voxels lie side by side.
    #[must_use]
    pub fn new(graph: &GraphView<'_>, leaf_masks: bool, bricks: bool) -> Self {
        let level = graph.depth.checked_sub(2).filter(|_| bricks);
        let found = level.and_then(|level| {
            let first = first_of_level(graph, level)?;
            Some(Bricks { level, first })
        });
        Self {
            leaf_masks,
            bricks: found,
        }
    }

    /// The words to read for a node at a level.
    #[inline]
    #[must_use]
    pub fn words(&self, node: u32, level: u32) -> Range<u64> {
        let at = u64::from(node);
        match self.bricks {
            Some(bricks) if level > bricks.level => at..at,
            Some(bricks) if level == bricks.level => {
                let at = at + u64::from(node.saturating_sub(bricks.first));
                at..at + 2
            }
            _ => at..at + 1,
        }
    }
}

/// The first node of a level, in a tree that is stored level by level.
fn first_of_level(graph: &GraphView<'_>, level: u32) -> Option<u32> {
    if !graph.links.is_empty() {
        return None;
    }
    let mut first = graph.root;
    for _ in 0..level {
        let inner = (first as usize..graph.mask.len()).find(|&node| graph.mask[node] != 0)?;
        let next = *graph.first.get(inner)?;
        if next <= first {
            return None;
        }
        first = next;
    }
    Some(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A root with two children; the second one has three, of which one has two voxels: depth 3.
    #[test]
    fn words_by_hand() {
        let graph = GraphView {
            depth: 3,
            root: 0,
            mask: &[0b11, 0, 0b111, 0, 0b11, 0],
            first: &[1, 0, 3, 0, 6, 0],
            links: &[],
            opacity: &[],
            light: &[],
        };
        let plain = NodeLayout::new(&graph, true, false);
        assert_eq!(plain.words(4, 2), 4..5);
        let bricks = NodeLayout::new(&graph, true, true);
        assert_eq!(bricks.words(0, 0), 0..1);
        assert_eq!(bricks.words(1, 1), 1..3);
        assert_eq!(bricks.words(2, 1), 3..5);
        assert!(bricks.words(4, 2).is_empty());
        let linked = GraphView {
            links: &[1, 2],
            ..graph
        };
        assert!(NodeLayout::new(&linked, true, true).bricks.is_none());
    }
}
