//! The solid cell that a ray meets first, by its own order (for R9 of `SPEC.md`); the graph's depth ends cycles (R10).
//!
//! A line crosses each of the three planes between children at most once, in its direction along that axis. Children
//! are numbered by `octant XOR start`, where `start` has a bit for each axis along which the ray runs downwards.
//! Crossing a plane changes one bit from 0 to 1, never back. So growing numbers go from near to far.

use super::line::{Cube, Line};
use super::number::Number;
use super::ray_frame::RayFrame;
use crate::graph::GraphView;

pub(super) type Seen = (u32, [i32; 4]);

pub(super) struct Search<'w, N> {
    graph: &'w GraphView<'w>,
    view: &'w RayFrame,
    line: Line<'w, N>,
    start: u8,
    /// Cubes tested so far.
    pub(super) tested: u64,
}

impl<'w, N: Number> Search<'w, N> {
    pub(super) fn new(graph: &'w GraphView<'w>, view: &'w RayFrame, i: u32, j: u32) -> Self {
        let line = Line::new(view, i, j);
        let [x, y, z] = line.direction.map(|d| u8::from(d < 0));
        Self {
            graph,
            view,
            line,
            start: x << 2 | y << 1 | z,
            tested: 0,
        }
    }

    pub(super) fn nearest(&mut self) -> Option<Seen> {
        let root = Cube {
            lo: [0; 3],
            at_lo: self.line.at_origin,
        };
        self.tested += 1;
        self.line
            .enters(
                &root,
                1 << self.view.depth,
                &self.line.along_side(self.view.depth),
            )
            .then(|| self.nearest_within(self.graph.root, 0, &root))
            .flatten()
    }

    fn nearest_within(&mut self, node: u32, level: u32, cube: &Cube<N>) -> Option<Seen> {
        let is_leaf = level == self.view.depth || self.graph.mask(node) == 0;
        if is_leaf || self.view.is_solid_by_detail(cube.lo, level) {
            let [x, y, z] = cube.lo.map(|c| c as i32);
            return Some((node, [x, y, z, level as i32]));
        }
        let child_levels = self.view.depth - level - 1;
        let side = 1i64 << child_levels;
        let along_side = self.line.along_side(child_levels);
        for rank in 0..8 {
            let octant = rank ^ self.start;
            let Some(child) = self.graph.child(node, octant) else {
                continue;
            };
            let child_cube = self.line.neighbour(cube, octant, side, &along_side);
            self.tested += 1;
            if self.line.enters(&child_cube, side, &along_side) {
                let seen = self.nearest_within(child, level + 1, &child_cube);
                if seen.is_some() {
                    return seen;
                }
            }
        }
        None
    }
}
