//! Walking a graph: its cells in Morton order, and counts by level.

use super::Graph;

/// A finest voxel, or a solid leaf above the finest level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Cell {
    /// Lowest corner in object coordinates, finest voxels.
    pub corner: [i32; 3],
    /// Its level, 0 = root; it is `2^(depth - level)` finest voxels a side.
    pub level: u32,
    /// The node that is seen there.
    pub node: u32,
}

/// The cells of a graph in Morton order; see [`Graph::voxels`].
#[derive(Debug)]
pub struct Voxels<'g> {
    graph: &'g Graph,
    /// What is still to do, the next on top: at most seven a level.
    stack: Vec<Cell>,
}

impl Iterator for Voxels<'_> {
    type Item = Cell;

    fn next(&mut self) -> Option<Cell> {
        while let Some(cell) = self.stack.pop() {
            if cell.level >= self.graph.depth {
                return Some(cell);
            }
            let children = self.graph.children(cell.node);
            let level = cell.level + 1;
            let side = 1i32 << (self.graph.depth - level);
            let before = self.stack.len();
            for (octant, child) in children.into_iter().enumerate().rev() {
                let Some(node) = child else { continue };
                let axis = |k: usize| cell.corner[k] + side * (octant as i32 >> (2 - k) & 1);
                let corner = [axis(0), axis(1), axis(2)];
                self.stack.push(Cell {
                    corner,
                    level,
                    node,
                });
            }
            // So too a node whose children a damaged file has lost: then
            // every node leads to a cell, and the walk never runs dry.
            if self.stack.len() == before {
                return Some(cell);
            }
        }
        None
    }
}

impl Graph {
    /// Finest voxels and solid leaves in Morton order. In a cyclic graph
    /// they may be more than anyone can wait for: see [`Graph::voxels`](field@Graph::voxels).
    #[must_use]
    pub fn voxels(&self) -> Voxels<'_> {
        let root = Cell {
            corner: [0; 3],
            level: 0,
            node: self.root,
        };
        let drawable = (self.root as usize) < self.len() && self.depth <= super::MAX_DEPTH;
        Voxels {
            graph: self,
            stack: drawable.then_some(root).into_iter().collect(),
        }
    }

    /// File index of a cell's lowest corner.
    #[must_use]
    pub fn file_index(&self, cell: &Cell) -> [i64; 3] {
        let origin = self.placement.origin_index;
        [0, 1, 2].map(|k| origin[k].saturating_add(i64::from(cell.corner[k])))
    }

    /// Distinct nodes of each level, root first: `depth + 1` numbers.
    #[must_use]
    pub fn nodes_per_level(&self) -> Vec<u64> {
        if self.is_level_ordered() {
            let pairs = self.level_start.windows(2);
            return pairs.map(|p| u64::from(p[1].saturating_sub(p[0]))).collect();
        }
        let mut counts = Vec::new();
        let mut level = vec![self.root];
        for _ in 0..=self.depth {
            counts.push(level.len() as u64);
            let mut below: Vec<u32> = level
                .iter()
                .flat_map(|&node| self.children(node).into_iter().flatten())
                .collect();
            below.sort_unstable();
            below.dedup();
            level = below;
        }
        counts
    }

    /// Whether nodes are stored level by level.
    #[must_use]
    pub fn is_level_ordered(&self) -> bool {
        !self.level_start.is_empty()
    }

    /// Counts the finest voxels, those inside solid leaves too and repeated
    /// parts as often as they occur; saturates. Takes time in proportion to
    /// the nodes (times the levels, if the graph is not level by level).
    #[must_use]
    pub fn count_voxels(&self) -> u64 {
        let ordered = self.is_level_ordered();
        if ordered && self.links.is_empty() {
            return self.count_tree_voxels();
        }
        // Voxels below a node that is `height` levels above the finest.
        let mut below = vec![1u64; self.len()];
        for height in 1..=self.depth {
            let level = (self.depth - height) as usize;
            let nodes = if ordered {
                let start = |l: usize| self.level_start.get(l).map_or(0, |&n| n as usize);
                start(level)..start(level + 1).min(self.len())
            } else {
                0..self.len()
            };
            let count = |node: usize, below: &[u64]| {
                let mut total = 0u64;
                let mut leaf = true;
                for child in self.children(node as u32).into_iter().flatten() {
                    leaf = false;
                    total = total.saturating_add(below[child as usize]);
                }
                if leaf {
                    1u64.checked_shl(3 * height).unwrap_or(u64::MAX)
                } else {
                    total
                }
            };
            if ordered {
                // Children are of the level below, which is done.
                for node in nodes {
                    below[node] = count(node, &below);
                }
            } else {
                below = nodes.map(|node| count(node, &below)).collect();
            }
        }
        below.get(self.root as usize).copied().unwrap_or(0)
    }

    /// The same for a tree stored level by level, where every node occurs once.
    fn count_tree_voxels(&self) -> u64 {
        let levels = self.level_start.windows(2).zip(0u32..);
        levels.fold(0u64, |total, (ends, level)| {
            let nodes = ends[0]..ends[1];
            let height = self.depth.saturating_sub(level);
            let leaves = if height == 0 {
                nodes.len() as u64
            } else {
                let view = self.view();
                nodes.filter(|&node| view.mask(node) == 0).count() as u64
            };
            let each = 1u64.checked_shl(3 * height).unwrap_or(u64::MAX);
            total.saturating_add(leaves.saturating_mul(each))
        })
    }
}
