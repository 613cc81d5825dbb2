//! Rays at a node: which of its voxels are seen, and what of them.
//!
//! First *visibility rays* are aimed at points of what is in each voxel, from random
//! directions and from those from which a neighbour was seen, until one gets
//! there: a voxel that none reaches is dropped.
//! Then *probes* are aimed at random points of the outlines of the voxels that
//! were seen, from random directions: what share of them ends in a voxel is
//! its opacity (`count.rs`).

use std::collections::VecDeque;

use glam::DVec3;

use super::chance::Chance;
use super::count::{Counted, Seen, SurfaceSample};
use super::shot::{Shot, Target};
use super::touch::{POINTS, Touched, touched};

/// Most visibility rays from random directions at a voxel that none reached yet.
pub(super) const MOST_VISIBILITY_RAYS: u32 = 24;
/// Most of them from where neighbours were seen: what one window lets a ray
/// through to lies side by side, and a random direction seldom finds the window.
pub(super) const MOST_FOLLOWED: u8 = 24;

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

/// How many rays a node gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rays {
    /// So many probes for each voxel that is seen.
    PerVoxel(u32),
    /// So many in all, of which at most half are visibility rays.
    InAll(u32),
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

    /// Aims at the neighbours of voxels that were just seen, along the same directions, until no
    /// more are found.
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
