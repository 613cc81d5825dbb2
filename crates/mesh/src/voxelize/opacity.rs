//! Opacities of a mesh's voxels from six sides (`spec/mesh.md`, "Opacities"). The coverage of the finest level comes
//! from the triangles. Coarser levels combine it.

use std::sync::atomic::Ordering;

use rayon::prelude::*;

use super::coverage::{Covered, Masks, cover, joined};
use super::distinct::Distinct;
use super::touch::{Prepared, child};
use super::{Grid, SUBTREE_LEVELS, columns, parts};
use crate::Surface;
use shiftvox::graph::{Graph, GraphView, Opacity, Progress};

/// The opacities of a graph's nodes, one each. The graph is the tree of the
/// voxels that [`voxelize`](super::voxelize()) made of the same surface on the same grid.
///
/// The same on any number of threads.
pub fn opacities<S: Surface + ?Sized>(
    surface: &S,
    grid: &Grid,
    graph: &Graph,
    progress: &dyn Progress,
) -> Vec<Opacity> {
    let side = grid.side(grid.depth());
    let origin = graph.placement.origin_index.map(|index| index * side);
    let covered: Vec<Covered> = (0..graph.len()).map(|_| Covered::default()).collect();
    // Equal triangles cover what one of them covers.
    let distinct = Distinct::of(surface, grid).numbers;
    let sides: Vec<i64> = (0..=graph.depth)
        .map(|level| side << (graph.depth - level))
        .collect();
    let finder = CoverageFinder {
        surface,
        grid,
        graph: graph.view(),
        found: &covered,
        large_from: parts::coarsest_levels(surface, grid, &distinct, &sides),
        progress,
    };
    let voxels = graph.len() as u64;
    progress.begin("find opacities", voxels);
    finder.node(graph.root, &distinct, origin, 0);
    progress.end();
    columns::opacities(graph.view(), covered)
}

struct CoverageFinder<'w, S: ?Sized> {
    surface: &'w S,
    grid: &'w Grid,
    graph: GraphView<'w>,
    found: &'w [Covered],
    /// By triangle, the coarsest level at which it is part of a large object.
    large_from: Vec<u8>,
    progress: &'w dyn Progress,
}

impl<S: Surface + ?Sized> CoverageFinder<'_, S> {
    /// Side on the lattice of a node of a level of the graph, which may have
    /// fewer levels than the grid.
    fn side(&self, level: u32) -> i64 {
        self.grid.side(self.grid.depth()) << (self.graph.depth - level)
    }

    /// A node, of which these triangles may be a part. Deep down, threads are
    /// of no use and triangles are few enough to be prepared.
    fn node(&self, node: u32, triangles: &[u32], corner: [i64; 3], level: u32) -> Inside {
        if self.graph.depth - level <= SUBTREE_LEVELS {
            let prepared: Vec<(Prepared, u8)> = triangles
                .iter()
                .map(|&number| {
                    let corners = self.grid.corners(self.surface, number);
                    (Prepared::new(corners), self.large_from[number as usize])
                })
                .collect();
            let mut list: Vec<u32> = (0..triangles.len() as u32).collect();
            let before = self.below(node, level);
            let masks = self.descend(node, &prepared, &mut list, 0, corner, level);
            self.progress.advance(before);
            return masks;
        }
        let half = self.side(level + 1);
        let inside: Vec<Inside> = (0..8u8)
            .into_par_iter()
            .map(|octant| {
                let Some(inner) = self.graph.child(node, octant) else {
                    return NOTHING;
                };
                let at = child(corner, half, octant);
                let touching: Vec<u32> = triangles
                    .iter()
                    .copied()
                    .filter(|&number| {
                        let corners = self.grid.corners(self.surface, number);
                        Prepared::new(corners).touches(at, half)
                    })
                    .collect();
                self.node(inner, &touching, at, level + 1)
            })
            .collect();
        self.store(node, together(&inside))
    }

    /// Nodes of a subtree, for the progress: those of its two upper levels.
    fn below(&self, node: u32, level: u32) -> u64 {
        if level == self.graph.depth {
            return 1;
        }
        1 + u64::from(self.graph.mask(node).count_ones())
    }

    /// A node whose triangles are those from `begin` to the list's end.
    fn descend(
        &self,
        node: u32,
        prepared: &[(Prepared, u8)],
        list: &mut Vec<u32>,
        begin: usize,
        corner: [i64; 3],
        level: u32,
    ) -> Inside {
        if level == self.graph.depth {
            let side = self.side(level);
            let (mut masks, mut large_from) = (Masks::default(), u8::MAX);
            for &triangle in &list[begin..] {
                let (triangle, from) = &prepared[triangle as usize];
                cover(triangle, corner, side, &mut masks);
                large_from = large_from.min(*from);
            }
            return self.store(node, (masks, large_from));
        }
        let half = self.side(level + 1);
        let end = list.len();
        let mut inside = [NOTHING; 8];
        for octant in 0..8u8 {
            let Some(inner) = self.graph.child(node, octant) else {
                continue;
            };
            let at = child(corner, half, octant);
            for i in begin..end {
                let triangle = list[i];
                if prepared[triangle as usize].0.touches(at, half) {
                    list.push(triangle);
                }
            }
            inside[usize::from(octant)] = self.descend(inner, prepared, list, end, at, level + 1);
            list.truncate(end);
        }
        self.store(node, together(&inside))
    }

    fn store(&self, node: u32, inside: Inside) -> Inside {
        let found = &self.found[node as usize];
        for (found, mask) in found.masks.iter().zip(inside.0) {
            found.store(mask, Ordering::Relaxed);
        }
        found.large_from.store(inside.1, Ordering::Relaxed);
        inside
    }
}

/// The points that a node covers, and the coarsest level at which a large object is in it.
type Inside = (Masks, u8);

const NOTHING: Inside = ([0; 3], u8::MAX);

/// The combination of eight children, by octant.
fn together(children: &[Inside]) -> Inside {
    let masks: Vec<Masks> = children.iter().map(|child| child.0).collect();
    let large_from = children.iter().map(|child| child.1).min();
    (joined(&masks), large_from.unwrap_or(u8::MAX))
}
