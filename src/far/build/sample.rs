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
use super::count::{FOLLOWED, Marks, Seen, SurfaceSample, main_normal};
use super::shader_fit::{ShaderFit, fit_shader};
use super::shot::{NOWHERE, Shot, Target};
use super::touch::{POINTS, Touched, touched};
use crate::far::record::Shader;

/// Most visibility rays from random directions at a voxel that none reached yet.
pub(super) const MOST_VISIBILITY_RAYS: u32 = 16;
/// Most of them from where neighbours were seen: what one window lets a ray
/// through to lies side by side, and a random direction seldom finds the window.
pub(super) const MOST_FOLLOWED: u8 = 12;
/// A voxel that fewer rays were aimed at, none of which reached it, is not known to be hidden.
pub(super) const LEAST_TESTS: u8 = 8;
/// Probes that are aimed at each voxel before it is known how many cross it.
const FIRST_PROBES: u32 = 4;
/// Probes that are aimed at each voxel at the least, so that their directions are spread.
const LEAST_PROBES: u32 = 8;
/// How far beyond the point that it is aimed at a visibility ray is followed, voxels.
const AIM_WITHIN: f64 = 0.5;

/// What the rays of a node found.
#[derive(Debug)]
pub(super) struct Sampled {
    /// Voxels that are kept, those that were seen and those that were not tested, in the order of
    /// the grid, and what they show.
    pub(super) seen: Vec<(Seen, ShaderFit)>,
    /// Voxels that triangles touch.
    pub(super) touched: u32,
    /// Voxels of those kept that were not tested.
    pub(super) untested: u32,
    pub(super) rays: u32,
    pub(super) hits: u32,
}

/// How many rays a node gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rays {
    /// So many probes across each voxel that is seen, or aimed at it where few cross it.
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
        let own = self.own.numbers().map(|number| (number, corners(number)));
        let touched = touched(&self.grid, own, &mut chance);
        let mut slot = vec![NOWHERE; self.grid.len()];
        for (number, voxel) in touched.iter().enumerate() {
            // Fewer than 2^24 voxels in a grid.
            slot[voxel.number as usize] = number as u32;
        }
        let most_visibility_rays = match rays {
            Rays::PerVoxel(_) => most / 2,
            Rays::InAll(rays) => rays.min(most).div_ceil(2),
        };
        let mut rays_shot = self.find_visible(&touched, &slot, most_visibility_rays, &mut chance);
        let visibility_rays = rays_shot.shots.len();
        let aims = numbers(&rays_shot.is_seen);
        let left = most - visibility_rays as u32;
        let mut aimed = vec![0; touched.len()];
        let mut prober = Prober::new(self, &touched, &slot, &aims, &mut chance);
        match rays {
            Rays::PerVoxel(probes) => {
                let first = FIRST_PROBES.min(probes);
                let wanted = |_| first;
                prober.probe(wanted, left, &mut aimed, &mut rays_shot);
                let crossings =
                    self.crossings(&rays_shot.shots[visibility_rays..], &slot, touched.len());
                let shot = (rays_shot.shots.len() - visibility_rays) as u32;
                let wanted = |number: usize| {
                    let needed = (probes * first).div_ceil(crossings[number].max(1));
                    needed.clamp(LEAST_PROBES.min(probes), probes)
                };
                prober.probe(wanted, left - shot, &mut aimed, &mut rays_shot);
            }
            Rays::InAll(rays) => {
                let probes = left.min(rays.saturating_sub(visibility_rays as u32));
                prober.probe(|_| u32::MAX, probes, &mut aimed, &mut rays_shot);
            }
        }
        let VisibilityRays {
            shots,
            is_seen,
            tests,
            ..
        } = rays_shot;
        let mut kept = vec![NOWHERE; touched.len()];
        let mut seen: Vec<Seen> = Vec::new();
        let mut untested = 0;
        for (number, voxel) in touched.iter().enumerate() {
            let is_untested = !is_seen[number] && tests[number] < LEAST_TESTS;
            if !is_seen[number] && !is_untested {
                continue;
            }
            kept[number] = seen.len() as u32;
            // As opaque as the area in it is large, in its faces.
            let mut here = Seen::new(self.grid.place(voxel.number as usize), voxel.area.min(1.0));
            if is_untested {
                untested += 1;
                for (point, triangle) in voxel.points {
                    // From either side.
                    let triangle = triangle as usize;
                    let (point, normal) = (self.grid.world(point), plane(triangle));
                    let sides = [normal, -normal].map(|side| sample_at(triangle, point, side));
                    here.samples.extend(sides);
                }
            }
            seen.push(here);
        }
        let mut hits = 0;
        for shot in &shots {
            if shot.touched == NOWHERE {
                continue;
            }
            hits += 1;
            let point = self.grid.world(shot.from + shot.direction * shot.end);
            let sample = sample_at(shot.triangle as usize, point, -shot.direction);
            seen[kept[shot.touched as usize] as usize]
                .samples
                .push(sample);
        }
        let (fits, shaders): (Vec<ShaderFit>, Vec<Shader>) = seen
            .iter()
            .map(|seen| {
                let normal = main_normal(&seen.samples);
                let fit = fit_shader(&seen.samples, normal, self.shader_blend);
                (fit, fit.shader)
            })
            .unzip();
        let marks = Marks {
            slot: &slot,
            kept: &kept,
            aimed: &aimed,
        };
        let probes = &shots[visibility_rays..];
        self.count(probes, &marks, &shaders, &mut seen);
        Sampled {
            seen: seen.into_iter().zip(fits).collect(),
            touched: touched.len() as u32,
            untested,
            rays: shots.len() as u32,
            hits,
        }
    }

    /// Aims visibility rays at every voxel until one reaches something in it.
    fn find_visible<'s>(
        &self,
        touched: &[Touched],
        slot: &'s [u32],
        most: u32,
        chance: &mut Chance,
    ) -> VisibilityRays<'s> {
        let starts: Vec<Directions> = touched.iter().map(|_| Directions::new(chance)).collect();
        let mut rays = VisibilityRays {
            shots: Vec::new(),
            most: most as usize,
            slot,
            is_seen: vec![false; touched.len()],
            tests: vec![0; touched.len()],
            followed: vec![0; touched.len()],
            fresh: VecDeque::new(),
        };
        for turn in 0..MOST_VISIBILITY_RAYS {
            for (number, (voxel, directions)) in touched.iter().zip(&starts).enumerate() {
                if !rays.is_seen[number] {
                    let (point, _) = voxel.points[turn as usize % POINTS];
                    rays.shoot(self, number, point, directions.at(turn));
                }
            }
            self.follow(touched, &mut rays);
        }
        rays
    }

    /// Aims at the neighbours of voxels that were just seen, along the same directions, until no
    /// more are found.
    fn follow(&self, touched: &[Touched], rays: &mut VisibilityRays<'_>) {
        while let Some((number, direction)) = rays.fresh.pop_front() {
            let grid_number = touched[number as usize].number as usize;
            for neighbour in self.grid.neighbours(grid_number) {
                let number = rays.slot[neighbour] as usize;
                if number == NOWHERE as usize || rays.is_seen[number] {
                    continue;
                }
                let followed = &mut rays.followed[number];
                if *followed < MOST_FOLLOWED {
                    let (point, _) = touched[number].points[usize::from(*followed) % POINTS];
                    *followed += 1;
                    rays.shoot(self, number, point, direction);
                }
            }
        }
    }

    /// How many of some probes reach each touched voxel.
    fn crossings(&self, probes: &[Shot], slot: &[u32], touched: usize) -> Vec<u32> {
        let mut crossings = vec![0; touched];
        for shot in probes {
            self.grid.along(shot.from, shot.direction, |number, leave| {
                let touched = slot[number];
                if touched != NOWHERE && (leave <= shot.end || touched == shot.touched) {
                    crossings[touched as usize] += 1;
                }
            });
        }
        crossings
    }
}

/// Aims probes at the voxels that were seen, in turn.
struct Prober<'p> {
    target: &'p Target<'p>,
    touched: &'p [Touched],
    slot: &'p [u32],
    aims: &'p [u32],
    directions: Vec<Directions>,
    chance: &'p mut Chance,
    /// How far a probe is followed behind where it enters: beyond the grid as far as it matters.
    beyond: f64,
}

impl<'p> Prober<'p> {
    fn new(
        target: &'p Target<'p>,
        touched: &'p [Touched],
        slot: &'p [u32],
        aims: &'p [u32],
        chance: &'p mut Chance,
    ) -> Self {
        let cells = DVec3::from_array(target.grid.cells.map(f64::from));
        Self {
            target,
            touched,
            slot,
            aims,
            directions: aims.iter().map(|_| Directions::new(chance)).collect(),
            chance,
            beyond: cells.length() + FOLLOWED,
        }
    }

    /// Probes each voxel until it has as many probes as are wanted, or there were `most` in all.
    fn probe(
        &mut self,
        wanted: impl Fn(usize) -> u32,
        most: u32,
        aimed: &mut [u32],
        found: &mut VisibilityRays<'_>,
    ) {
        let mut left = most;
        let mut is_done = self.aims.is_empty();
        while !is_done {
            is_done = true;
            for (&aim, directions) in self.aims.iter().zip(&self.directions) {
                let aim = aim as usize;
                if aimed[aim] >= wanted(aim) {
                    continue;
                }
                if left == 0 {
                    return;
                }
                left -= 1;
                is_done = false;
                let direction = directions.at(aimed[aim]);
                aimed[aim] += 1;
                let place = self.target.grid.place(self.touched[aim].number as usize);
                let point = entry(place, direction, self.chance);
                let shot = self.target.shoot(point, direction, self.beyond, self.slot);
                if shot.touched != NOWHERE {
                    found.is_seen[shot.touched as usize] = true;
                }
                found.shots.push(shot);
            }
        }
    }
}

/// The rays of a node, as they are shot. Voxels are numbered as they are touched.
struct VisibilityRays<'s> {
    shots: Vec<Shot>,
    /// How many visibility rays there may be.
    most: usize,
    /// Numbers of the grid's voxels.
    slot: &'s [u32],
    /// Whether a ray ended in each.
    is_seen: Vec<bool>,
    /// How many rays were aimed at what is in each, 255 at most.
    tests: Vec<u8>,
    /// How many of them were from where a neighbour was seen.
    followed: Vec<u8>,
    /// Voxels that were just seen, and along which direction.
    fresh: VecDeque<(u32, DVec3)>,
}

impl VisibilityRays<'_> {
    /// Aims a ray at a point of a voxel along a direction, unless there were enough rays.
    fn shoot(&mut self, target: &Target<'_>, number: usize, point: DVec3, direction: DVec3) {
        if self.shots.len() >= self.most {
            return;
        }
        self.tests[number] = self.tests[number].saturating_add(1);
        let shot = target.shoot(point, direction, AIM_WITHIN, self.slot);
        if shot.touched != NOWHERE
            && !std::mem::replace(&mut self.is_seen[shot.touched as usize], true)
        {
            self.fresh.push_back((shot.touched, direction));
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
