//! Rays at a node: which of its voxels are seen, and what of them.
//!
//! First *visibility rays* are aimed at points of what is in each voxel, from random
//! directions and from those from which a neighbour was seen, until one gets
//! there: a voxel that none reaches is dropped.
//! Then *probes* are aimed at random points of the outlines of the voxels that
//! were seen, from random directions: what share of them ends in a voxel is
//! its opacity, which `count` finds. Rays begin on the surface S, all points
//! of which are `distance` voxels from the grid; everything from there on hides.

use std::collections::VecDeque;
use std::ops::Range;

use glam::DVec3;

use super::count::Counted;
use super::grid::Grid;
use super::rays::Occluders;
use super::touch::{POINTS, Touched, touched};
use crate::far::blend::Blend;
use crate::split_mix::SplitMix;

/// Steps of the search for S along a ray; it is nearly straight after the first.
const STEPS_TO_S: u32 = 3;
/// Most visibility rays from random directions at a voxel that none reached yet.
pub(super) const MOST_VISIBILITY_RAYS: u32 = 24;
/// Most of them from where neighbours were seen: what one window lets a ray
/// through to lies side by side, and a random direction seldom finds the window.
pub(super) const MOST_FOLLOWED: u8 = 24;

/// The surface at a ray's end.
#[derive(Debug, Clone, Copy)]
pub(super) struct SurfaceSample {
    /// Unit vector to the eye.
    pub(super) towards_eye: DVec3,
    /// Unit normal on the eye's side.
    pub(super) normal: DVec3,
    /// Linear light.
    pub(super) color: DVec3,
}

/// A voxel that was seen.
#[derive(Debug)]
pub(super) struct Seen {
    pub(super) place: [u8; 3],
    pub(super) samples: Vec<SurfaceSample>,
    pub(super) counted: Counted,
}

/// What the rays of a node found.
#[derive(Debug)]
pub(super) struct Sampled {
    /// In the order of the grid.
    pub(super) seen: Vec<Seen>,
    /// Voxels that triangles touch, seen or not.
    pub(super) touched: u32,
    pub(super) rays: u32,
    pub(super) hits: u32,
}

/// A node that is sampled.
pub(super) struct Target<'t> {
    pub(super) occluders: &'t Occluders,
    pub(super) grid: Grid,
    /// The node's own triangles among the occluders.
    pub(super) own: Range<usize>,
    /// Least distance of an eye that sees it, voxels.
    pub(super) distance: f64,
    pub(super) opacity_blend: Blend,
}

/// How many rays a node gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rays {
    /// So many probes for each voxel that is seen.
    PerVoxel(u32),
    /// So many in all, of which at most half are visibility rays.
    InAll(u32),
}

/// A ray that ended, in voxels of the grid.
pub(super) struct Shot {
    pub(super) from: DVec3,
    pub(super) direction: DVec3,
    /// Where it ends along its direction; infinite where it meets nothing.
    pub(super) end: f64,
    /// The triangle that it meets.
    pub(super) triangle: usize,
}

/// Random numbers of a node.
pub(super) struct Chance(SplitMix);

impl Chance {
    pub(super) fn new(seed: u64) -> Self {
        let scrambled = seed.wrapping_mul(0xd134_2543_de82_ef95) ^ 0x9e37_79b9_7f4a_7c15;
        Self(SplitMix::new(scrambled))
    }

    /// 0 to 1, without 1.
    pub(super) fn unit(&mut self) -> f64 {
        self.0.unit()
    }
}

impl Target<'_> {
    /// Shoots rays. `sample_at` gives normal and colour of a triangle at a point,
    /// `plane` a triangle's unit normal; at most `most` rays are shot.
    pub(super) fn sample(
        &self,
        rays: Rays,
        most: u32,
        seed: u64,
        corners: impl Fn(usize) -> [DVec3; 3],
        sample_at: impl Fn(usize, DVec3, DVec3) -> SurfaceSample,
        plane: impl Fn(usize) -> DVec3,
    ) -> Sampled {
        let mut chance = Chance::new(seed);
        let touched = touched(&self.grid, self.own.clone().map(corners), &mut chance);
        let mut is_seen = vec![false; self.grid.len()];
        let most_visibility_rays = match rays {
            Rays::PerVoxel(_) => most / 2,
            Rays::InAll(rays) => rays.min(most).div_ceil(2),
        };
        let mut shots =
            self.find_visible(&touched, most_visibility_rays, &mut chance, &mut is_seen);
        let visibility_rays = shots.len();
        let aims = numbers(&is_seen);
        let left = most - visibility_rays as u32;
        let probes = match rays {
            Rays::PerVoxel(probes) => left.min(probes.saturating_mul(aims.len() as u32)),
            Rays::InAll(rays) => left.min(rays.saturating_sub(visibility_rays as u32)),
        };
        self.probe(&aims, probes, &mut chance, &mut shots, &mut is_seen);
        let mut slot = vec![u32::MAX; self.grid.len()];
        let mut seen: Vec<Seen> = Vec::new();
        for number in numbers(&is_seen) {
            slot[number as usize] = seen.len() as u32;
            seen.push(Seen {
                place: self.grid.place(number as usize),
                samples: Vec::new(),
                counted: Counted::default(),
            });
        }
        let mut hits = 0;
        for shot in &shots {
            let Some(place) = self.end_of(shot) else {
                continue;
            };
            hits += 1;
            let point = self.grid.world(shot.from + shot.direction * shot.end);
            let at = &mut seen[slot[self.grid.number(place)] as usize];
            at.samples
                .push(sample_at(shot.triangle, point, -shot.direction));
        }
        self.count(&shots[visibility_rays..], &slot, &aims, plane, &mut seen);
        Sampled {
            seen,
            touched: touched.len() as u32,
            rays: shots.len() as u32,
            hits,
        }
    }

    /// The voxel in which a ray ends at one of the node's own triangles.
    pub(super) fn end_of(&self, shot: &Shot) -> Option<[u8; 3]> {
        if !self.own.contains(&shot.triangle) {
            return None;
        }
        let mut last = None;
        for crossing in self.grid.along(shot.from, shot.direction) {
            last = Some(crossing.place);
            if crossing.leave > shot.end {
                break;
            }
        }
        last
    }

    /// Aims visibility rays at every voxel until one reaches something in it.
    fn find_visible(
        &self,
        touched: &[Touched],
        most: u32,
        chance: &mut Chance,
        is_seen: &mut [bool],
    ) -> Vec<Shot> {
        let starts: Vec<Directions> = touched.iter().map(|_| Directions::new(chance)).collect();
        let mut rays = VisibilityRays {
            shots: Vec::new(),
            most: most as usize,
            is_seen,
            slot: vec![u32::MAX; self.grid.len()],
            followed: vec![0; touched.len()],
            fresh: VecDeque::new(),
        };
        for (slot, voxel) in touched.iter().enumerate() {
            // Fewer than 2^24 voxels in a grid.
            rays.slot[voxel.number as usize] = slot as u32;
        }
        for turn in 0..MOST_VISIBILITY_RAYS {
            for (voxel, directions) in touched.iter().zip(&starts) {
                if !rays.is_seen[voxel.number as usize] {
                    let point = voxel.points[turn as usize % POINTS];
                    rays.shoot(self, point, directions.at(turn));
                }
            }
            self.follow(touched, &mut rays);
        }
        rays.shots
    }

    /// Aims at the neighbours of voxels that were just seen, along the same directions, until no more are found.
    fn follow(&self, touched: &[Touched], rays: &mut VisibilityRays<'_>) {
        while let Some((number, direction)) = rays.fresh.pop_front() {
            for neighbour in self.grid.neighbours(number as usize) {
                let slot = rays.slot[neighbour];
                if slot == u32::MAX || rays.is_seen[neighbour] {
                    continue;
                }
                let followed = &mut rays.followed[slot as usize];
                if *followed < MOST_FOLLOWED {
                    let point = touched[slot as usize].points[usize::from(*followed) % POINTS];
                    *followed += 1;
                    rays.shoot(self, point, direction);
                }
            }
        }
    }

    /// Probes voxels, in turn.
    fn probe(
        &self,
        voxels: &[u32],
        rays: u32,
        chance: &mut Chance,
        shots: &mut Vec<Shot>,
        is_seen: &mut [bool],
    ) {
        if voxels.is_empty() {
            return;
        }
        let starts: Vec<Directions> = voxels.iter().map(|_| Directions::new(chance)).collect();
        shots.reserve_exact(rays as usize);
        for ray in 0..rays as usize {
            let aim = ray % voxels.len();
            let direction = starts[aim].at((ray / voxels.len()) as u32);
            let point = entry(self.grid.place(voxels[aim] as usize), direction, chance);
            let shot = self.shoot(point, direction);
            if let Some(place) = self.end_of(&shot) {
                is_seen[self.grid.number(place)] = true;
            }
            shots.push(shot);
        }
    }

    /// A ray from S through a point of the grid.
    fn shoot(&self, point: DVec3, direction: DVec3) -> Shot {
        let from = point - direction * self.back_to_surface(point, direction);
        let meeting = self.occluders.nearest(self.grid.world(from), direction);
        Shot {
            from,
            direction,
            end: meeting.map_or(f64::INFINITY, |m| m.distance / self.grid.voxel),
            triangle: meeting.map_or(usize::MAX, |m| m.triangle),
        }
    }

    /// How far back from a point of the grid along a direction S is, voxels.
    fn back_to_surface(&self, point: DVec3, direction: DVec3) -> f64 {
        let cells = DVec3::from_array(self.grid.cells.map(f64::from));
        // The distance from the grid grows ever faster along the ray: Newton's
        // steps from beyond S come nearer to it and never go past.
        let mut back = self.distance + cells.length();
        for _ in 0..STEPS_TO_S {
            let at = point - direction * back;
            let outside = (at - cells).max(DVec3::ZERO) + at.min(DVec3::ZERO);
            let distance = outside.length();
            let slope = -outside.dot(direction) / distance;
            // Beyond the grid there is a slope; not for a direction of zero length.
            if slope.is_nan() || slope <= 0.0 {
                break;
            }
            back -= (distance - self.distance) / slope;
        }
        back
    }
}

/// The visibility rays of a node, as they are shot.
struct VisibilityRays<'l> {
    shots: Vec<Shot>,
    /// How many there may be.
    most: usize,
    /// Of each voxel of the grid, whether one reached it.
    is_seen: &'l mut [bool],
    /// Of each voxel of the grid, its number among those touched.
    slot: Vec<u32>,
    /// Of each voxel that is touched, how often it was aimed at from where a neighbour was seen.
    followed: Vec<u8>,
    /// Voxels that were just seen, and along which direction.
    fresh: VecDeque<(u32, DVec3)>,
}

impl VisibilityRays<'_> {
    /// Aims a ray at a point along a direction, unless there were enough rays.
    fn shoot(&mut self, target: &Target<'_>, point: DVec3, direction: DVec3) {
        if self.shots.len() >= self.most {
            return;
        }
        let shot = target.shoot(point, direction);
        if let Some(place) = target.end_of(&shot) {
            let number = target.grid.number(place);
            if !std::mem::replace(&mut self.is_seen[number], true) {
                self.fresh.push_back((number as u32, direction));
            }
        }
        self.shots.push(shot);
    }
}

/// Directions of a voxel's rays: spread by the sequence R2 from a start of its own.
struct Directions([f64; 2]);

impl Directions {
    fn new(chance: &mut Chance) -> Self {
        Self([chance.unit(), chance.unit()])
    }

    fn at(&self, turn: u32) -> DVec3 {
        let turn = f64::from(turn);
        let u = (self.0[0] + turn * 0.754_877_666_246_692_8).fract();
        let v = (self.0[1] + turn * 0.569_840_290_998_053_3).fract();
        let z = 1.0 - 2.0 * u;
        let ring = libm::sqrt((1.0 - z * z).max(0.0));
        let (sin, cos) = libm::sincos(v * std::f64::consts::TAU);
        DVec3::new(ring * cos, ring * sin, z)
    }
}

fn numbers(marks: &[bool]) -> Vec<u32> {
    let marked = marks.iter().enumerate().filter(|(_, mark)| **mark);
    marked.map(|(number, _)| number as u32).collect()
}

/// A random point of a voxel's outline as seen along a direction, on the side where a ray enters.
fn entry(place: [u8; 3], direction: DVec3, chance: &mut Chance) -> DVec3 {
    let faces = direction.abs();
    let mut pick = chance.unit() * faces.element_sum();
    let mut axis = 0;
    while axis < 2 && pick >= faces[axis] {
        pick -= faces[axis];
        axis += 1;
    }
    let mut point = DVec3::new(chance.unit(), chance.unit(), chance.unit());
    point[axis] = if direction[axis] < 0.0 { 1.0 } else { 0.0 };
    point + DVec3::from_array(place.map(f64::from))
}

/// The direction in which normals agree best, whichever side they were seen from.
pub(super) fn main_normal(samples: &[SurfaceSample]) -> DVec3 {
    let mut columns = [DVec3::ZERO; 3];
    let mut sum = DVec3::ZERO;
    for sample in samples {
        let n = sample.normal;
        let aligned = if n.dot(sum) < 0.0 { -n } else { n };
        sum += aligned;
        for k in 0..3 {
            columns[k] += n * n[k];
        }
    }
    // The eigenvector of the greatest eigenvalue, by repetition.
    let mut axis = sum.normalize_or(DVec3::Z);
    for _ in 0..16 {
        let turned = columns[0] * axis.x + columns[1] * axis.y + columns[2] * axis.z;
        axis = turned.normalize_or(axis);
    }
    axis
}
