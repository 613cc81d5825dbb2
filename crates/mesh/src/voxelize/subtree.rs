//! One subtree: from its triangles to its voxels.

use super::distinct::Distinct;
use super::mix::{Mix, Painted};
use super::touch::{Prepared, child};
use super::{Grid, VoxelizeReport};
use crate::Surface;
use shiftvox::graph::Voxel;

/// A node of the octree and the triangles that touch it, in their order.
#[derive(Debug)]
pub(super) struct Subtree {
    pub(super) triangles: Vec<u32>,
    pub(super) corner: [i64; 3],
    pub(super) level: u32,
}

impl Subtree {
    /// The voxels within, in Morton order, and what finding them took.
    pub(super) fn voxels<S: Surface + ?Sized>(
        &self,
        surface: &S,
        grid: &Grid,
        distinct: &Distinct,
    ) -> (Vec<Voxel>, VoxelizeReport) {
        let painted = |&number: &u32| {
            let prepared = Prepared::new(grid.corners(surface, number));
            let triangle = surface.triangle(number as usize);
            Painted::new(prepared, &triangle, distinct.repeated(number))
        };
        let mut descent = Descent {
            grid,
            list: (0..self.triangles.len() as u32).collect(),
            painted: self.triangles.iter().map(painted).collect(),
            voxels: Vec::new(),
            report: VoxelizeReport::default(),
        };
        descent.node(0, self.corner, self.level);
        (descent.voxels, descent.report)
    }
}

struct Descent<'g> {
    grid: &'g Grid,
    painted: Vec<Painted>,
    /// The triangles of the nodes on the way down, one node's after the other's.
    list: Vec<u32>,
    voxels: Vec<Voxel>,
    report: VoxelizeReport,
}

impl Descent<'_> {
    /// A node whose triangles are those from `begin` to the list's end.
    fn node(&mut self, begin: usize, corner: [i64; 3], level: u32) {
        if level == self.grid.depth() {
            self.voxel(begin, corner);
            return;
        }
        let half = self.grid.side(level + 1);
        let end = self.list.len();
        for octant in 0..8u8 {
            let at = child(corner, half, octant);
            for i in begin..end {
                let triangle = self.list[i];
                if self.painted[triangle as usize].prepared.touches(at, half) {
                    self.list.push(triangle);
                }
            }
            if self.list.len() > end {
                self.node(end, at, level + 1);
                self.list.truncate(end);
            }
        }
    }

    fn voxel(&mut self, begin: usize, corner: [i64; 3]) {
        let side = self.grid.side(self.grid.depth());
        let mut mix = Mix::default();
        for &triangle in &self.list[begin..] {
            let painted = &self.painted[triangle as usize];
            mix.add(painted, corner, side);
            self.report.touches += u64::from(painted.times);
        }
        self.report.looked_at += (self.list.len() - begin) as u64;
        self.report.voxels += 1;
        let (color, normal) = mix.finish();
        self.voxels.push(Voxel {
            // Below 2^20.
            index: corner.map(|c| (c / side) as i32),
            color,
            normal,
        });
    }
}
