//! Opacities of a mesh's voxels from six sides (`spec/mesh.md`, "Opacities").
//!
//! An engine blends the voxels of a ray as if each covered its part by chance. But the parts of one surface fill
//! neighbouring voxels side by side. So nodes of large objects are combined along their columns: a wall that is cut into
//! two parts is whole in both.

use std::ops::Range;

use rayon::prelude::*;

use super::coverage::{Masks, POINTS, cover, dither, joined, opacity_of};
use super::distinct::Distinct;
use super::mix::{HOLE_OF_OPACITIES, Mix};
use super::touch::OTHERS;
use super::walk::{Cube, Subtree, walk};
use super::{Grid, parts};
use crate::{Surface, Triangle};
use shiftvox::graph::{Graph, GraphView, Opacity, Progress};

const ALL: u64 = u64::MAX;
const ALL_COLUMNS: u8 = 0b1111;
/// Nodes before a node that count: steeper walls are seen along another axis.
const REACH: u32 = 3;
/// Points of a node that is opaque with its column: half of them. One node of each column along a flat wall's main axis
/// has as many. With fewer, walls would grow by a voxel; with more, they would have holes.
const LEAST_POINTS: u32 = (POINTS * POINTS / 2) as u32;
/// A pane seen at an angle of cosine `c` is crossed in about `1/c` voxels, each of which blends `c^2` of its opacity
/// from the front: `c` in all, not 1. A third of that opacity from the other sides adds `(1 - c^2)/3c`.
const SHEET: u32 = 3;

#[derive(Clone, Copy)]
struct Inside {
    masks: Masks,
    large_from: u8,
    /// Whether all its triangles let light through.
    is_clear: bool,
}

const NOTHING: Inside = Inside {
    masks: [0; 3],
    large_from: u8::MAX,
    is_clear: true,
};

/// The opacities of a graph's nodes, one each, the same on any number of threads.
///
/// # Panics
/// Unless the graph is the tree, level by level, of the voxels that [`voxelize`](super::voxelize()) made of the same
/// surface on the same grid.
pub fn opacities(
    surface: &dyn Surface,
    grid: &Grid,
    graph: &Graph,
    progress: &dyn Progress,
) -> Vec<Opacity> {
    let voxel = grid.cube().voxel;
    let cube = Cube {
        corner: graph.placement.origin_index.map(|index| index * voxel),
        voxel,
        depth: graph.depth,
    };
    let numbers = Distinct::of(surface, grid).numbers;
    let large_from = parts::coarsest_levels(surface, grid, &numbers, cube);
    let (_, voxel_size) = grid.placement();
    let leaves = |subtree: Subtree<'_>| {
        let clear = |&number: &u32| {
            let is_clear = !surface.is_opaque(number as usize);
            is_clear.then(|| {
                let triangle = surface.triangle(number as usize);
                let texels = triangle.texels(voxel_size / POINTS as f64);
                (triangle, texels)
            })
        };
        let clear: Vec<Option<(Triangle<'_>, f64)>> = subtree.numbers.iter().map(clear).collect();
        let mut leaves = Vec::new();
        subtree.leaves(cube, |triangles, corner| {
            let mut leaf = NOTHING;
            let mut mix = Mix::default();
            let mut is_shown = false;
            for &triangle in triangles {
                let number = subtree.numbers[triangle as usize];
                let prepared = &subtree.prepared[triangle as usize];
                let clear = clear[triangle as usize].as_ref();
                leaf.large_from = leaf.large_from.min(large_from[number as usize]);
                match clear {
                    Some((clear, _)) => mix.add(clear, prepared, corner, voxel, voxel_size),
                    None => is_shown = true,
                }
                leaf.is_clear &= clear.is_some();
                let clear = clear.map(|(clear, texels)| (clear, *texels));
                cover(prepared, clear, corner, voxel, &mut leaf.masks);
            }
            if !is_shown && !mix.is_shown(HOLE_OF_OPACITIES) {
                return;
            }
            leaves.push(leaf);
        });
        leaves
    };
    let mut inside = Vec::with_capacity(graph.len());
    inside.resize(graph.mask.len(), NOTHING);
    let mut take = |leaves: Vec<Inside>| inside.extend(leaves);
    walk(
        surface,
        grid,
        cube,
        numbers,
        &leaves,
        &mut take,
        ("find opacities", progress),
    );
    assert_eq!(inside.len(), graph.len(), "the tree is not this surface's");
    let mut columns = Columns {
        graph: graph.view(),
        places: places(graph),
        closed: vec![[0; 3]; inside.len()],
        found: vec![Opacity([0; 3]); inside.len()],
        inside,
    };
    for level in (0..graph.depth).rev() {
        columns.combine(nodes(graph, level));
    }
    for level in (0..=graph.depth).rev() {
        let nodes = nodes(graph, level);
        let range = nodes.start as usize..nodes.end as usize;
        let all = nodes.into_par_iter();
        let closed: Vec<[u8; 3]> = all.clone().map(|n| columns.close(n, level)).collect();
        columns.closed[range.clone()].copy_from_slice(&closed);
        let found: Vec<Opacity> = all.map(|n| columns.settle(n, level)).collect();
        columns.found[range].copy_from_slice(&found);
    }
    columns.found
}

fn nodes(graph: &Graph, level: u32) -> Range<u32> {
    let level = level as usize;
    graph.level_start[level]..graph.level_start[level + 1]
}

fn places(graph: &Graph) -> Vec<[u32; 3]> {
    let mut places = vec![[0; 3]; graph.len()];
    for node in 0..graph.mask.len() as u32 {
        let place: [u32; 3] = places[node as usize];
        for octant in 0..8u8 {
            if let Some(child) = graph.view().child(node, octant) {
                let bit = |k: usize| u32::from(octant >> (2 - k) & 1);
                places[child as usize] = [0, 1, 2].map(|k| place[k] << 1 | bit(k));
            }
        }
    }
    places
}

struct Columns<'g> {
    graph: GraphView<'g>,
    places: Vec<[u32; 3]>,
    inside: Vec<Inside>,
    /// By node and axis, a bit for each of its four columns of children that has an opaque child.
    closed: Vec<[u8; 3]>,
    found: Vec<Opacity>,
}

impl Columns<'_> {
    fn combine(&mut self, nodes: Range<u32>) {
        let (upper, lower) = self.inside.split_at_mut(nodes.end as usize);
        let level = &mut upper[nodes.start as usize..];
        level
            .par_iter_mut()
            .zip(nodes.clone())
            .for_each(|(inside, node)| {
                let children: [Inside; 8] = std::array::from_fn(|octant| {
                    let child = self.graph.child(node, octant as u8);
                    child.map_or(NOTHING, |child| lower[(child - nodes.end) as usize])
                });
                inside.masks = joined(&children.map(|child| child.masks));
                let large_from = children.iter().map(|child| child.large_from);
                inside.large_from = large_from.fold(u8::MAX, u8::min);
                inside.is_clear = children.iter().all(|child| child.is_clear);
            });
    }

    fn close(&self, node: u32, level: u32) -> [u8; 3] {
        if level == self.graph.depth {
            let masks = self.inside[node as usize].masks;
            return masks.map(|mask| if mask == ALL { ALL_COLUMNS } else { 0 });
        }
        let mut closed = [0; 3];
        for octant in 0..8u8 {
            let Some(child) = self.graph.child(node, octant) else {
                continue;
            };
            for (axis, [u, v]) in OTHERS.into_iter().enumerate() {
                if self.found[child as usize].0[axis] == u8::MAX {
                    let column = octant >> (2 - u) & 1 | (octant >> (2 - v) & 1) << 1;
                    closed[axis] |= 1 << column;
                }
            }
        }
        closed
    }

    fn settle(&self, node: u32, level: u32) -> Opacity {
        let is_large = self.is_large(node, level);
        let Inside {
            masks, is_clear, ..
        } = self.inside[node as usize];
        let dither = dither(&masks);
        let covered = masks.map(u64::count_ones);
        let least = match is_clear {
            true => covered.into_iter().fold(0, u32::max) / SHEET,
            false => 0,
        };
        Opacity([0, 1, 2].map(|axis| {
            let own = self.column(node, axis);
            let sides = [0, 1].map(|side| match is_large {
                true => self.before(node, level, axis, side),
                false => Column::default(),
            });
            let all = sides[0].and(sides[1]).and(own);
            let is_whole = own.closed == ALL_COLUMNS
                || is_large
                    && own.covered.count_ones() >= LEAST_POINTS
                    && (all.covered == ALL || all.closed == ALL_COLUMNS);
            let [low, high] = sides.map(|before| {
                let open = own.covered & !before.covered;
                let points = open.count_ones().max(least);
                opacity_of(if is_whole { 64 } else { points }, dither)
            });
            low | high << 4
        }))
    }

    /// The coverage of the nodes before a node, seen from a side of an axis. Only nodes of large objects count, up to
    /// the first empty place.
    fn before(&self, node: u32, level: u32, axis: usize, side: u32) -> Column {
        let mut column = Column::default();
        let mut next = self.places[node as usize];
        for _ in 0..REACH {
            next[axis] = match side {
                0 => next[axis].wrapping_sub(1),
                _ => next[axis] + 1,
            };
            let Some(other) = self.node_at(next, level) else {
                break;
            };
            if self.is_large(other, level) {
                column = column.and(self.column(other, axis));
            }
        }
        column
    }

    fn node_at(&self, place: [u32; 3], level: u32) -> Option<u32> {
        if place.iter().any(|&p| p >> level != 0) {
            return None;
        }
        (0..level).rev().try_fold(self.graph.root, |node, bit| {
            let [x, y, z] = place.map(|p| p >> bit & 1);
            self.graph.child(node, (x << 2 | y << 1 | z) as u8)
        })
    }

    fn is_large(&self, node: u32, level: u32) -> bool {
        u32::from(self.inside[node as usize].large_from) <= level
    }

    fn column(&self, node: u32, axis: usize) -> Column {
        Column {
            covered: self.inside[node as usize].masks[axis],
            closed: self.closed[node as usize][axis],
        }
    }
}

#[derive(Clone, Copy, Default)]
struct Column {
    covered: u64,
    /// Columns of their children that are closed.
    closed: u8,
}

impl Column {
    fn and(self, other: Self) -> Self {
        Self {
            covered: self.covered | other.covered,
            closed: self.closed | other.closed,
        }
    }
}
