//! Hits and passes of probes, and solid parts (`spec/far.md`).

use glam::DVec3;

use super::shot::{Shot, Target};
use crate::far::blend::{DIRECTIONS, Fit, Shares, by_cosines};
use crate::far::record::{STEEPNESSES, Shader, steepness};

/// How far probes are followed behind the grid, voxels.
pub(super) const FOLLOWED: f64 = 9.0;
/// Voxels between the ends in a voxel and the planes of its layer.
const LAYER_MARGIN: f64 = 0.25;
/// The least length of the mean of a sheet's normals.
const SHEET: f64 = 0.95;

#[derive(Debug, Clone, Copy)]
pub(super) struct SurfaceSample {
    pub(super) towards_eye: DVec3,
    pub(super) normal: DVec3,
    pub(super) color: DVec3,
}

#[derive(Debug, Clone, Default)]
pub(super) struct Seen {
    pub(super) place: [u8; 3],
    /// From its triangles, where no ray crosses it.
    pub(super) unseen_opacity: f64,
    pub(super) crossings: u32,
    /// By side of the surface and by steepness.
    pub(super) found: [[Found; STEEPNESSES]; 2],
}

impl Seen {
    pub(super) fn counted_below(&self, side: usize, steepness: usize) -> Counted {
        let found = self.found[side][..steepness].iter();
        found.fold(Counted::default(), |all, found| all.with(&found.counted))
    }
}

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Found {
    pub(super) counted: Counted,
    /// Number, weights of those that end in the voxel or its layer, and of the others.
    pub(super) probes: u32,
    pub(super) stopped: f64,
    pub(super) passed: f64,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Counted {
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
    pub(super) fn add(&mut self, shares: &Shares, is_hit: bool, weight: f64) {
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

    pub(super) fn scalar(&self) -> f64 {
        match self.weight > 0.0 {
            true => (self.hits / self.weight).min(1.0),
            false => 1.0,
        }
    }

    /// Drawn to the scalar with the weight of a ray.
    pub(super) fn six(&self) -> [f64; DIRECTIONS] {
        let pull = self.weight / self.independent().max(1.0);
        if self.weight <= 0.0 {
            return [1.0; DIRECTIONS];
        }
        let scalar = self.scalar();
        let six = self.by_direction.solve(&[scalar], pull, (0.0, 1.0));
        six.map(|v| v[0])
    }

    pub(super) fn independent(&self) -> f64 {
        match self.square_weight > 0.0 {
            true => self.weight * self.weight / self.square_weight,
            false => 0.0,
        }
    }

    /// Mean square, over the directions, of how far the blend of six opacities is from a number.
    pub(super) fn square_from(&self, six: &[f64; DIRECTIONS], number: f64) -> f64 {
        if self.weight <= 0.0 {
            return 0.0;
        }
        self.by_direction.square_of(&six.map(|a| a - number)) / self.weight
    }
}

/// All places between two planes around the ends of the rays in a voxel. Without ends it is empty.
pub(super) struct Layer {
    normal: DVec3,
    low: f64,
    high: f64,
}

impl Layer {
    /// Of ends, and of the normals there of the triangles' planes, on the side of the rays' origins. Their sum is normal
    /// to a rough surface, too. Those of a sheet that is seen from both sides cancel out, unless they are turned to agree.
    pub(super) fn of(ends: impl Iterator<Item = (DVec3, DVec3)> + Clone) -> Self {
        let (mut sum, mut agreeing, mut count) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for (_, normal) in ends.clone() {
            sum += normal;
            agreeing += if normal.dot(agreeing) < 0.0 {
                -normal
            } else {
                normal
            };
            count += 1.0;
        }
        let is_sheet = agreeing.length() > SHEET * count;
        let normal = if is_sheet { agreeing } else { sum };
        let normal = normal.normalize_or(DVec3::Z);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (end, _) in ends {
            let at = normal.dot(end);
            (low, high) = (low.min(at), high.max(at));
        }
        Self { normal, low, high }
    }

    /// Whether a ray ends before it has left the layer. False of one without an end: such numbers compare as false.
    fn stops(&self, shot: &Shot) -> bool {
        let at = self.normal.dot(shot.end_point());
        match self.normal.dot(shot.direction.as_dvec3()) < 0.0 {
            true => at > self.low - LAYER_MARGIN,
            false => at < self.high + LAYER_MARGIN,
        }
    }
}

pub(super) struct Probes<'p> {
    target: &'p Target<'p>,
    shots: &'p [Shot],
    weights: Vec<f32>,
    crossings: Groups<u32>,
}

impl<'p> Probes<'p> {
    /// By voxel of the grid: `slot`, its number if it is touched, and `aimed`, 0 if it is not kept, else one more than the
    /// probes aimed at it. By touched voxel: `kept`, its number among the `count` kept ones.
    pub(super) fn new(
        target: &'p Target<'p>,
        shots: &'p [Shot],
        [slot, kept]: [&[u32]; 2],
        aimed: &[u8],
        count: usize,
    ) -> Self {
        let mut weights = Vec::with_capacity(shots.len());
        let mut all = Vec::new();
        for (probe, shot) in (0u32..).zip(shots) {
            // One way through the grid: also what lies behind the end is aimed at.
            let mut aims = 0u32;
            let mut is_over = false;
            let end = f64::from(shot.end);
            let (from, direction) = (shot.point.as_dvec3(), shot.direction.as_dvec3());
            let is_passed = target.leaves_out(shot.triangle);
            target.grid.along(from, direction, |number, leave| {
                let aimed = aimed[number];
                if aimed > 0 {
                    aims += u32::from(aimed - 1);
                    let touched = slot[number];
                    let is_end = touched == shot.touched;
                    if !is_over && (is_end || is_passed || leave <= end) {
                        all.push((kept[touched as usize], probe));
                    }
                    is_over |= is_end || leave > end;
                }
                true
            });
            weights.push(1.0 / aims.max(1) as f32);
        }
        Self {
            target,
            shots,
            weights,
            crossings: Groups::new(count, &all),
        }
    }

    /// `touched`: the voxel's number among touched ones.
    pub(super) fn count(
        &self,
        touched: u32,
        place: usize,
        shader: &Shader,
        layer: &Layer,
        seen: &mut Seen,
    ) {
        for &probe in self.crossings.of(place) {
            let shot = &self.shots[probe as usize];
            let is_hit = shot.touched == touched;
            let is_in_layer = !self.target.leaves_out(shot.triangle) && layer.stops(shot);
            let towards_eye = -shot.direction.as_dvec3();
            let weight = f64::from(self.weights[probe as usize]);
            let signed = shader.cosine(towards_eye);
            seen.crossings += 1;
            let found = &mut seen.found[usize::from(signed < 0.0)][steepness(signed.abs())];
            found.probes += 1;
            match is_hit || is_in_layer {
                true => found.stopped += weight,
                false => found.passed += weight,
            }
            found.counted.add(&by_cosines(towards_eye), is_hit, weight);
        }
    }
}

pub(super) struct Groups<T> {
    items: Vec<T>,
    ends: Vec<u32>,
}

impl<T: Copy> Groups<T> {
    pub(super) fn new(groups: usize, all: &[(u32, T)]) -> Self {
        let mut ends = vec![0u32; groups];
        for (group, _) in all {
            ends[*group as usize] += 1;
        }
        let mut sum = 0;
        for end in &mut ends {
            sum += std::mem::replace(end, sum);
        }
        let mut items: Vec<T> = all.iter().map(|&(_, item)| item).collect();
        for &(group, item) in all {
            let place = &mut ends[group as usize];
            items[*place as usize] = item;
            *place += 1;
        }
        Self { items, ends }
    }

    pub(super) fn of(&self, group: usize) -> &[T] {
        let begin = group.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.items[begin as usize..self.ends[group] as usize]
    }
}

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
