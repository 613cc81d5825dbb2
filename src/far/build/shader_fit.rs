//! A voxel's shader and opacity, fitted to what rays saw of it.

use glam::DVec3;

use super::count::{Counted, Seen, SurfaceSample, main_normal};
use crate::far::blend::{Blend, DIRECTIONS, Fit};
use crate::far::record::{Opacity, OpacityKind, Shader, Voxel};

/// Weight of a normal's error beside a colour's: both are 0 to 1.
const NORMAL_WEIGHT: f64 = 0.25;
/// Below this mean square error a flat shader is good enough.
const GOOD_ENOUGH: f64 = 5e-4;
/// A complex shader, three times as large, must be better by this factor.
const WORTH_IT: f64 = 0.7;
/// Fewer samples do not determine a complex shader.
const LEAST_SAMPLES: usize = 6;
/// A voxel is stored as opaque if its opacity is this near 1, root of the mean
/// square over the directions that rays crossed it from.
const OPAQUE_WITHIN: f64 = 0.1;
/// Six opacities are stored as one number if they are this near it.
const ALIKE_WITHIN: f64 = 0.1;
/// How much nearer six numbers come to hits and passes than one does by chance
/// alone: this many binomial variances over the number of rays (the mean of chi
/// square with 5 degrees of freedom).
const NOISE: f64 = 5.0;
/// Hits and passes that are added before the variance is taken, so that a few
/// rays which all hit do not prove that all would.
const DOUBT: f64 = 0.5;

/// A fitted voxel, and the sum over its samples of the square error.
pub(super) struct Fitted {
    pub(super) voxel: Voxel,
    pub(super) square_error: f64,
}

/// Fits a voxel that was seen at least once.
pub(super) fn fit(seen: &Seen, blend: Blend, use_of_opacity: Opacity) -> Fitted {
    let samples = &seen.samples;
    let count = samples.len().max(1) as f64;
    let flat = flat(samples);
    let flat_error = error(&flat, samples, blend) / count;
    let mut chosen = (flat, flat_error);
    if flat_error > GOOD_ENOUGH && samples.len() >= LEAST_SAMPLES {
        let complex = complex(samples, blend);
        let complex_error = error(&complex, samples, blend) / count;
        if complex_error < WORTH_IT * flat_error {
            chosen = (complex, complex_error);
        }
    }
    let (opacity_kind, opacity) = classify(&seen.counted, use_of_opacity);
    let scalar = match opacity_kind {
        OpacityKind::Opaque => 1.0,
        OpacityKind::Scalar | OpacityKind::Six => seen.counted.scalar(),
    };
    Fitted {
        voxel: Voxel {
            place: seen.place,
            shader: chosen.0,
            opacity,
            scalar,
            opacity_kind,
        },
        square_error: chosen.1 * count,
    }
}

/// The smallest kind of opacity that agrees with what rays found, within tolerance and noise.
fn classify(counted: &Counted, most: Opacity) -> (OpacityKind, [f64; DIRECTIONS]) {
    let rays = counted.independent();
    let (six, scalar) = (counted.six(), counted.scalar());
    let likely = (scalar * rays + DOUBT) / (rays + 2.0 * DOUBT);
    let noise = NOISE * likely * (1.0 - likely) / rays.max(1.0);
    let is_opaque = counted.square_from(&six, 1.0) <= OPAQUE_WITHIN * OPAQUE_WITHIN + noise;
    if most == Opacity::None || is_opaque {
        return (OpacityKind::Opaque, [1.0; DIRECTIONS]);
    }
    let is_alike = counted.square_from(&six, scalar) <= ALIKE_WITHIN * ALIKE_WITHIN + noise;
    if most == Opacity::Scalar || is_alike {
        return (OpacityKind::Scalar, [scalar; DIRECTIONS]);
    }
    (OpacityKind::Six, six)
}

fn flat(samples: &[SurfaceSample]) -> Shader {
    let normal = main_normal(samples);
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

fn complex(samples: &[SurfaceSample], blend: Blend) -> Shader {
    let mut fit = Fit::<6>::new();
    let mut mean = [0.0; 6];
    for sample in samples {
        let (c, n) = (sample.color, sample.normal);
        let value = [c.x, c.y, c.z, n.x, n.y, n.z];
        fit.add(&blend.shares(sample.towards_eye), &value, 1.0);
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

/// Sum of the square errors of what a shader shows of the samples.
fn error(shader: &Shader, samples: &[SurfaceSample], blend: Blend) -> f64 {
    samples
        .iter()
        .map(|sample| {
            let (normal, color) = shader.seen_from(sample.towards_eye, blend);
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

    fn samples(of: impl Fn(DVec3) -> (DVec3, DVec3)) -> Vec<SurfaceSample> {
        (0..500)
            .map(|i| {
                let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 500.0;
                let around = f64::from(i) * 2.399_963_229_728_653;
                let ring = libm::sqrt(1.0 - z * z);
                let towards_eye = DVec3::new(ring * libm::cos(around), ring * libm::sin(around), z);
                let (normal, color) = of(towards_eye);
                SurfaceSample {
                    towards_eye,
                    normal,
                    color,
                }
            })
            .collect()
    }

    #[test]
    fn a_wall_with_two_colours_is_flat() {
        let up = DVec3::new(0.6, 0.0, 0.8);
        let wall = samples(|eye| {
            if eye.dot(up) > 0.0 {
                (up, DVec3::X)
            } else {
                (-up, DVec3::Y)
            }
        });
        let shader = flat(&wall);
        assert!(error(&shader, &wall, Blend::Squares) < 1e-9);
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
        let of_flat = error(&flat(&ball), &ball, Blend::Squares);
        for blend in [Blend::Squares, Blend::Cosines] {
            let of_complex = error(&complex(&ball, blend), &ball, blend);
            assert!(of_complex < WORTH_IT * of_flat, "{of_complex} {of_flat}");
        }
    }

    /// Counts of evenly spread directions, of which a share of each hits.
    fn counted(rays: u32, share: impl Fn(DVec3) -> f64) -> Counted {
        let mut counted = Counted::default();
        let mut chance = crate::far::build::chance::Chance::new(5);
        let samples = samples(|eye| (eye, eye));
        for ray in 0..rays as usize {
            // The first few are spread, too.
            let sample = &samples[ray * 191 % samples.len()];
            let is_hit = chance.unit() < share(sample.towards_eye);
            let shares = Blend::Cosines.shares(sample.towards_eye);
            counted.add(&shares, is_hit, 1.0);
        }
        counted
    }

    #[test]
    fn six_opacities_are_stored_where_they_differ_by_more_than_chance() {
        let kind = |rays, share: fn(DVec3) -> f64| {
            let counted = counted(rays, share);
            classify(&counted, Opacity::Six).0
        };
        let solid = |_: DVec3| 1.0;
        let veil = |_: DVec3| 0.4;
        // A sheet across y: all from above, little from the sides.
        let sheet = |eye: DVec3| 0.2 + 0.8 * eye.y.abs();
        for rays in [30, 100, 1000, 100_000] {
            assert_eq!(kind(rays, solid), OpacityKind::Opaque, "{rays}");
            assert_eq!(kind(rays, veil), OpacityKind::Scalar, "{rays}");
        }
        for rays in [100, 1000, 100_000] {
            assert_eq!(kind(rays, sheet), OpacityKind::Six, "{rays}");
        }
        // The requested kind is the most that is stored.
        let sheet = counted(1000, sheet);
        assert_eq!(classify(&sheet, Opacity::Scalar).0, OpacityKind::Scalar);
        assert_eq!(classify(&sheet, Opacity::None).0, OpacityKind::Opaque);
        assert_eq!(
            classify(&counted(0, solid), Opacity::Six).0,
            OpacityKind::Opaque
        );
    }

    #[test]
    fn the_scalar_is_hits_over_hits_and_passes() {
        // Half of what comes from +y hits, nothing of the rest: not the mean of six.
        let mut counted = Counted::default();
        for (eye, is_hit, weight) in [
            (DVec3::Y, true, 1.0),
            (DVec3::Y, false, 1.0),
            (DVec3::X, false, 0.5),
            (DVec3::X, false, 0.5),
            (DVec3::Z, false, 1.0),
        ] {
            counted.add(&Blend::Cosines.shares(eye), is_hit, weight);
        }
        assert!((counted.scalar() - 0.25).abs() < 1e-12);
        assert!((counted.independent() - 16.0 / 3.5).abs() < 1e-9);
    }
}
