//! The words of memory in which hardware holds nodes, eight bytes each.

use std::ops::Range;

use super::GraphView;

/// A node is a word. A *brick* is a node two levels above the finest voxels, in two words (see [`Self::brick_words`]),
/// from which the places of its voxels follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct NodeLayout {
    /// Whether a node says which of its children are leaves, so that leaves need not be read.
    pub leaf_masks: bool,
    bricks: Option<Bricks>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Bricks {
    level: u32,
    first: u32,
    end: u32,
}

const PLACE_BITS: u32 = 28;

impl NodeLayout {
    pub fn new(graph: &GraphView<'_>, leaf_masks: bool, bricks: bool) -> Self {
        let level = graph.depth.checked_sub(2).filter(|_| bricks);
        let found = level.filter(|_| is_by_level(graph)).and_then(|level| {
            let first = first_of_level(graph, level)?;
            let end = first_of_level(graph, level + 1);
            let end = end.unwrap_or(graph.mask.len() as u32).max(first);
            Some(Bricks { level, first, end })
        });
        Self {
            leaf_masks,
            bricks: found,
        }
    }

    pub fn bricks(&self) -> Range<u32> {
        self.bricks.map_or(0..0, |bricks| bricks.first..bricks.end)
    }

    /// The words of a brick. The first has its voxels, a byte per child (all ones for a leaf), the second
    /// `leaves << 56 | where children begin << 28 | where voxels begin`. `None`: a number does not fit.
    pub fn brick_words(graph: &GraphView<'_>, brick: u32) -> Option<[u64; 2]> {
        let (mut voxels, mut leaves, mut first_voxel) = (0, 0, None);
        for octant in 0..8 {
            let Some(child) = graph.child(brick, octant) else {
                continue;
            };
            let mask = match graph.mask(child) {
                0 => {
                    leaves |= 1u64 << octant;
                    u8::MAX
                }
                mask => {
                    first_voxel.get_or_insert_with(|| graph.first(child));
                    mask
                }
            };
            voxels |= u64::from(mask) << (8 * octant);
        }
        let places = [graph.first(brick), first_voxel.unwrap_or(0)].map(u64::from);
        let fit = places.iter().all(|place| place >> PLACE_BITS == 0);
        let second = leaves << (2 * PLACE_BITS) | places[0] << PLACE_BITS | places[1];
        fit.then_some([voxels, second])
    }

    #[inline]
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

fn is_by_level(graph: &GraphView<'_>) -> bool {
    let mut next = u64::from(graph.root) + 1;
    let nodes = graph.mask.iter().zip(graph.first);
    graph.links.is_empty()
        && nodes.skip(graph.root as usize).all(|(&mask, &first)| {
            let follows = mask == 0 || u64::from(first) == next;
            next += u64::from(mask.count_ones());
            follows
        })
}

fn first_of_level(graph: &GraphView<'_>, level: u32) -> Option<u32> {
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

    /// Depth 3: a root with two children, of which one has three, of which one has two voxels.
    #[test]
    fn words_by_hand() {
        let graph = GraphView {
            depth: 3,
            mask: &[0b11, 0, 0b111, 0, 0b11, 0],
            first: &[1, 0, 3, 0, 6, 0],
            ..GraphView::default()
        };
        let plain = NodeLayout::new(&graph, true, false);
        let bricks = NodeLayout::new(&graph, true, true);
        assert_eq!((plain.bricks(), bricks.bricks()), (0..0, 1..3));
        assert_eq!(plain.words(4, 2), 4..5);
        let words = [(0, 0), (1, 1), (2, 1)].map(|(node, level)| bricks.words(node, level));
        assert_eq!(words, [0..1, 1..3, 3..5]);
        assert!(bricks.words(4, 2).is_empty());
        // A leaf, the node with two voxels, a leaf.
        let second = 0b101 << 56 | 3 << 28 | 6;
        let words = NodeLayout::brick_words(&graph, 2);
        assert_eq!(words, Some([0xff_03_ff, second]));
        let mut other = graph;
        other.first = &[1, 0, 3, 0, 1 << 28, 0];
        assert_eq!(NodeLayout::brick_words(&other, 2), None);
        other.links = &[1, 2];
        assert!(NodeLayout::new(&other, true, true).bricks.is_none());
        // Lists that are shared, side by side: each level begins behind the one above, but voxels do not follow on
        // those before.
        let shared = GraphView {
            mask: &[0b11, 0b11, 0b11, 0, 0b11, 0, 0b11],
            first: &[1, 3, 5, 0, 7, 0, 7],
            ..graph
        };
        assert!(NodeLayout::new(&shared, true, true).bricks.is_none());
    }
}
