//! Rays at a node, from the surface S, `distance` voxels around its grid. Triangles beyond S do not hide the node.

use std::io;
use std::ops::Range;

use glam::{DVec3, Vec3, Vec3A};

use super::clusters::Occluders;
use super::grid::Grid;
use super::rays::{Around, Meeting, Query};
use crate::geometry::point;

const STEPS_TO_S: u32 = 2;

pub(super) struct Target<'t> {
    pub(super) occluders: &'t Occluders<'t>,
    pub(super) grid: Grid,
    pub(super) own: Range<usize>,
    /// Its own triangles that count, or `None` for all.
    pub(super) taken: Option<&'t [bool]>,
    pub(super) distance: f64,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Aim {
    /// In voxels of the grid.
    pub(super) point: Vec3,
    pub(super) direction: Vec3,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Shot {
    pub(super) point: Vec3,
    pub(super) direction: Vec3,
    /// Distance of its end from that point; infinite where it meets nothing as far as it was followed.
    pub(super) end: f32,
    pub(super) triangle: u32,
    /// The touched voxel in which it ends at one of the node's triangles, or [`NOWHERE`].
    pub(super) touched: u32,
}

impl Shot {
    pub(super) fn end_point(&self) -> DVec3 {
        self.point.as_dvec3() + self.direction.as_dvec3() * f64::from(self.end)
    }
}

pub(super) const NOWHERE: u32 = u32::MAX;
/// A ray's end may lie this far from the triangle, voxels: in the voxel beside.
const END_WITHIN: f64 = 0.01;
const BATCH: usize = 1 << 17;
const CELLS: f32 = 4.0;

fn cell(direction: Vec3) -> usize {
    let cell = |c: f32| (((c + 1.0) * CELLS) as usize).min(7);
    (cell(direction.x) << 3 | cell(direction.y)) << 1 | usize::from(direction.z < 0.0)
}

impl Target<'_> {
    pub(super) fn has(&self, triangle: usize) -> bool {
        let is_taken = |taken: &[bool]| taken[triangle - self.own.start];
        self.own.contains(&triangle) && self.taken.is_none_or(is_taken)
    }

    /// Whether a triangle is one of the node's that are not taken.
    pub(super) fn leaves_out(&self, triangle: u32) -> bool {
        self.own.contains(&(triangle as usize)) && !self.has(triangle as usize)
    }

    fn voxel_at(&self, end: DVec3, slot: &[u32]) -> u32 {
        let cells = self.grid.cells.map(f64::from);
        let number = |at: DVec3| {
            let place = [0, 1, 2].map(|k| at[k].clamp(0.0, cells[k] - 1.0) as u8);
            slot[self.grid.number(place)]
        };
        let here = number(end);
        if here != NOWHERE {
            return here;
        }
        let mut near = (0..27).map(|step| {
            let step = point([step % 3, step / 3 % 3, step / 9]);
            number(end + (step - DVec3::ONE) * END_WITHIN)
        });
        near.find(|&slot| slot != NOWHERE).unwrap_or(NOWHERE)
    }

    /// Rays are followed until `beyond` voxels behind their aims. `slot`: numbers of touched voxels.
    pub(super) fn shoot(
        &self,
        aims: &[Aim],
        beyond: f64,
        slot: &[u32],
        shots: &mut Vec<Shot>,
    ) -> io::Result<()> {
        let cells = point(self.grid.cells);
        // From S, or up to a voxel before it, to behind the aims.
        let reach = DVec3::splat(self.distance.max(beyond) + 2.0);
        let around = Around::of(self.grid.world(-reach), self.grid.world(cells + reach));
        let (mut queries, mut meetings) = (Vec::new(), Vec::new());
        for batch in aims.chunks(BATCH) {
            // Similar rays, which visit the same boxes, follow one another.
            let mut order: Vec<u32> = (0..batch.len() as u32).collect();
            order.sort_by_cached_key(|&number| cell(batch[number as usize].direction));
            let begin = shots.len();
            queries.clear();
            shots.extend(batch.iter().map(|aim| Shot {
                point: aim.point,
                direction: aim.direction,
                end: f32::INFINITY,
                triangle: NOWHERE,
                touched: NOWHERE,
            }));
            queries.extend(order.iter().map(|&number| {
                let aim = batch[number as usize];
                let back = f64::from(self.back_to_surface(aim.point, aim.direction));
                let from = aim.point.as_dvec3() - aim.direction.as_dvec3() * back;
                Query {
                    origin: self.grid.world(from).as_vec3(),
                    direction: aim.direction,
                    most: ((back + beyond) * self.grid.voxel) as f32,
                }
            }));
            self.occluders.nearest(&around, &queries, &mut meetings)?;
            for ((&number, query), meeting) in order.iter().zip(&queries).zip(&meetings) {
                if *meeting == Meeting::NONE {
                    continue;
                }
                let shot = &mut shots[begin + number as usize];
                let length = f64::from(query.most) / self.grid.voxel;
                shot.end = (f64::from(meeting.distance) / self.grid.voxel - length + beyond) as f32;
                shot.triangle = meeting.triangle;
                if self.has(meeting.triangle as usize) {
                    shot.touched = self.voxel_at(shot.end_point(), slot);
                }
            }
        }
        Ok(())
    }

    #[inline]
    fn back_to_surface(&self, point: Vec3, direction: Vec3) -> f32 {
        let (point, direction) = (Vec3A::from(point), Vec3A::from(direction));
        let cells = Vec3A::from_array(self.grid.cells.map(f32::from));
        // A convex function: Newton's steps from beyond S never go past it.
        let mut back = self.distance as f32 + cells.length();
        for _ in 0..STEPS_TO_S {
            let at = point - direction * back;
            let outside = (at - cells).max(Vec3A::ZERO) + at.min(Vec3A::ZERO);
            let distance = outside.length();
            let slope = -outside.dot(direction) / distance;
            if slope.is_nan() || slope <= 0.0 {
                break;
            }
            back -= (distance - self.distance as f32) / slope;
        }
        back
    }
}
