//! A voxel's shader and opacity, fitted to what rays saw of it.

use glam::DVec3;

use super::count::{Counted, Found, Seen, SurfaceSample};
use crate::far::blend::{DIRECTIONS, Fit, by_squares};
use crate::far::record::{Opacity, STEEPNESSES, Shader, SideOpacity, Voxel};

/// Beside a colour's error: both are 0 to 1.
const NORMAL_WEIGHT: f64 = 0.25;
const GOOD_ENOUGH: f64 = 5e-4;
/// For a complex shader, which takes three times as many bytes.
const WORTH_IT: f64 = 0.7;
const LEAST_SAMPLES: usize = 6;
const OPAQUE_FROM: f64 = 0.97;
/// Six opacities within this share of one number are stored as that.
const ALIKE_WITHIN: f64 = 0.1;
/// Chance alone improves six numbers over one by so many binomial variances over the number of rays.
const NOISE: f64 = 5.0;
/// Added hits and passes, so that a few rays which all hit do not prove that all would.
const DOUBT: f64 = 0.5;

/// A side is solid where at most this share of its probes leaves the layer, if there are so many ([`solid_from`]).
const MOST_PASSED: f64 = 0.05;
const LEAST_PROBES: u32 = 4;
/// A back of a body that only grazing probes reach lets more of them pass.
const MOST_GRAZING_PASSED: f64 = 0.85;

#[derive(Debug, Clone, Copy)]
pub(super) struct ShaderFit {
    pub(super) shader: Shader,
    pub(super) square_error: f64,
}

pub(super) fn fit_shader(samples: &[SurfaceSample], normal: DVec3) -> ShaderFit {
    let fit = |shader| ShaderFit {
        square_error: error(&shader, samples),
        shader,
    };
    let count = samples.len().max(1) as f64;
    let flat = fit(flat(samples, normal));
    if flat.square_error > GOOD_ENOUGH * count && samples.len() >= LEAST_SAMPLES {
        let complex = fit(complex(samples));
        if complex.square_error < WORTH_IT * flat.square_error {
            return complex;
        }
    }
    flat
}

/// The steepness from which on a side is solid; all of a side that nothing looks upon, as it is hidden. Chance gives some
/// sides of a sheet few probes that are not grazing. So the other side's count too, where it lets none pass either. If all
/// of both sides are stopped, and some of the grazing ones, fewer are enough.
fn solid_from(side: &[Found; STEEPNESSES], other: &[Found; STEEPNESSES]) -> usize {
    let lets = |found: &Found, most: f64| found.passed > most * (found.passed + found.stopped);
    let lets_pass = |found: &Found| lets(found, MOST_PASSED);
    let (mut solid, mut own, mut both) = (STEEPNESSES, 0, 0);
    let mut counts_other = true;
    for (steepness, (found, other)) in side.iter().zip(other).enumerate().rev() {
        if lets_pass(found) {
            return solid;
        }
        counts_other &= !lets_pass(other);
        own += found.probes;
        both += found.probes + if counts_other { other.probes } else { 0 };
        let is_enough = match steepness {
            0 => own >= LEAST_PROBES,
            1 if counts_other && !lets(&side[0], MOST_GRAZING_PASSED) => both > 0,
            _ => own > 0 && both >= LEAST_PROBES,
        };
        if is_enough {
            solid = steepness;
        }
    }
    if own == 0 { 0 } else { solid }
}

pub(super) fn fit(seen: &Seen, shader: Shader, most: Opacity) -> Voxel {
    let opaque = Voxel {
        place: seen.place,
        shader,
        opacity: [1.0; DIRECTIONS],
        sides: [SideOpacity::OPAQUE; 2],
        stored: Opacity::None,
    };
    let is_crossed = seen.found.iter().flatten().any(|found| found.probes > 0);
    let sides = [0, 1].map(|side| {
        if !is_crossed {
            let counted = Counted::default();
            return (counted, STEEPNESSES, seen.unseen_opacity);
        }
        let solid = solid_from(&seen.found[side], &seen.found[1 - side]);
        let rest = seen.counted_below(side, solid);
        (rest, solid, rest.scalar())
    });
    let is_opaque = sides
        .iter()
        .all(|&(_, solid, scalar)| solid == 0 || scalar >= OPAQUE_FROM);
    if most == Opacity::None || is_opaque {
        return opaque;
    }
    let rest = sides[0].0.with(&sides[1].0);
    let rays = rest.independent();
    let (six, scalar) = (rest.six(), rest.scalar());
    let likely = (scalar * rays + DOUBT) / (rays + 2.0 * DOUBT);
    let noise = NOISE * likely * (1.0 - likely) / rays.max(1.0);
    let alike = (ALIKE_WITHIN * scalar).powi(2) + noise;
    let square: f64 = sides
        .iter()
        .map(|(rest, _, scalar)| rest.weight * rest.square_from(&six, *scalar))
        .sum();
    let is_alike = square <= alike * rest.weight;
    Voxel {
        stored: if is_alike { Opacity::Scalar } else { most },
        sides: sides.map(|(_, solid, scalar)| SideOpacity {
            scalar,
            solid_from: solid as u8,
        }),
        opacity: six,
        ..opaque
    }
}

fn flat(samples: &[SurfaceSample], normal: DVec3) -> Shader {
    let mut sums = [(DVec3::ZERO, 0.0); 2];
    for sample in samples {
        let side = usize::from(sample.towards_eye.dot(normal) < 0.0);
        sums[side].0 += sample.color;
        sums[side].1 += 1.0;
    }
    let colors = [0, 1].map(|side| {
        let is_seen = sums[side].1 > 0.0;
        let (sum, count) = sums[if is_seen { side } else { 1 - side }];
        sum / f64::max(count, 1.0)
    });
    Shader::Flat { normal, colors }
}

fn complex(samples: &[SurfaceSample]) -> Shader {
    let mut fit = Fit::<6>::new();
    let mut mean = [0.0; 6];
    for sample in samples {
        let (c, n) = (sample.color, sample.normal);
        let value = [c.x, c.y, c.z, n.x, n.y, n.z];
        fit.add(&by_squares(sample.towards_eye), &value, 1.0);
        for (mean, value) in mean.iter_mut().zip(value) {
            *mean += value / samples.len() as f64;
        }
    }
    let values = fit.solve(&mean, 0.5, (-1.0, 1.0));
    Shader::Complex {
        normals: std::array::from_fn(|k| {
            let [.., x, y, z] = values[k];
            let main = DVec3::AXES[k / 2] * [1.0, -1.0][k % 2];
            DVec3::new(x, y, z).normalize_or(main)
        }),
        colors: std::array::from_fn(|k| {
            let [r, g, b, ..] = values[k];
            DVec3::new(r, g, b).max(DVec3::ZERO)
        }),
    }
}

fn error(shader: &Shader, samples: &[SurfaceSample]) -> f64 {
    let error = |sample: &SurfaceSample| {
        let (normal, color) = shader.seen_from(sample.towards_eye);
        let of_color = (color - sample.color).length_squared() / 3.0;
        let of_normal = (1.0 - normal.dot(sample.normal)).max(0.0) / 2.0;
        of_color + NORMAL_WEIGHT * of_normal
    };
    samples.iter().map(error).sum()
}
