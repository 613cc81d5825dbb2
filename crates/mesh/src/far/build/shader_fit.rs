//! A voxel's shader and opacity, fitted to what rays saw of it.

use glam::DVec3;

use super::count::{Counted, Found, Seen, SurfaceSample};
use crate::far::blend::{DIRECTIONS, Fit, by_squares};
use crate::far::record::{Opacity, OpacityKind, STEEPNESSES, Shader, SideOpacity, Voxel};

/// Weight of a normal's error beside a colour's: both are 0 to 1.
const NORMAL_WEIGHT: f64 = 0.25;
/// Below this mean square error a flat shader is good enough.
const GOOD_ENOUGH: f64 = 5e-4;
/// A complex shader, three times as large, must be better by this factor.
const WORTH_IT: f64 = 0.7;
/// Fewer samples do not determine a complex shader.
const LEAST_SAMPLES: usize = 6;
/// A voxel is stored as opaque if its opacity, of all that does not look steeply upon something
/// solid, is this or more.
const OPAQUE_FROM: f64 = 0.97;
/// Six opacities are stored as one number if they are within this share of it.
const ALIKE_WITHIN: f64 = 0.1;
/// The improvement of six numbers over one that chance alone explains: this many binomial variances over the number of
/// rays (the mean of chi square with 5 degrees of freedom).
const NOISE: f64 = 5.0;
/// Hits and passes that are added before the variance is taken, so that a few
/// rays which all hit do not prove that all would.
const DOUBT: f64 = 0.5;

/// A voxel is solid seen at a steepness if no more than this share of what looks so upon it passes,
/// by weight, ...
const MOST_PASSED: f64 = 0.05;
/// ... and as many probes or more, at this steepness and above, were stopped.
const LEAST_STOPPED: u32 = 4;

/// A shader, and the sum over its samples of the square error.
#[derive(Debug, Clone, Copy)]
pub(super) struct ShaderFit {
    pub(super) shader: Shader,
    pub(super) square_error: f64,
}

/// Fits a shader to one or more samples. `normal` is the main one.
pub(super) fn fit_shader(samples: &[SurfaceSample], normal: DVec3) -> ShaderFit {
    let count = samples.len().max(1) as f64;
    let flat = flat(samples, normal);
    let square_error = error(&flat, samples);
    if square_error > GOOD_ENOUGH * count && samples.len() >= LEAST_SAMPLES {
        let complex = complex(samples);
        let complex_error = error(&complex, samples);
        if complex_error < WORTH_IT * square_error {
            return ShaderFit {
                shader: complex,
                square_error: complex_error,
            };
        }
    }
    ShaderFit {
        shader: flat,
        square_error,
    }
}

/// Fits the opacity of a voxel.
pub(super) fn fit(seen: &Seen, shader: Shader, use_of_opacity: Opacity) -> Voxel {
    let fitted = classify(seen, use_of_opacity);
    Voxel {
        place: seen.place,
        shader,
        opacity: fitted.six,
        sides: fitted.sides,
        opacity_kind: fitted.kind,
    }
}

/// An opacity, fitted.
struct FittedOpacity {
    kind: OpacityKind,
    sides: [SideOpacity; 2],
    six: [f64; DIRECTIONS],
}

/// The steepness from which on all that looks upon a side is stopped in the voxel or right behind.
/// A side that nothing looks upon is solid: it is hidden.
fn solid_from(side: &[Found; STEEPNESSES]) -> usize {
    let mut solid = STEEPNESSES;
    let mut probes = 0;
    for (steepness, found) in side.iter().enumerate().rev() {
        if found.passed > MOST_PASSED * (found.passed + found.stopped) {
            return solid;
        }
        probes += found.probes;
        if probes >= LEAST_STOPPED {
            solid = steepness;
        }
    }
    if probes == 0 { 0 } else { solid }
}

/// The smallest kind of opacity that agrees with what rays found, within tolerance and noise.
fn classify(seen: &Seen, most: Opacity) -> FittedOpacity {
    let opaque = FittedOpacity {
        kind: OpacityKind::Opaque,
        sides: [SideOpacity::OPAQUE; 2],
        six: [1.0; DIRECTIONS],
    };
    let is_crossed = seen.found.iter().flatten().any(|found| found.probes > 0);
    let sides = [0, 1].map(|side| {
        if !is_crossed {
            let counted = Counted::default();
            return (counted, STEEPNESSES, seen.unseen_opacity);
        }
        let solid = solid_from(&seen.found[side]);
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
    // As near as one number for each side, of either side.
    let square: f64 = sides
        .iter()
        .map(|(rest, _, scalar)| rest.weight * rest.square_from(&six, *scalar))
        .sum();
    let is_alike = square <= alike * rest.weight;
    FittedOpacity {
        kind: if most == Opacity::Scalar || is_alike {
            OpacityKind::Scalar
        } else {
            OpacityKind::Six
        },
        sides: sides.map(|(_, solid, scalar)| SideOpacity {
            scalar,
            solid_from: solid as u8,
        }),
        six,
    }
}

fn flat(samples: &[SurfaceSample], normal: DVec3) -> Shader {
    let mut sums = [(DVec3::ZERO, 0.0); 2];
    for sample in samples {
        let side = usize::from(sample.towards_eye.dot(normal) < 0.0);
        sums[side].0 += sample.color;
        sums[side].1 += 1.0;
    }
    // A side without samples gets the colours of the other.
    let colors = [0, 1].map(|side| {
        let (sum, count) = if sums[side].1 > 0.0 {
            sums[side]
        } else {
            sums[1 - side]
        };
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
            DVec3::new(x, y, z).normalize_or(main_direction(k))
        }),
        colors: std::array::from_fn(|k| {
            let [r, g, b, ..] = values[k];
            DVec3::new(r, g, b).max(DVec3::ZERO)
        }),
    }
}

fn main_direction(number: usize) -> DVec3 {
    let axis = [DVec3::X, DVec3::Y, DVec3::Z][number / 2];
    if number.is_multiple_of(2) {
        axis
    } else {
        -axis
    }
}

/// The sum of a shader's square errors over the samples.
fn error(shader: &Shader, samples: &[SurfaceSample]) -> f64 {
    samples
        .iter()
        .map(|sample| {
            let (normal, color) = shader.seen_from(sample.towards_eye);
            let of_color = (color - sample.color).length_squared() / 3.0;
            // Rounding must not make it negative.
            let of_normal = (1.0 - normal.dot(sample.normal)).max(0.0) / 2.0;
            of_color + NORMAL_WEIGHT * of_normal
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::far::blend::by_cosines;
    use crate::far::build::chance::Chance;
    use crate::far::build::count::main_normal;
    use crate::shared::directions;

    /// Samples from all sides of a surface whose normal and colour depend on the side.
    fn samples(of: impl Fn(DVec3) -> (DVec3, DVec3)) -> Vec<SurfaceSample> {
        let sample = |towards_eye| {
            let (normal, color) = of(towards_eye);
            SurfaceSample {
                towards_eye,
                normal,
                color,
            }
        };
        directions(500).map(sample).collect()
    }

    #[test]
    fn a_wall_with_two_colours_is_flat() {
        let up = DVec3::new(0.6, 0.0, 0.8);
        let wall = samples(|eye| match eye.dot(up) > 0.0 {
            true => (up, DVec3::X),
            false => (-up, DVec3::Y),
        });
        let shader = flat(&wall, main_normal(&wall));
        assert!(error(&shader, &wall) < 1e-9);
        let Shader::Flat { normal, colors } = shader else {
            panic!("not flat");
        };
        assert!(normal.dot(up).abs() > 1.0 - 1e-9);
        let front = usize::from(normal.dot(up) < 0.0);
        assert!((colors[front] - DVec3::X).length() < 1e-9);
    }

    #[test]
    fn a_ball_is_better_complex() {
        let ball = samples(|eye| (eye, DVec3::splat(0.5) + eye * 0.3));
        let of_flat = error(&flat(&ball, main_normal(&ball)), &ball);
        let of_complex = error(&complex(&ball), &ball);
        assert!(of_complex < WORTH_IT * of_flat, "{of_complex} {of_flat}");
    }

    #[test]
    fn six_opacities_are_stored_where_they_differ_by_more_than_chance() {
        let solid = |_: DVec3| 1.0;
        let veil = |_: DVec3| 0.4;
        // A sheet across y: all from above, little from the sides.
        let sheet = |eye: DVec3| 0.2 + 0.8 * eye.y.abs();
        let kind = |share: &dyn Fn(DVec3) -> f64, rays: usize, most| {
            let (mut counted, mut chance) = (Counted::default(), Chance::new(5));
            let directions: Vec<DVec3> = directions(500).collect();
            for ray in 0..rays {
                // The first few are spread, too.
                let eye = directions[ray * 191 % directions.len()];
                counted.add(&by_cosines(eye), chance.unit() < share(eye), 1.0);
            }
            // Nothing is known of any solid surface.
            let mut seen = Seen::default();
            seen.begin([0; 3], 1.0);
            seen.found[0][0].counted = counted;
            seen.found[0][0].probes = counted.independent() as u32;
            seen.found[0][0].passed = 1.0;
            classify(&seen, most).kind
        };
        for rays in [30, 100, 1000, 100_000] {
            assert_eq!(kind(&solid, rays, Opacity::Six), OpacityKind::Opaque);
            assert_eq!(kind(&veil, rays, Opacity::Six), OpacityKind::Scalar);
            if rays > 30 {
                assert_eq!(kind(&sheet, rays, Opacity::Six), OpacityKind::Six);
            }
        }
        // The requested kind is the most that is stored.
        assert_eq!(kind(&sheet, 1000, Opacity::Scalar), OpacityKind::Scalar);
        assert_eq!(kind(&sheet, 1000, Opacity::None), OpacityKind::Opaque);
        assert_eq!(kind(&solid, 0, Opacity::Six), OpacityKind::Opaque);
    }

    #[test]
    fn the_scalar_is_hits_over_hits_and_passes() {
        // Half of the rays from +y hit, and none of the others. This is not the mean of six.
        let mut counted = Counted::default();
        for (eye, is_hit, weight) in [
            (DVec3::Y, true, 1.0),
            (DVec3::Y, false, 1.0),
            (DVec3::X, false, 0.5),
            (DVec3::X, false, 0.5),
            (DVec3::Z, false, 1.0),
        ] {
            counted.add(&by_cosines(eye), is_hit, weight);
        }
        assert!((counted.scalar() - 0.25).abs() < 1e-12);
        assert!((counted.independent() - 16.0 / 3.5).abs() < 1e-9);
    }
}
