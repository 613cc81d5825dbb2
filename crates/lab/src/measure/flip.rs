//! FLIP for pictures of low dynamic range: how different two pictures look that are shown in turn at
//! one place (Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild 2020).
//!
//! The error of a pixel is `colour^(1 - feature)`. *Colour*: each channel in the opponent space
//! `Y Cx Cz` is blurred by the eye's contrast sensitivity, then compared in CIE L*a*b* (HyAB).
//! *Feature*: edges and points of `Y`. All filters are separable.

use rayon::prelude::*;

use super::color::{Colors, on_black};
use shiftvox::srgb::to_linear;

/// The authors' pixels per degree: a display 0.7 m wide with 3840 pixels, seen from 0.7 m away.
const PIXELS_PER_DEGREE: f64 = 3840.0 * std::f64::consts::PI / 180.0;

const COLOR_EXPONENT: f64 = 0.7;
const FEATURE_EXPONENT: f64 = 0.5;
/// Distances up to this part of the greatest
const KNEE_DISTANCE: f64 = 0.4;
/// are spread up to this error.
const KNEE_ERROR: f64 = 0.95;
/// Twice the standard deviation of the feature filters, degrees.
const FEATURE_WIDTH: f64 = 0.082;
/// Largest scale of the contrast sensitivity filters, which decides on their radius.
const LARGEST_SCALE: f64 = 0.04;

/// Contrast sensitivity by channel: terms of weight and scale. A scale is a
/// variance in degrees squared, times `2 pi^2`.
const SENSITIVITY: [&[(f64, f64)]; 3] = [
    &[(1.0, 0.0047)],
    &[(1.0, 0.0053)],
    &[(34.1, 0.04), (13.5, 0.025)],
];

/// White of the D65 illuminant, XYZ.
const WHITE: [f64; 3] = [0.950_428_545, 1.0, 1.088_900_371];

pub(crate) struct Flip {
    /// Blurred, in Hunt-adjusted L*a*b*.
    lab: Vec<[f64; 3]>,
    features: Vec<[f64; 2]>,
}

impl Flip {
    /// Transparent pixels count as they appear on black.
    pub(crate) fn new((width, height, rgba): Colors<'_>) -> Self {
        let size = (width as usize, height as usize);
        let opponent: Vec<[f64; 3]> = rgba
            .iter()
            .map(|&pixel| opponent_of_xyz(xyz_of_rgb(on_black(pixel).map(linear))))
            .collect();
        let channel = |c: usize| -> Vec<f64> { opponent.iter().map(|p| p[c]).collect() };
        let blurred: Vec<Vec<f64>> = (0..3)
            .map(|c| blur(size, &channel(c), SENSITIVITY[c]))
            .collect();
        let lab = (0..opponent.len())
            .map(|i| {
                let opponent = [blurred[0][i], blurred[1][i], blurred[2][i]];
                let rgb = rgb_of_xyz(xyz_of_opponent(opponent)).map(|c| c.clamp(0.0, 1.0));
                hunt(lab_of_xyz(xyz_of_rgb(rgb)))
            })
            .collect();
        let luma: Vec<f64> = opponent.iter().map(|p| (p[0] + 16.0) / 116.0).collect();
        Self {
            lab,
            features: features(size, &luma),
        }
    }

    /// Mean error of the pixels against a picture of the same size, 0 to 1; 0 for no pixels. The same
    /// either way round.
    pub(crate) fn mean_error(&self, other: &Self) -> f64 {
        self.errors(other).iter().sum::<f64>() / self.lab.len().max(1) as f64
    }

    fn errors(&self, other: &Self) -> Vec<f64> {
        let greatest = greatest_distance();
        let knee = KNEE_DISTANCE * greatest;
        let spread = |distance: f64| {
            if distance < knee {
                KNEE_ERROR * distance / knee
            } else {
                KNEE_ERROR + (distance - knee) / (greatest - knee) * (1.0 - KNEE_ERROR)
            }
        };
        let pixels = self.lab.iter().zip(&self.features);
        let others = other.lab.iter().zip(&other.features);
        let pixel = |((lab, own), (its_lab, its)): ((&_, &[f64; 2]), (&_, &[f64; 2]))| {
            let color = spread(libm::pow(hyab(*lab, *its_lab), COLOR_EXPONENT));
            let apart = |f: usize| (own[f] - its[f]).abs();
            let feature = apart(0).max(apart(1)) * std::f64::consts::FRAC_1_SQRT_2;
            libm::pow(color, 1.0 - libm::pow(feature, FEATURE_EXPONENT))
        };
        pixels.zip(others).map(pixel).collect()
    }
}

fn greatest_distance() -> f64 {
    let of = |rgb: [f64; 3]| hunt(lab_of_xyz(xyz_of_rgb(rgb)));
    libm::pow(
        hyab(of([0.0, 1.0, 0.0]), of([0.0, 0.0, 1.0])),
        COLOR_EXPONENT,
    )
}

fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + libm::hypot(a[1] - b[1], a[2] - b[2])
}

fn linear(byte: u8) -> f64 {
    to_linear(f64::from(byte) / 255.0)
}

const XYZ_OF_RGB: [[f64; 3]; 3] = [
    [
        10_135_552.0 / 24_577_794.0,
        8_788_810.0 / 24_577_794.0,
        4_435_075.0 / 24_577_794.0,
    ],
    [
        2_613_072.0 / 12_288_897.0,
        8_788_810.0 / 12_288_897.0,
        887_015.0 / 12_288_897.0,
    ],
    [
        1_425_312.0 / 73_733_382.0,
        8_788_810.0 / 73_733_382.0,
        70_074_185.0 / 73_733_382.0,
    ],
];
const RGB_OF_XYZ: [[f64; 3]; 3] = [
    [3.241_003_275, -1.537_398_934, -0.498_615_861],
    [-0.969_224_334, 1.875_930_071, 0.041_554_224],
    [0.055_639_423, -0.204_011_202, 1.057_148_933],
];

fn times(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn xyz_of_rgb(rgb: [f64; 3]) -> [f64; 3] {
    times(&XYZ_OF_RGB, rgb)
}

fn rgb_of_xyz(xyz: [f64; 3]) -> [f64; 3] {
    times(&RGB_OF_XYZ, xyz)
}

fn opponent_of_xyz(xyz: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = [0, 1, 2].map(|k| xyz[k] / WHITE[k]);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn xyz_of_opponent([luma, cx, cz]: [f64; 3]) -> [f64; 3] {
    let y = (luma + 16.0) / 116.0;
    let relative = [y + cx / 500.0, y, y - cz / 200.0];
    [0, 1, 2].map(|k| relative[k] * WHITE[k])
}

fn lab_of_xyz(xyz: [f64; 3]) -> [f64; 3] {
    const DELTA: f64 = 6.0 / 29.0;
    let [x, y, z] = [0, 1, 2].map(|k| {
        let value = xyz[k] / WHITE[k];
        if value > DELTA * DELTA * DELTA {
            libm::cbrt(value)
        } else {
            value / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Colours look more colourful where it is bright.
fn hunt([l, a, b]: [f64; 3]) -> [f64; 3] {
    [l, 0.01 * l * a, 0.01 * l * b]
}

type Kernel = Vec<f64>;

fn kernel(radius: i32, weight: impl Fn(f64) -> f64) -> Kernel {
    (-radius..=radius).map(|k| weight(f64::from(k))).collect()
}

/// Divides the positive weights by their sum, and the negative ones by theirs.
fn normalised(kernel: Kernel) -> Kernel {
    let above: f64 = kernel.iter().filter(|&&w| w > 0.0).sum();
    let below: f64 = -kernel.iter().filter(|&&w| w < 0.0).sum::<f64>();
    let share = |w: f64| if w < 0.0 { w / below } else { w / above };
    kernel.into_iter().map(share).collect()
}

fn blur(size: (usize, usize), plane: &[f64], terms: &[(f64, f64)]) -> Vec<f64> {
    let pi_squared = std::f64::consts::PI * std::f64::consts::PI;
    let deviation = libm::sqrt(LARGEST_SCALE / (2.0 * pi_squared));
    let radius = libm::ceil(3.0 * deviation * PIXELS_PER_DEGREE) as i32;
    let mut total = 0.0;
    let mut sum = vec![0.0; plane.len()];
    for &(weight, scale) in terms {
        let bell = kernel(radius, |k| {
            let degrees = k / PIXELS_PER_DEGREE;
            libm::exp(-pi_squared * degrees * degrees / scale)
        });
        let weight = weight * libm::sqrt(std::f64::consts::PI / scale);
        let mass: f64 = bell.iter().sum();
        total += weight * mass * mass;
        let part = filtered(size, plane, &bell, &bell);
        for (sum, part) in sum.iter_mut().zip(part) {
            *sum += weight * part;
        }
    }
    sum.iter_mut().for_each(|value| *value /= total);
    sum
}

fn features(size: (usize, usize), luma: &[f64]) -> Vec<[f64; 2]> {
    let deviation = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    let variance = deviation * deviation;
    let radius = libm::ceil(3.0 * deviation) as i32;
    let gauss = |k: f64| libm::exp(-k * k / (2.0 * variance));
    let along = normalised(kernel(radius, gauss));
    let strength = |across: &Kernel| -> Vec<f64> {
        let x = filtered(size, luma, across, &along);
        let y = filtered(size, luma, &along, across);
        x.iter().zip(y).map(|(x, y)| libm::hypot(*x, y)).collect()
    };
    let edges = strength(&normalised(kernel(radius, |k| -k * gauss(k))));
    let points = strength(&normalised(kernel(radius, |k| {
        (k * k / variance - 1.0) * gauss(k)
    })));
    edges.into_iter().zip(points).map(|(e, p)| [e, p]).collect()
}

fn filtered(
    (width, height): (usize, usize),
    plane: &[f64],
    across: &[f64],
    down: &[f64],
) -> Vec<f64> {
    if plane.is_empty() {
        return Vec::new();
    }
    let within = |at: usize, kernel: &[f64], k: usize, end: usize| {
        (at + k).saturating_sub(kernel.len() / 2).min(end - 1)
    };
    let mut rows = vec![0.0; plane.len()];
    rows.par_chunks_mut(width)
        .zip(plane.par_chunks(width))
        .for_each(|(to, from)| {
            for (x, value) in to.iter_mut().enumerate() {
                let weigh = |(k, w): (usize, &f64)| w * from[within(x, across, k, width)];
                *value = across.iter().enumerate().map(weigh).sum();
            }
        });
    let mut both = vec![0.0; plane.len()];
    both.par_chunks_mut(width).enumerate().for_each(|(y, to)| {
        for (k, weight) in down.iter().enumerate() {
            let from = within(y, down, k, height) * width;
            for (value, row) in to.iter_mut().zip(&rows[from..from + width]) {
                *value += weight * row;
            }
        }
    });
    both
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (u32, u32) = (48, 40);

    fn picture(color: fn(u32, u32) -> [u8; 3]) -> Flip {
        let at = |i: u32| color(i % SIZE.0, i / SIZE.0);
        let pixels = (0..SIZE.0 * SIZE.1).map(|i| [at(i)[0], at(i)[1], at(i)[2], 255]);
        Flip::new((SIZE.0, SIZE.1, &pixels.collect::<Vec<_>>()))
    }

    fn base(x: u32, y: u32) -> [u8; 3] {
        [(x * 5) as u8, (y * 6) as u8, (x * y % 200) as u8]
    }

    /// Means and the pixels (21, 20), (0, 0), (24, 10) from the authors' C++ code, by way of the
    /// crate `nv-flip` 0.1.2.
    #[test]
    fn the_authors_program_says_the_same() {
        let redder = picture(|x, y| {
            let [r, g, b] = base(x, y);
            [r.saturating_add(20), g, b]
        });
        let striped = picture(|x, y| match x {
            20..23 => [255; 3],
            _ => base(x, y),
        });
        let inverse = picture(|x, y| base(x, y).map(|c| 255 - c));
        let edge = picture(|x, _| if x < 24 { [200; 3] } else { [60; 3] });
        let moved = picture(|x, _| if x < 25 { [200; 3] } else { [60; 3] });
        let [green, blue] = [picture(|_, _| [0, 255, 0]), picture(|_, _| [0, 0, 255])];
        let (base, grey) = (picture(base), picture(|_, _| [100; 3]));
        for (a, b, expected) in [
            (&base, &redder, [0.205_291, 0.201_712, 0.084_091, 0.241_525]),
            (&base, &striped, [0.147_576, 0.964_051, 0.0, 0.649_032]),
            (
                &base,
                &inverse,
                [0.925_414, 0.617_441, 0.976_864, 0.968_656],
            ),
            (&edge, &moved, [0.044_263, 0.054_494, 0.0, 0.429_329]),
            (&green, &blue, [1.0; 4]),
            (&edge, &grey, [0.616_885, 0.857_687, 0.737_334, 0.625_571]),
            (&base, &base, [0.0; 4]),
        ] {
            let errors = a.errors(b);
            assert_eq!(errors, b.errors(a));
            let at = |x: u32, y: u32| errors[(y * SIZE.0 + x) as usize];
            let found = [a.mean_error(b), at(21, 20), at(0, 0), at(24, 10)];
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-4, "{found} {expected}");
            }
        }
        let none = Flip::new((0, 0, &[]));
        assert_eq!(none.mean_error(&none), 0.0);
    }
}
