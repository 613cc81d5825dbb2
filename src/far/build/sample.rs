//! Rays at a node: which of its voxels are seen, what of them, and how many rays pass.
//!
//! A ray is aimed at a random point of the outline of a voxel, from a random
//! direction, and begins on the surface S, all points of which are `distance`
//! voxels from the grid. Everything between S and the voxel hides it. The first
//! half of the rays is aimed at all voxels that triangles touch, the second at
//! those that the first half saw. Every voxel that a ray crosses before its end
//! counts it.

use std::ops::Range;

use glam::DVec3;

use super::grid::Grid;
use super::rays::Occluders;
use crate::far::blend::{Blend, DIRECTIONS, Fit};

/// Steps of the search for S along a ray, each halving what is left.
const STEPS_TO_S: u32 = 24;
/// Least cosine between normals of one object.
const ONE_OBJECT: f64 = 0.9;
/// How far behind a voxel the same object must go on, voxels along the ray.
const GOES_ON: f64 = 1.8;

/// What a ray saw at its end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
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
    pub(super) looks: Vec<Look>,
    /// Rays that crossed it without an end in it, but for those that met the same object behind.
    pub(super) passes: u32,
    /// Rays that met the same object just behind it.
    pub(super) went_on: u32,
    opacity: Fit<1>,
}

impl Seen {
    /// Opacity seen from each main direction: what makes the blend fit hits and
    /// passes best; 1 where there were none.
    pub(super) fn opacity(&self) -> [f64; DIRECTIONS] {
        self.opacity.solve(&[1.0], 0.05, (0.0, 1.0)).map(|v| v[0])
    }

    /// Rays through it.
    pub(super) fn crossings(&self) -> u32 {
        self.looks.len() as u32 + self.passes + self.went_on
    }
}

/// What the rays of a node found.
#[derive(Debug)]
pub(super) struct Sampled {
    /// In the order of the grid.
    pub(super) seen: Vec<Seen>,
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

/// A ray that ended, in voxels of the grid.
struct Shot {
    from: DVec3,
    direction: DVec3,
    /// Where it ends along its direction; infinite where it meets nothing.
    end: f64,
    /// The triangle that it meets.
    triangle: usize,
}

/// Chance from a seed: SplitMix64.
pub(super) struct Chance(u64);

impl Chance {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0xd134_2543_de82_ef95) ^ 0x9e37_79b9_7f4a_7c15)
    }

    /// 0 to 1, without 1.
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

impl Target<'_> {
    /// Numbers of the voxels that the node's triangles touch, in order.
    pub(super) fn touched(&self, corners: impl Fn(usize) -> [DVec3; 3]) -> Vec<u32> {
        let mut is_touched = vec![false; self.grid.len()];
        for triangle in self.own.clone() {
            self.grid
                .touched(&corners(triangle), |number| is_touched[number] = true);
        }
        numbers(&is_touched)
    }

    /// Shoots so many rays. `look` says normal and colour of a triangle at a point.
    pub(super) fn sample(
        &self,
        touched: &[u32],
        rays: u32,
        seed: u64,
        look: impl Fn(usize, DVec3, DVec3) -> Look,
        plane: impl Fn(usize) -> DVec3,
    ) -> Sampled {
        let mut chance = Chance::new(seed);
        let mut is_seen = vec![false; self.grid.len()];
        let mut shots = Vec::with_capacity(rays as usize);
        let first = rays.div_ceil(2);
        self.shoot(touched, first, &mut chance, &mut shots, &mut is_seen);
        let visible = numbers(&is_seen);
        self.shoot(
            &visible,
            rays - first,
            &mut chance,
            &mut shots,
            &mut is_seen,
        );
        let mut slot = vec![u32::MAX; self.grid.len()];
        let mut seen: Vec<Seen> = Vec::new();
        for number in numbers(&is_seen) {
            slot[number as usize] = seen.len() as u32;
            seen.push(Seen {
                place: self.grid.place(number as usize),
                looks: Vec::new(),
                passes: 0,
                went_on: 0,
                opacity: Fit::new(),
            });
        }
        let slot_of = |place: [u8; 3]| slot[self.grid.number(place)] as usize;
        let mut hits = 0;
        for shot in &shots {
            let Some(place) = self.end_of(shot) else {
                continue;
            };
            hits += 1;
            let point = self.grid.world(shot.from + shot.direction * shot.end);
            let at = &mut seen[slot_of(place)];
            at.looks.push(look(shot.triangle, point, -shot.direction));
        }
        let axes: Vec<DVec3> = seen.iter().map(|seen| main_normal(&seen.looks)).collect();
        for shot in &shots {
            self.count(shot, &slot, &axes, &plane, &mut seen);
        }
        Sampled {
            seen,
            rays: shots.len() as u32,
            hits,
        }
    }

    /// The voxel in which a ray ends at one of the node's own triangles.
    fn end_of(&self, shot: &Shot) -> Option<[u8; 3]> {
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

    /// Counts a ray in the voxels that it crosses.
    fn count(
        &self,
        shot: &Shot,
        slot: &[u32],
        axes: &[DVec3],
        plane: &impl Fn(usize) -> DVec3,
        seen: &mut [Seen],
    ) {
        let end_place = self.end_of(shot);
        let shares = self.opacity_blend.shares(-shot.direction);
        for crossing in self.grid.along(shot.from, shot.direction) {
            let number = slot[self.grid.number(crossing.place)] as usize;
            if Some(crossing.place) == end_place {
                if let Some(seen) = seen.get_mut(number) {
                    seen.opacity.add(&shares, &[1.0]);
                }
                return;
            }
            if crossing.leave > shot.end {
                // Ends at a triangle of another node.
                return;
            }
            let Some(seen) = seen.get_mut(number) else {
                continue;
            };
            // A large object of which this voxel has a corner goes on behind it.
            let goes_on = shot.end - crossing.leave < GOES_ON && {
                let normal = plane(shot.triangle);
                let middle = DVec3::from_array(crossing.place.map(f64::from)) + DVec3::splat(0.5);
                let end = shot.from + shot.direction * shot.end;
                normal.dot(axes[number]).abs() > ONE_OBJECT
                    && (middle - end).dot(normal).abs() <= 0.5 * normal.abs().element_sum()
            };
            if goes_on {
                seen.went_on += 1;
            } else {
                seen.passes += 1;
                seen.opacity.add(&shares, &[0.0]);
            }
        }
    }

    fn shoot(
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
        // Directions of a voxel's rays are spread by the sequence R2, from a
        // start of its own.
        let starts: Vec<[f64; 2]> = voxels
            .iter()
            .map(|_| [chance.unit(), chance.unit()])
            .collect();
        for ray in 0..rays as usize {
            let aim = ray % voxels.len();
            let turn = (ray / voxels.len()) as f64;
            let [u, v] = starts[aim];
            let u = (u + turn * 0.754_877_666_246_692_8).fract();
            let v = (v + turn * 0.569_840_290_998_053_3).fract();
            let z = 1.0 - 2.0 * u;
            let ring = libm::sqrt((1.0 - z * z).max(0.0));
            let (sin, cos) = libm::sincos(v * std::f64::consts::TAU);
            let direction = DVec3::new(ring * cos, ring * sin, z);
            let point = entry(self.grid.place(voxels[aim] as usize), direction, chance);
            let from = point - direction * self.back_to_surface(point, direction);
            let origin = self.grid.world(from);
            let shot = match self.occluders.nearest(origin, direction) {
                None => Shot {
                    from,
                    direction,
                    end: f64::INFINITY,
                    triangle: usize::MAX,
                },
                Some(meeting) => Shot {
                    from,
                    direction,
                    end: meeting.distance / self.grid.voxel,
                    triangle: meeting.triangle,
                },
            };
            if let Some(place) = self.end_of(&shot) {
                is_seen[self.grid.number(place)] = true;
            }
            shots.push(shot);
        }
    }

    /// How far back from a point of the grid along a direction S is, voxels.
    fn back_to_surface(&self, point: DVec3, direction: DVec3) -> f64 {
        let cells = DVec3::from_array(self.grid.cells.map(f64::from));
        let (mut near, mut far) = (0.0, self.distance + cells.length());
        for _ in 0..STEPS_TO_S {
            let middle = (near + far) / 2.0;
            let at = point - direction * middle;
            let outside = (at - cells).max(-at).max(DVec3::ZERO).length();
            if outside <= self.distance {
                near = middle;
            } else {
                far = middle;
            }
        }
        near
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
pub(super) fn main_normal(looks: &[Look]) -> DVec3 {
    let mut columns = [DVec3::ZERO; 3];
    let mut sum = DVec3::ZERO;
    for look in looks {
        let n = look.normal;
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
