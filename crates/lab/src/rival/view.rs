//! The rays of a frame as the host prepares them: sums that change by constants from ray to ray.

use crate::float_rays::inverse;
use shiftvox::project::FrameSetup;

/// A ray's direction and its moments about the object's lowest corner, six components, in units of the last place.
pub(super) type Sums = [i64; 6];

/// The frame's rays in words of a number of bits.
#[derive(Debug)]
pub(super) struct View {
    /// Sums of the first sample's ray, with half a unit of the word for rounding.
    first: Sums,
    right: Sums,
    down: Sums,
    /// Bits of the sums below a word's last place.
    pub(super) guard: u32,
    /// The eye in voxels, rounded down, and the same with each axis mirrored.
    pub(super) eye: [[i64; 2]; 3],
}

impl View {
    pub(super) fn new(setup: &FrameSetup, bits: u32, wide_bits: u32) -> Self {
        let (object, eye) = inverse(setup);
        let sample = 1.0 / (1u64 << setup.levels) as f64;
        let with_moments = |d: [f64; 3]| {
            let moment = |k: usize| eye[k] * d[(k + 1) % 3] - eye[(k + 1) % 3] * d[k];
            [d[0], d[1], d[2], moment(0), moment(1), moment(2)]
        };
        let first = with_moments(object([sample / 2.0, sample / 2.0, 1.0]));
        let right = with_moments(object([sample, 0.0, 0.0]));
        let down = with_moments(object([0.0, sample, 0.0]));
        let side = (1u64 << setup.depth) as f64;
        // The greatest magnitude of a ray's sums: linear in the place, so at a corner of the picture.
        let (mut direction, mut moment) = (0f64, 0f64);
        for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let (i, j) = (f64::from(i * setup.width), f64::from(j * setup.height));
            for k in 0..6 {
                let most = if k < 3 { &mut direction } else { &mut moment };
                *most = most.max((first[k] + right[k] * i + down[k] * j).abs());
            }
        }
        // Two sides and a moment fit a word, and so does what is added to them.
        let most = 3.0 * side * direction + moment;
        let scale = (((1u64 << (bits - 1)) - 1) as f64 / most).log2().floor() as i32;
        let places = setup.width.max(setup.height).next_power_of_two().ilog2() + 2;
        let guard = places.min(wide_bits - bits);
        let unit = 2f64.powi(scale + guard as i32);
        let rounded = |sums: [f64; 6]| sums.map(|sum| (sum * unit).round() as i64);
        let half = (1i64 << guard) >> 1;
        Self {
            first: rounded(first).map(|sum| sum + half),
            right: rounded(right),
            down: rounded(down),
            guard,
            eye: eye.map(|at| [at.floor() as i64, (side - at).floor() as i64]),
        }
    }

    pub(super) fn first(&self, (i, j): (u32, u32)) -> Sums {
        let step = self.step((0, 0), (i, j));
        std::array::from_fn(|k| self.first[k] + step[k])
    }

    /// The change of the sums from one sample to another: of few distances, so the hardware keeps them.
    pub(super) fn step(&self, from: (u32, u32), to: (u32, u32)) -> Sums {
        let across = i64::from(to.0) - i64::from(from.0);
        let along = i64::from(to.1) - i64::from(from.1);
        std::array::from_fn(|k| self.right[k] * across + self.down[k] * along)
    }
}
