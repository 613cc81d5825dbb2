//! Opacities of nodes from their coverage.
//!
//! An engine blends the voxels of a ray as if each covered its part by chance. That is right for leaves. But the parts
//! of one surface fill neighbouring voxels side by side, and the back of a thin tube is behind its front. So the voxels
//! of large objects are combined along their columns:
//!
//! - If a column's voxels cover the face together, each of them is opaque, except those with few points. So a wall that
//!   is cut into two parts is whole in both.
//! - Otherwise a voxel has the points that those before it, seen from a side, leave open. Of a tube that lies in two
//!   voxels the second adds nothing.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use super::coverage::{Covered, Masks, dither, opacity_of};
use super::touch::OTHERS;
use shiftvox::graph::{GraphView, Opacity};

/// All points of a face.
const ALL: u64 = u64::MAX;
/// All four columns of children.
const ALL_COLUMNS: u32 = 0b1111;
/// How many nodes before a node count: a wall along which an axis is steeper is seen by another axis.
const REACH: u32 = 3;
/// Points of 64 that a node has at least to be opaque with its column: with fewer, walls would grow by a voxel.
const LEAST_POINTS: u32 = 16;
/// Levels whose nodes are handed to threads.
const PARALLEL_LEVELS: u32 = 4;

pub(super) fn opacities(graph: GraphView<'_>, covered: Vec<Covered>) -> Vec<Opacity> {
    let nodes = covered.len();
    let columns = Columns {
        graph,
        covered,
        closed: (0..nodes).map(|_| AtomicU32::new(0)).collect(),
        found: (0..nodes).map(|_| AtomicU32::new(0)).collect(),
    };
    for level in (0..=graph.depth).rev() {
        columns.each(level, &|node, _| columns.close(node, level));
        columns.each(level, &|node, place| columns.settle(node, place, level));
    }
    let opacity = |bits: AtomicU32| {
        let [x, y, z, _] = bits.into_inner().to_le_bytes();
        Opacity([x, y, z])
    };
    columns.found.into_iter().map(opacity).collect()
}

struct Columns<'g> {
    graph: GraphView<'g>,
    covered: Vec<Covered>,
    /// By node, four bits for each axis, from `8 * axis` on: of its four columns of children those with a child that
    /// is opaque.
    closed: Vec<AtomicU32>,
    found: Vec<AtomicU32>,
}

impl Columns<'_> {
    /// Calls for each node of a level, with its place.
    fn each(&self, level: u32, call: &(dyn Fn(u32, [u32; 3]) + Sync)) {
        self.below(self.graph.root, [0; 3], 0, level, call);
    }

    fn below(
        &self,
        node: u32,
        place: [u32; 3],
        at: u32,
        level: u32,
        call: &(dyn Fn(u32, [u32; 3]) + Sync),
    ) {
        if at == level {
            call(node, place);
            return;
        }
        let inner = |octant: u8| {
            if let Some(child) = self.graph.child(node, octant) {
                let place =
                    std::array::from_fn(|k| place[k] << 1 | u32::from(octant >> (2 - k) & 1));
                self.below(child, place, at + 1, level, call);
            }
        };
        if at < PARALLEL_LEVELS {
            (0..8u8).into_par_iter().for_each(inner);
        } else {
            (0..8u8).for_each(inner);
        }
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

    fn is_opaque(&self, node: u32, axis: usize) -> bool {
        self.found[node as usize].load(Ordering::Relaxed) >> (8 * axis) & 255 == 255
    }

    /// Notes which columns of a node are closed; its children are settled.
    fn close(&self, node: u32, level: u32) {
        let mut closed = 0;
        for (axis, [u, v]) in OTHERS.into_iter().enumerate() {
            let mut columns = 0;
            if level == self.graph.depth && self.masks(node)[axis] == ALL {
                columns = ALL_COLUMNS;
            }
            for octant in 0..8u8 {
                let child = (level < self.graph.depth).then(|| self.graph.child(node, octant));
                if child
                    .flatten()
                    .is_some_and(|child| self.is_opaque(child, axis))
                {
                    columns |= 1 << (octant >> (2 - u) & 1 | (octant >> (2 - v) & 1) << 1);
                }
            }
            closed |= columns << (8 * axis);
        }
        self.closed[node as usize].store(closed, Ordering::Relaxed);
    }

    /// Finds a node's opacities; the columns of its level are known.
    fn settle(&self, node: u32, place: [u32; 3], level: u32) {
        let masks = self.masks(node);
        let is_large = self.is_large(node, level);
        let dither = dither(&masks);
        let mut bits = 0;
        for axis in 0..3 {
            let own = Column {
                covered: masks[axis],
                closed: self.closed_of(node, axis),
            };
            let sides = if is_large {
                [0, 1].map(|side| self.before(place, level, axis, side))
            } else {
                [Column::default(); 2]
            };
            let all = sides[0].and(sides[1]).and(own);
            let points = own.covered.count_ones();
            let is_whole = own.closed == ALL_COLUMNS
                || is_large
                    && points >= LEAST_POINTS
                    && (all.covered == ALL || all.closed == ALL_COLUMNS);
            for (side, before) in sides.into_iter().enumerate() {
                let points = match is_whole {
                    true => 64,
                    false => (own.covered & !before.covered).count_ones(),
                };
                bits |= u32::from(opacity_of(points, dither)) << (8 * axis + 4 * side);
            }
        }
        self.found[node as usize].store(bits, Ordering::Relaxed);
    }

    /// The coverage of the nodes before a place, seen from a side of an axis. Only nodes of large objects count, up to
    /// the first empty place.
    fn before(&self, place: [u32; 3], level: u32, axis: usize, side: u32) -> Column {
        let mut column = Column::default();
        let mut next = place;
        for _ in 0..REACH {
            next[axis] = match side {
                0 => next[axis].wrapping_sub(1),
                _ => next[axis] + 1,
            };
            let Some(other) = self.node_at(next, level) else {
                break;
            };
            if self.is_large(other, level) {
                column = column.and(Column {
                    covered: self.masks(other)[axis],
                    closed: self.closed_of(other, axis),
                });
            }
        }
        column
    }

    fn masks(&self, node: u32) -> Masks {
        let masks = &self.covered[node as usize].masks;
        [0, 1, 2].map(|axis| masks[axis].load(Ordering::Relaxed))
    }

    /// Whether a large object is in a node of a level.
    fn is_large(&self, node: u32, level: u32) -> bool {
        u32::from(
            self.covered[node as usize]
                .large_from
                .load(Ordering::Relaxed),
        ) <= level
    }

    /// The columns of a node's children that are closed.
    fn closed_of(&self, node: u32, axis: usize) -> u32 {
        self.closed[node as usize].load(Ordering::Relaxed) >> (8 * axis) & ALL_COLUMNS
    }
}

/// The coverage of a column's nodes along an axis.
#[derive(Debug, Clone, Copy, Default)]
struct Column {
    /// Points of their faces.
    covered: u64,
    /// Columns of their children that are closed.
    closed: u32,
}

impl Column {
    fn and(self, other: Self) -> Self {
        Self {
            covered: self.covered | other.covered,
            closed: self.closed | other.closed,
        }
    }
}
