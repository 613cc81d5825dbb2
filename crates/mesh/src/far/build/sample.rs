//! Visibility rays and probes at a node (`spec/far.md`).

use std::io;

use glam::DVec3;

use super::count::{FOLLOWED, Groups, Layer, Probes, Seen, main_normal};
use super::ordered::Ordered;
use super::shader_fit::{ShaderFit, fit_shader};
use super::shot::{Aim, NOWHERE, Shot, Target};
use super::touch::{POINTS, Touched, touched};
use crate::geometry::point;
use shiftvox::split_mix::SplitMix;

pub(super) const MOST_VISIBILITY_RAYS: u32 = 16;
/// Most of them from where neighbours were seen: what a window lets through lies side by side.
pub(super) const MOST_FOLLOWED: u8 = 12;
/// With fewer rays, none of which reached it, a voxel is not known to be hidden.
pub(super) const LEAST_TESTS: u8 = 8;
const BATCHES: usize = 4;
const FIRST_PROBES: u32 = 4;
const LEAST_PROBES: u32 = 8;
const AIM_WITHIN: f64 = 0.5;

pub(super) struct Sampled {
    pub(super) touched: u32,
    pub(super) untested: u32,
    pub(super) rays: u32,
    pub(super) hits: u32,
}

/// The number of rays of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rays {
    /// So many probes across each seen voxel, or aimed at it where few cross it.
    PerVoxel(u32),
    /// So many in all, of which at most half are visibility rays.
    InAll(u32),
}

impl Target<'_> {
    /// Shoots at most `most` rays. `admit` gets the number of touched voxels, and waits for memory. `keep` gets each kept
    /// voxel, in the order of the grid, with its shader and its number of samples.
    pub(super) fn sample<A>(
        &self,
        rays: Rays,
        most: u32,
        seed: u64,
        triangles: &Ordered<'_>,
        admit: impl FnOnce(usize) -> A,
        mut keep: impl FnMut(&Seen, &ShaderFit, usize),
    ) -> io::Result<Sampled> {
        let seed = seed.wrapping_mul(0xd134_2543_de82_ef95) ^ 0x9e37_79b9_7f4a_7c15;
        let mut chance = SplitMix::new(seed);
        let own = self.own.clone().filter(|&number| self.has(number));
        let own = own.map(|number| (number, triangles.corners(number)));
        let touched = touched(&self.grid, own, &mut chance);
        let _admitted = admit(touched.len());
        let mut slot = vec![NOWHERE; self.grid.len()];
        for (number, voxel) in touched.iter().enumerate() {
            slot[voxel.number as usize] = number as u32;
        }
        let most_visibility_rays = match rays {
            Rays::PerVoxel(_) => most / 2,
            Rays::InAll(rays) => rays.min(most).div_ceil(2),
        };
        let mut found = Found {
            touched: &touched,
            slot: &slot,
            shots: Vec::new(),
            most: most_visibility_rays as usize,
            is_seen: vec![false; touched.len()],
            tests: vec![0; touched.len()],
            followed: vec![0; touched.len()],
        };
        found.find_visible(self, &mut chance)?;
        let first_probe = found.shots.len();
        let aimed = found.probe(self, rays, most, &mut chance)?;
        Ok(self.fit(&found, first_probe, &aimed, triangles, &mut keep))
    }

    /// `found`: all rays, of which the first are no probes. `aimed`: the number of probes by touched voxel.
    fn fit(
        &self,
        found: &Found<'_>,
        first_probe: usize,
        aimed: &[u32],
        triangles: &Ordered<'_>,
        keep: &mut dyn FnMut(&Seen, &ShaderFit, usize),
    ) -> Sampled {
        let Found { touched, shots, .. } = found;
        let is_seen = |number: usize| found.is_seen[number];
        let is_untested = |number: usize| !is_seen(number) && found.tests[number] < LEAST_TESTS;
        let mut kept = vec![NOWHERE; touched.len()];
        let mut aimed_of_grid = vec![0u8; self.grid.len()];
        let mut count = 0;
        for (number, voxel) in touched.iter().enumerate() {
            if is_seen(number) || is_untested(number) {
                kept[number] = count as u32;
                count += 1;
                let probes = aimed[number].min(u32::from(u8::MAX) - 1) as u8;
                aimed_of_grid[voxel.number as usize] = probes + 1;
            }
        }
        let slot_and_kept = [found.slot, &kept];
        let probes = &shots[first_probe..];
        let probes = Probes::new(self, probes, slot_and_kept, &aimed_of_grid, count);
        let ends = (0u32..).zip(shots);
        let ends = ends.filter(|(_, shot)| shot.touched != NOWHERE);
        let ends = ends.map(|(number, shot)| (kept[shot.touched as usize], number));
        let ends: Vec<(u32, u32)> = ends.collect();
        let hits = ends.len() as u32;
        let ends = Groups::new(count, &ends);
        // Rays end all over a voxel, and so each sees less than the whole of it.
        let width = self.grid.voxel / 2.0;
        let mut untested = 0;
        let mut samples = Vec::new();
        for (number, voxel) in touched.iter().enumerate() {
            let place = kept[number] as usize;
            if place == NOWHERE as usize {
                continue;
            }
            samples.clear();
            if is_untested(number) {
                untested += 1;
                for (point, triangle) in voxel.points {
                    let triangle = triangle as usize;
                    let (point, normal) = (self.grid.world(point), triangles.plane(triangle));
                    let sides = [normal, -normal];
                    let sides = sides.map(|side| triangles.sample(triangle, point, side, width));
                    samples.extend(sides);
                }
            }
            samples.extend(ends.of(place).iter().map(|&shot| {
                let shot = &shots[shot as usize];
                let point = self.grid.world(shot.end_point());
                let towards_eye = -shot.direction.as_dvec3();
                triangles.sample(shot.triangle as usize, point, towards_eye, width)
            }));
            let fit = fit_shader(&samples, main_normal(&samples));
            let layer = Layer::of(ends.of(place).iter().map(|&shot| {
                let shot = &shots[shot as usize];
                let normal = triangles.plane(shot.triangle as usize);
                let is_behind = normal.dot(shot.direction.as_dvec3()) > 0.0;
                (shot.end_point(), if is_behind { -normal } else { normal })
            }));
            let mut seen = Seen {
                place: self.grid.place(voxel.number as usize),
                unseen_opacity: voxel.area.min(1.0),
                ..Seen::default()
            };
            probes.count(number as u32, place, &fit.shader, &layer, &mut seen);
            keep(&seen, &fit, samples.len());
        }
        Sampled {
            touched: touched.len() as u32,
            untested,
            rays: shots.len() as u32,
            hits,
        }
    }

    fn crossings(&self, probes: &[Shot], slot: &[u32], touched: usize) -> Vec<u32> {
        let mut crossings = vec![0; touched];
        for shot in probes {
            let end = f64::from(shot.end);
            let (from, direction) = (shot.point.as_dvec3(), shot.direction.as_dvec3());
            self.grid.along(from, direction, |number, leave| {
                let touched = slot[number];
                let is_before = leave <= end;
                if touched != NOWHERE && (is_before || touched == shot.touched) {
                    crossings[touched as usize] += 1;
                }
                is_before
            });
        }
        crossings
    }
}

/// Voxels are numbered as they are touched.
struct Found<'s> {
    touched: &'s [Touched],
    slot: &'s [u32],
    shots: Vec<Shot>,
    most: usize,
    is_seen: Vec<bool>,
    tests: Vec<u8>,
    followed: Vec<u8>,
}

type Look = (u32, Aim);

impl Found<'_> {
    fn find_visible(&mut self, target: &Target<'_>, chance: &mut SplitMix) -> io::Result<()> {
        let touched = self.touched;
        let starts: Vec<Directions> = touched.iter().map(|_| Directions::new(chance)).collect();
        for turn in 0..MOST_VISIBILITY_RAYS {
            for batch in 0..BATCHES {
                let mut looks: Vec<Look> = Vec::new();
                for number in (batch..touched.len()).step_by(BATCHES) {
                    if !self.is_seen[number] {
                        let (point, _) = touched[number].points[turn as usize % POINTS];
                        let aim = Aim {
                            point: point.as_vec3(),
                            direction: starts[number].at(turn).as_vec3(),
                        };
                        looks.push((number as u32, aim));
                    }
                }
                let fresh = self.look(target, looks)?;
                self.follow(target, fresh)?;
            }
        }
        Ok(())
    }

    /// Shoots probes, together with the rays before at most `most`. Returns their number by touched voxel.
    fn probe(
        &mut self,
        target: &Target<'_>,
        rays: Rays,
        most: u32,
        chance: &mut SplitMix,
    ) -> io::Result<Vec<u32>> {
        let begin = self.shots.len();
        let aims = (0..self.touched.len() as u32).filter(|&number| self.is_seen[number as usize]);
        let aims = aims.map(|aim| (aim, Directions::new(chance)));
        let aims: Vec<(u32, Directions)> = aims.collect();
        let left = most - begin as u32;
        let mut aimed = vec![0; self.touched.len()];
        let mut shoot = |wanted: &dyn Fn(usize) -> u32, most, found: &mut Self| {
            found.shoot_at(&aims, wanted, most, &mut aimed, target, chance)
        };
        match rays {
            Rays::PerVoxel(probes) => {
                let first = FIRST_PROBES.min(probes);
                shoot(&|_| first, left, self)?;
                let probed = &self.shots[begin..];
                let crossings = target.crossings(probed, self.slot, self.touched.len());
                let shot = probed.len() as u32;
                let wanted = |number: usize| {
                    let needed = (probes * first).div_ceil(crossings[number].max(1));
                    needed.clamp(LEAST_PROBES.min(probes), probes)
                };
                shoot(&wanted, left - shot, self)?;
            }
            Rays::InAll(rays) => {
                let probes = left.min(rays.saturating_sub(begin as u32));
                shoot(&|_| u32::MAX, probes, self)?;
            }
        }
        Ok(aimed)
    }

    /// Shoots at most `most` probes, at each voxel until so many are aimed at it as are wanted.
    fn shoot_at(
        &mut self,
        aims: &[(u32, Directions)],
        wanted: &dyn Fn(usize) -> u32,
        most: u32,
        aimed: &mut [u32],
        target: &Target<'_>,
        chance: &mut SplitMix,
    ) -> io::Result<()> {
        let mut rays = Vec::new();
        let mut is_done = aims.is_empty();
        'turns: while !is_done {
            is_done = true;
            for (aim, directions) in aims {
                let aim = *aim as usize;
                if aimed[aim] >= wanted(aim) {
                    continue;
                }
                if rays.len() >= most as usize {
                    break 'turns;
                }
                is_done = false;
                let direction = directions.at(aimed[aim]);
                aimed[aim] += 1;
                let place = target.grid.place(self.touched[aim].number as usize);
                rays.push(Aim {
                    point: entry(place, direction, chance).as_vec3(),
                    direction: direction.as_vec3(),
                });
            }
        }
        let begin = self.shots.len();
        let beyond = point(target.grid.cells).length() + FOLLOWED;
        target.shoot(&rays, beyond, self.slot, &mut self.shots)?;
        for shot in &self.shots[begin..] {
            if shot.touched != NOWHERE {
                self.is_seen[shot.touched as usize] = true;
            }
        }
        Ok(())
    }

    /// Returns the voxels newly seen, and along which direction.
    fn look(&mut self, target: &Target<'_>, mut looks: Vec<Look>) -> io::Result<Vec<Look>> {
        looks.truncate(self.most - self.shots.len());
        for (number, _) in &looks {
            let tests = &mut self.tests[*number as usize];
            *tests = tests.saturating_add(1);
        }
        let begin = self.shots.len();
        let aims: Vec<Aim> = looks.iter().map(|(_, aim)| *aim).collect();
        target.shoot(&aims, AIM_WITHIN, self.slot, &mut self.shots)?;
        let mut fresh = Vec::new();
        for (shot, aim) in self.shots[begin..].iter().zip(aims) {
            if shot.touched != NOWHERE
                && !std::mem::replace(&mut self.is_seen[shot.touched as usize], true)
            {
                fresh.push((shot.touched, aim));
            }
        }
        Ok(fresh)
    }

    /// Aims at neighbours of voxels that were just seen, along the same directions.
    fn follow(&mut self, target: &Target<'_>, mut fresh: Vec<Look>) -> io::Result<()> {
        let mut waiting: Vec<Look> = Vec::new();
        if fresh.is_empty() {
            return Ok(());
        }
        let mut batch_of = vec![u32::MAX; self.touched.len()];
        let mut batch = 0;
        while !fresh.is_empty() || !waiting.is_empty() {
            for (number, aim) in fresh {
                let of_grid = self.touched[number as usize].number as usize;
                for neighbour in target.grid.neighbours(of_grid) {
                    let number = self.slot[neighbour];
                    if number != NOWHERE && !self.is_seen[number as usize] {
                        waiting.push((number, aim));
                    }
                }
            }
            let mut looks: Vec<Look> = Vec::new();
            waiting.retain(|&(number, aim)| {
                let place = number as usize;
                let followed = &mut self.followed[place];
                if self.is_seen[place] || *followed >= MOST_FOLLOWED {
                    return false;
                }
                if std::mem::replace(&mut batch_of[place], batch) == batch {
                    return true;
                }
                let (point, _) = self.touched[place].points[usize::from(*followed) % POINTS];
                *followed += 1;
                let point = point.as_vec3();
                looks.push((number, Aim { point, ..aim }));
                false
            });
            fresh = self.look(target, looks)?;
            batch += 1;
        }
        Ok(())
    }
}

/// Spread by the sequence R2.
struct Directions([f64; 2]);

impl Directions {
    fn new(chance: &mut SplitMix) -> Self {
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

/// A random point where a ray of a direction enters a voxel.
fn entry(place: [u8; 3], direction: DVec3, chance: &mut SplitMix) -> DVec3 {
    let faces = direction.abs();
    let mut pick = chance.unit() * faces.element_sum();
    let mut axis = 0;
    while axis < 2 && pick >= faces[axis] {
        pick -= faces[axis];
        axis += 1;
    }
    let mut point = DVec3::new(chance.unit(), chance.unit(), chance.unit());
    point[axis] = if direction[axis] < 0.0 { 1.0 } else { 0.0 };
    point + self::point(place)
}
