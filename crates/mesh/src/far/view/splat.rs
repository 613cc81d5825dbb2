//! A voxel in the picture: a square of the size of its cube's outline.

use std::ops::Range;

use glam::DVec3;

use crate::far::record::Node;
use crate::geometry::point;
use crate::raster::RasterCamera;

/// Share by which an outline is drawn larger, so that rounding leaves no gap between cubes.
const OUTLINE_MARGIN: f64 = 0.01;

#[derive(Debug, Clone, Copy)]
pub(super) struct Places {
    origin: DVec3,
    voxel: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Square {
    pub(super) middle: [f64; 2],
    /// Half its side, pixels: its area is that of the cube's outline.
    pub(super) half: f64,
    pub(super) depth: f64,
    /// Depth of its cube's nearest corner.
    pub(super) nearest: f64,
    pub(super) towards_eye: DVec3,
}

impl Places {
    pub(super) fn of(node: &Node, centre: DVec3) -> Self {
        Self {
            origin: point(node.origin) + centre,
            voxel: f64::from(node.voxel),
        }
    }

    pub(super) fn towards_eye(&self, view: &RasterCamera, place: &[u8]) -> DVec3 {
        (view.eye - self.middle(place)).normalize_or(-view.forward)
    }

    fn middle(&self, place: &[u8]) -> DVec3 {
        let place = point([place[0], place[1], place[2]]);
        self.origin + (place + DVec3::splat(0.5)) * self.voxel
    }

    pub(super) fn square(&self, view: &RasterCamera, place: &[u8]) -> Option<Square> {
        let seen = view.seen(self.middle(place));
        if seen.z < view.near {
            return None;
        }
        let towards_eye = self.towards_eye(view, place);
        let outline = towards_eye.abs().element_sum();
        let side = self.voxel * view.focal_px / seen.z * libm::sqrt(outline);
        Some(Square {
            middle: view.place(seen),
            half: side / 2.0,
            depth: seen.z,
            nearest: seen.z - self.voxel / 2.0 * view.forward.abs().element_sum(),
            towards_eye,
        })
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Hexagon {
    middle: [f64; 2],
    edges: [[f64; 2]; 3],
    reach: [f64; 3],
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

impl Places {
    pub(super) fn hexagon(&self, view: &RasterCamera, square: &Square) -> Hexagon {
        let across = (square.middle[0] - f64::from(view.width) / 2.0) / view.focal_px;
        let up = (f64::from(view.height) / 2.0 - square.middle[1]) / view.focal_px;
        let scale = self.voxel / 2.0 * view.focal_px / square.depth;
        let edges = [0, 1, 2].map(|axis| {
            let forward = view.forward[axis];
            [
                (view.right[axis] - across * forward) * scale,
                (up * forward - view.up[axis]) * scale,
            ]
        });
        let reach = [0, 1, 2].map(|axis| {
            let others = edges.iter().map(|&other| cross(other, edges[axis]).abs());
            others.sum::<f64>() * (1.0 + OUTLINE_MARGIN)
        });
        Hexagon {
            middle: square.middle,
            edges,
            reach,
        }
    }
}

impl Hexagon {
    /// Ranges of columns and rows.
    pub(super) fn pixels(&self, view: &RasterCamera) -> [Range<usize>; 2] {
        let sides = [view.width, view.height].map(f64::from);
        [0, 1].map(|k| {
            let at = |c: f64| (c - 0.5).ceil().clamp(0.0, sides[k]) as usize;
            let half = self.edges.iter().map(|edge| edge[k].abs()).sum::<f64>();
            let half = half * (1.0 + OUTLINE_MARGIN);
            at(self.middle[k] - half)..at(self.middle[k] + half)
        })
    }

    pub(super) fn holds(&self, x: usize, y: usize) -> bool {
        let [x, y] = [x, y].map(|c| c as f64 + 0.5);
        let offset = [x - self.middle[0], y - self.middle[1]];
        let mut edges = self.edges.iter().zip(self.reach);
        edges.all(|(&edge, reach)| cross(offset, edge).abs() <= reach)
    }
}

impl Square {
    /// Ranges of columns and rows.
    pub(super) fn touched(&self, view: &RasterCamera) -> [Range<usize>; 2] {
        let sides = [view.width, view.height].map(f64::from);
        [0, 1].map(|k| {
            let at = |c: f64| c.clamp(0.0, sides[k]) as usize;
            let (low, high) = (self.middle[k] - self.half, self.middle[k] + self.half);
            at(low.floor())..at(high.ceil())
        })
    }

    /// The [`PARTS`] of a row or column whose middles are in the square, a bit each.
    pub(super) fn parts(&self, k: usize, pixel: usize) -> u32 {
        let at = |edge: f64| {
            let part = ((edge - pixel as f64) * PARTS as f64 - 0.5).ceil();
            part.clamp(0.0, PARTS as f64) as u32
        };
        let low = at(self.middle[k] - self.half);
        let high = at(self.middle[k] + self.half);
        (1 << high) - (1 << low.min(high))
    }
}

pub(super) const PARTS: usize = 4;
