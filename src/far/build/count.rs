//! Hits and passes: how much of a voxel is there, seen from which direction.
//!
//! A probe *hits* the voxel where it ends at one of the node's own triangles,
//! and *passes* every kept voxel that it leaves before. A line through many
//! voxels that are aimed at is chosen more often than one through few; its
//! weight, one over their number, makes up for that, so that the lines through
//! a voxel are spread evenly, whatever is around it.
//!
//! A large object of which a voxel has but a corner goes on behind it: such a
//! pass is no evidence about the object, and does not count (Wagner et al. 2007, Fig. 3b).

use glam::DVec3;

use super::shot::{Shot, Target};
use crate::far::blend::{DIRECTIONS, Fit};

/// Least cosine between normals of one object.
const ONE_OBJECT: f64 = 0.9;
/// How far behind a voxel the same object must go on, voxels along the ray.
const GOES_ON: f64 = 16.0;

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

/// What probes found of a voxel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Counted {
    /// Probes that crossed it, whatever they met.
    pub(super) crossings: u32,
    /// Weight of hits and passes, of their squares, and of the hits.
    weight: f64,
    square_weight: f64,
    hits: f64,
    by_direction: Fit<1>,
}

impl Default for Counted {
    fn default() -> Self {
        Self {
            crossings: 0,
            weight: 0.0,
            square_weight: 0.0,
            hits: 0.0,
            by_direction: Fit::new(),
        }
    }
}

impl Counted {
    pub(super) fn add(&mut self, shares: &[(usize, f64); 3], is_hit: bool, weight: f64) {
        let value = f64::from(u8::from(is_hit));
        self.weight += weight;
        self.square_weight += weight * weight;
        self.hits += weight * value;
        self.by_direction.add(shares, &[value], weight);
    }

    /// Hits over hits and passes of all directions; 1 where there were none.
    pub(super) fn scalar(&self) -> f64 {
        if self.weight > 0.0 {
            (self.hits / self.weight).min(1.0)
        } else {
            1.0
        }
    }

    /// Opacity seen from each main direction: what makes the blend fit hits and
    /// passes best. A direction without rays is opaque.
    pub(super) fn six(&self) -> [f64; DIRECTIONS] {
        let pull = 0.05 * self.weight / self.independent().max(1.0);
        if self.weight <= 0.0 {
            return [1.0; DIRECTIONS];
        }
        let six = self.by_direction.solve(&[1.0], pull, (0.0, 1.0));
        six.map(|v| v[0])
    }

    /// How many probes of equal weight carry the same information.
    pub(super) fn independent(&self) -> f64 {
        if self.square_weight > 0.0 {
            self.weight * self.weight / self.square_weight
        } else {
            0.0
        }
    }

    /// Mean square, over the directions of hits and passes, of how far the
    /// blend of six opacities is from a number.
    pub(super) fn square_from(&self, six: &[f64; DIRECTIONS], number: f64) -> f64 {
        if self.weight <= 0.0 {
            return 0.0;
        }
        self.by_direction.square_of(&six.map(|a| a - number)) / self.weight
    }
}

impl Target<'_> {
    /// Counts probes. `slot` has the places in `seen` of the grid's voxels,
    /// `aims` the numbers of the voxels that probes were aimed at.
    pub(super) fn count(
        &self,
        shots: &[Shot],
        slot: &[u32],
        aims: &[u32],
        plane: impl Fn(usize) -> DVec3,
        seen: &mut [Seen],
    ) {
        let axes: Vec<DVec3> = seen.iter().map(|seen| main_normal(&seen.samples)).collect();
        let mut is_aim = vec![false; self.grid.len()];
        for &aim in aims {
            is_aim[aim as usize] = true;
        }
        for shot in shots {
            self.count_one(shot, slot, &is_aim, &axes, &plane, seen);
        }
    }

    fn count_one(
        &self,
        shot: &Shot,
        slot: &[u32],
        is_aim: &[bool],
        axes: &[DVec3],
        plane: &impl Fn(usize) -> DVec3,
        seen: &mut [Seen],
    ) {
        let end_place = self.end_of(shot);
        let shares = self.opacity_blend.shares(-shot.direction);
        let line = self.grid.along(shot.from, shot.direction);
        let aims = line
            .clone()
            .filter(|crossing| is_aim[self.grid.number(crossing.place)]);
        let weight = 1.0 / aims.count().max(1) as f64;
        let behind = (shot.triangle != usize::MAX).then(|| plane(shot.triangle));
        for crossing in line {
            let number = slot[self.grid.number(crossing.place)] as usize;
            let is_end = Some(crossing.place) == end_place;
            if !is_end && crossing.leave > shot.end {
                // Ends at a triangle of another node.
                return;
            }
            if let Some(seen) = seen.get_mut(number) {
                seen.counted.crossings += 1;
                let goes_on = !is_end
                    && shot.end - crossing.leave < GOES_ON
                    && behind.is_some_and(|normal| {
                        let place = DVec3::from_array(crossing.place.map(f64::from));
                        let middle = place + DVec3::splat(0.5);
                        let end = shot.from + shot.direction * shot.end;
                        let reach = 0.5 * normal.abs().element_sum();
                        normal.dot(axes[number]).abs() > ONE_OBJECT
                            && (middle - end).dot(normal).abs() <= reach
                    });
                if !goes_on {
                    seen.counted.add(&shares, is_end, weight);
                }
            }
            if is_end {
                return;
            }
        }
    }
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
