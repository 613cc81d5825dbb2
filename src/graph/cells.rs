//! Walks over a graph: its cells in Morton order, and counts per level.

use super::{BuildError, Graph, Voxel};

const MOST_LISTED: u64 = 1 << 28;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Cell {
    /// Lowest corner in object coordinates, finest voxels.
    pub corner: [i32; 3],
    /// 0: the root. A cell's side is `2^(depth - level)` finest voxels.
    pub level: u32,
    pub node: u32,
}

#[derive(Debug)]
pub struct Voxels<'g> {
    graph: &'g Graph,
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
            // Every node leads to a cell, also where a damaged file has lost its children.
            if self.stack.len() == before {
                return Some(cell);
            }
        }
        None
    }
}

impl Graph {
    /// Finest voxels and solid leaves in Morton order. A cyclic graph may have too many to list: see
    /// [`Graph::voxels`](field@Graph::voxels).
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

    /// All finest voxels, also those of solid leaves, by their index in the file. Fails for more than 2^28, which graphs
    /// have that share parts.
    pub fn finest_voxels(&self) -> Result<impl Iterator<Item = Voxel> + '_, BuildError> {
        let count = self.voxels;
        if count > MOST_LISTED {
            return Err(BuildError::TooManyToList(count));
        }
        Ok(self.voxels().flat_map(move |cell| {
            let corner = self.file_index(&cell);
            let side = 1i64 << (self.depth - cell.level);
            let color = self.color_of(cell.node);
            let normal = self.normal_of(cell.node);
            (0..side * side * side).map(move |i| {
                let offset = [i / (side * side), i / side % side, i % side];
                Voxel {
                    index: std::array::from_fn(|k| (corner[k] + offset[k]) as i32),
                    color,
                    normal: Some(normal).filter(|n| !n.is_none()),
                }
            })
        }))
    }

    /// Lowest corner, in finest voxels, and level of the one voxel that shows a node. None where nodes may be in several
    /// places or are not stored level by level, and for leaves above the finest level.
    pub fn place_of(&self, node: u32) -> Option<[i32; 4]> {
        if !self.links.is_empty() || self.depth > super::MAX_DEPTH {
            return None;
        }
        let level = self.level_start.partition_point(|&start| start <= node);
        let level = level.checked_sub(1).filter(|&l| l <= self.depth as usize)?;
        let has_children = self.mask.get(node as usize).is_some_and(|&mask| mask != 0);
        if level < self.depth as usize && !has_children {
            return None;
        }
        let mut corner = [0i32; 3];
        let mut child = node;
        for below in (1..=level).rev() {
            let above = self.level_start[below - 1];
            let firsts = above as usize..self.level_start[below] as usize;
            let begun = self.first.get(firsts)?;
            let at = begun.partition_point(|&first| first <= child);
            let parent = above + at.checked_sub(1)? as u32;
            let rank = child - self.first.get(parent as usize)?;
            let mask = *self.mask.get(parent as usize)?;
            let octant = (0..8u8).filter(|octant| mask >> octant & 1 != 0);
            let octant = i32::from({ octant }.nth(rank as usize)?);
            for (k, c) in corner.iter_mut().enumerate() {
                *c |= (octant >> (2 - k) & 1) << (self.depth as usize - below);
            }
            child = parent;
        }
        let [x, y, z] = corner;
        (child == self.root).then_some([x, y, z, level as i32])
    }

    pub fn file_index(&self, cell: &Cell) -> [i64; 3] {
        let origin = self.placement.origin_index;
        [0, 1, 2].map(|k| origin[k].saturating_add(i64::from(cell.corner[k])))
    }

    /// Distinct nodes per level, root first: `depth + 1` numbers.
    pub fn nodes_per_level(&self) -> Vec<u64> {
        if self.is_level_ordered() {
            let pairs = self.level_start.windows(2);
            return pairs
                .map(|p| u64::from(p[1].saturating_sub(p[0])))
                .collect();
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

    pub fn is_level_ordered(&self) -> bool {
        !self.level_start.is_empty()
    }

    /// Counts the finest voxels, also those inside solid leaves and in repeated parts; saturates.
    pub fn count_voxels(&self) -> u64 {
        if self.is_level_ordered() && self.links.is_empty() {
            return self.count_tree_voxels();
        }
        let mut below = vec![1u64; self.len()];
        for height in 1..=self.depth {
            let count = |node: u32| {
                let children = self.children(node).into_iter().flatten();
                let each = children.map(|child| below[child as usize]);
                let leaf = 1u64.checked_shl(3 * height).unwrap_or(u64::MAX);
                each.reduce(u64::saturating_add).unwrap_or(leaf)
            };
            below = (0..self.len() as u32).map(count).collect();
        }
        below.get(self.root as usize).copied().unwrap_or(0)
    }

    fn count_tree_voxels(&self) -> u64 {
        let levels = self.level_start.windows(2).zip(0u32..);
        levels.fold(0u64, |total, (ends, level)| {
            let nodes = ends[0]..ends[1];
            let height = self.depth.saturating_sub(level);
            let leaves = if height == 0 {
                nodes.len() as u64
            } else {
                let has_masks = |at: u32| (at as usize).min(self.mask.len());
                let inner = has_masks(nodes.start)..has_masks(nodes.end);
                let beyond = nodes.len() - inner.len();
                let masks = self.mask[inner].iter();
                (masks.filter(|&&mask| mask == 0).count() + beyond) as u64
            };
            let each = 1u64.checked_shl(3 * height).unwrap_or(u64::MAX);
            total.saturating_add(leaves.saturating_mul(each))
        })
    }
}
