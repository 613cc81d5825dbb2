//! Hits and passes: how much of a voxel is there, seen from which direction.
//!
//! A probe *hits* the voxel where it ends at one of the node's own triangles,
//! and *passes* every kept voxel that it leaves before. A line through many
//! voxels that are aimed at is chosen more often than one through few; its
//! weight, one over the number of probes that are aimed at them, makes up for that, so that the
//! lines through a voxel are spread evenly, whatever is around it.
//!
//! A large object of which a voxel has but a corner goes on behind it: where everything that looks
//! upon a voxel's surface is stopped in it or right behind it, the voxel is opaque from there,
//! whatever passed it (Wagner et al. 2007, Fig. 3b). So probes are counted by how steeply they
//! look upon the surface.

use glam::DVec3;

use super::shot::{NOWHERE, Shot, Target};
use crate::far::blend::{DIRECTIONS, Fit};
use crate::far::record::{STEEPNESSES, Shader, steepness};

/// A probe is stopped right behind a voxel if what stops it is so near that the surface may be the
/// voxel's own: two voxels higher over the cosine, which a flat one is, and one for its curvature.
const RIGHT_BEHIND: [f64; 2] = [2.0, 1.0];
/// Cosines below this count as this: a grazing probe is followed no farther.
const LEAST_COSINE: f64 = 0.25;
/// How far behind a voxel it matters at most what a probe meets, voxels.
pub(super) const FOLLOWED: f64 = RIGHT_BEHIND[0] / LEAST_COSINE + RIGHT_BEHIND[1];

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

/// A voxel that is kept.
#[derive(Debug)]
pub(super) struct Seen {
    pub(super) place: [u8; 3],
    pub(super) samples: Vec<SurfaceSample>,
    /// Its opacity where no ray says anything of it: from its triangles.
    pub(super) unseen_opacity: f64,
    /// Probes that crossed it, whatever they met.
    pub(super) crossings: u32,
    /// What they found, from before its surface and from behind, by how steeply they looked upon it.
    pub(super) found: [[Found; STEEPNESSES]; 2],
}

impl Seen {
    pub(super) fn new(place: [u8; 3], unseen_opacity: f64) -> Self {
        Self {
            place,
            samples: Vec::new(),
            unseen_opacity,
            crossings: 0,
            found: Default::default(),
        }
    }

    /// What all probes of less than a steepness found, from one side.
    pub(super) fn counted_below(&self, side: usize, steepness: usize) -> Counted {
        let found = self.found[side][..steepness].iter();
        found.fold(Counted::default(), |all, found| all.with(&found.counted))
    }
}

/// What probes of one steepness found of a voxel.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Found {
    pub(super) counted: Counted,
    /// How many there were, and weights of those that were stopped in it or right behind it, and
    /// of the others.
    pub(super) probes: u32,
    pub(super) stopped: f64,
    pub(super) passed: f64,
}

/// Hits and passes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Counted {
    /// Weight of hits and passes, of their squares, and of the hits.
    pub(super) weight: f64,
    square_weight: f64,
    hits: f64,
    by_direction: Fit<1>,
}

impl Default for Counted {
    fn default() -> Self {
        Self {
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

    pub(super) fn with(mut self, other: &Self) -> Self {
        self.weight += other.weight;
        self.square_weight += other.square_weight;
        self.hits += other.hits;
        self.by_direction.merge(&other.by_direction);
        self
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
    /// passes best, drawn to the scalar with the weight of a ray.
    pub(super) fn six(&self) -> [f64; DIRECTIONS] {
        let pull = self.weight / self.independent().max(1.0);
        if self.weight <= 0.0 {
            return [1.0; DIRECTIONS];
        }
        let scalar = self.scalar();
        let six = self.by_direction.solve(&[scalar], pull, (0.0, 1.0));
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

/// What is known of a node's touched voxels, by their numbers.
pub(super) struct Marks<'m> {
    /// Numbers of touched voxels, of all voxels of the grid.
    pub(super) slot: &'m [u32],
    /// Places among the kept voxels.
    pub(super) kept: &'m [u32],
    /// How many probes were aimed at each.
    pub(super) aimed: &'m [u32],
}

impl Target<'_> {
    /// Counts probes.
    pub(super) fn count(
        &self,
        shots: &[Shot],
        marks: &Marks<'_>,
        shaders: &[Shader],
        seen: &mut [Seen],
    ) {
        let mut crossed = Vec::new();
        for shot in shots {
            // One way through the grid: what is crossed of what is kept.
            crossed.clear();
            let mut aims = 0u32;
            self.grid.along(shot.from, shot.direction, |number, leave| {
                let touched = marks.slot[number];
                if touched != NOWHERE {
                    aims += marks.aimed[touched as usize];
                    crossed.push((touched, leave));
                }
            });
            let weight = 1.0 / f64::from(aims.max(1));
            let shares = self.opacity_blend.shares(-shot.direction);
            for &(touched, leave) in &crossed {
                let is_end = touched == shot.touched;
                if !is_end && leave > shot.end {
                    // Ends at a triangle of another node.
                    break;
                }
                let kept = marks.kept[touched as usize];
                if kept != NOWHERE {
                    let shader = &shaders[kept as usize];
                    let seen = &mut seen[kept as usize];
                    let cosine = shader.cosine(-shot.direction, self.shader_blend);
                    let past = shot.end - leave;
                    seen.crossings += 1;
                    let side = usize::from(cosine < 0.0);
                    let cosine = cosine.abs();
                    let found = &mut seen.found[side][steepness(cosine)];
                    found.probes += 1;
                    let reach = RIGHT_BEHIND[0] / cosine.max(LEAST_COSINE) + RIGHT_BEHIND[1];
                    if is_end || past < reach {
                        found.stopped += weight;
                    } else {
                        found.passed += weight;
                    }
                    found.counted.add(&shares, is_end, weight);
                }
                if is_end {
                    break;
                }
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
