//! Textures: pictures on triangles, averaged over as much of them as a sample or a voxel sees.
//!
//! A texture has copies of half its size, a quarter and so on, down to one texel. A sample of many texels reads a
//! copy with texels of its own size, and costs as much as a sample of one. Colours are averaged in linear light, by
//! opacity.

pub(crate) mod paint;
pub(crate) mod stored;

use std::ops::{Add, Mul};

use glam::{DVec3, DVec4};
use rayon::prelude::*;
use xxhash_rust::xxh3::Xxh3;

use crate::material::{to_light, to_srgb};

/// The meaning of the opacity of texels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum AlphaMode {
    /// Nothing: all are opaque.
    Opaque,
    /// Texels of at least this opacity are opaque, all others are holes.
    Mask(f32),
    /// The share of light that they stop.
    Blend,
}

/// The picture beyond its edge, along one axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Wrap {
    #[default]
    Repeat,
    /// Every other repetition is mirrored.
    Mirror,
    /// The edge continues.
    Clamp,
}

/// A picture for triangles, with its coarser copies.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    levels: Vec<Level>,
    wrap: [Wrap; 2],
    is_opaque: bool,
    is_mask: bool,
}

#[derive(Debug, Clone, PartialEq)]
struct Level {
    size: [usize; 2],
    /// sRGB and opacity, row by row from the top.
    texels: Vec<[u8; 4]>,
}

/// Reading between four texels, each the mean of a square, spreads as far as a square of this side.
const SPREAD: f64 = 1.732_050_807_568_877_2;

impl Texture {
    pub(crate) fn new(
        size: [usize; 2],
        mut texels: Vec<[u8; 4]>,
        mode: AlphaMode,
        wrap: [Wrap; 2],
    ) -> Self {
        for [.., alpha] in &mut texels {
            *alpha = match mode {
                AlphaMode::Opaque => 255,
                AlphaMode::Mask(cutoff) if f32::from(*alpha) < cutoff * 255.0 => 0,
                AlphaMode::Mask(_) => 255,
                AlphaMode::Blend => *alpha,
            };
        }
        let is_opaque = texels.iter().all(|texel| texel[3] == 255);
        let mut levels = vec![Level { size, texels }];
        while let Some(finer) = levels.last().filter(|level| level.texels.len() > 1) {
            levels.push(finer.halved());
        }
        Self {
            levels,
            wrap,
            is_opaque,
            is_mask: matches!(mode, AlphaMode::Mask(_)),
        }
    }

    /// A hash of all that pictures show of it.
    pub(crate) fn hash(&self) -> u64 {
        let finest = &self.levels[0];
        let mut hash = Xxh3::new();
        hash.update(format!("{:?} {} {:?}", self.wrap, self.is_mask, finest.size).as_bytes());
        hash.update(finest.texels.as_flattened());
        hash.digest()
    }

    pub(crate) fn is_opaque(&self) -> bool {
        self.is_opaque
    }

    pub(crate) fn bytes(&self) -> u64 {
        let levels = self.levels.iter();
        levels.map(|l| size_of_val(&l.texels[..]) as u64).sum()
    }

    pub(crate) fn size(&self) -> [f64; 2] {
        self.levels[0].size.map(|side| side as f64)
    }

    /// The beginning of the repetition that has a place.
    pub(crate) fn repetition(&self, place: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| match self.wrap[k] {
            Wrap::Repeat => libm::floor(place[k]),
            Wrap::Mirror => 2.0 * libm::floor(place[k] / 2.0),
            Wrap::Clamp => 0.0,
        })
    }

    /// Colour, linear light, and opacity around a place: across from the left and down from the top, in sizes of the
    /// picture. They are the mean of a square of so many texels a side.
    pub(crate) fn at(&self, place: [f64; 2], side: f64) -> (DVec3, f64) {
        let read = self.read(place, side, weighted);
        if read.w <= 0.0 {
            return (DVec3::ONE, 0.0);
        }
        (read.truncate() / read.w, self.opacity_of(read.w, side))
    }

    /// The opacity of [`Texture::at`], to the bit.
    fn opacity(&self, place: [f64; 2], side: f64) -> f64 {
        let read = self.read(place, side, |texel| f64::from(texel[3]) / 255.0);
        self.opacity_of(read, side)
    }

    fn opacity_of(&self, read: f64, side: f64) -> f64 {
        let opacity = read.min(1.0);
        match self.is_mask && side < 1.0 {
            // The edge of a hole is half way between texels, and as wide as the sample.
            true => (0.5 + (opacity - 0.5) / side.max(1e-9)).clamp(0.0, 1.0),
            false => opacity,
        }
    }

    fn read<V: Mean>(&self, place: [f64; 2], side: f64, of: impl Fn([u8; 4]) -> V + Copy) -> V {
        if side <= SPREAD {
            return self.levels[0].at(place, self.wrap, of);
        }
        let coarsest = (self.levels.len() - 1) as f64;
        let level = libm::log2(side / SPREAD).min(coarsest);
        let (finer, rest) = (level as usize, level.fract());
        let read = self.levels[finer].at(place, self.wrap, of) * (1.0 - rest);
        match self.levels.get(finer + 1) {
            Some(coarser) => read + coarser.at(place, self.wrap, of) * rest,
            None => read,
        }
    }
}

trait Mean: Copy + Add<Output = Self> + Mul<f64, Output = Self> {}
impl<T: Copy + Add<Output = T> + Mul<f64, Output = T>> Mean for T {}

impl Level {
    /// The mean of a value of the four nearest texels, by their distances.
    fn at<V: Mean>(&self, place: [f64; 2], wrap: [Wrap; 2], of: impl Fn([u8; 4]) -> V) -> V {
        let near = [0, 1].map(|k| {
            let size = self.size[k];
            let (inside, [before, after]) = match wrap[k] {
                Wrap::Repeat => (place[k] - place[k].floor(), [size - 1, 0]),
                Wrap::Mirror => {
                    let turn = place[k] - 2.0 * (place[k] / 2.0).floor();
                    (1.0 - (turn - 1.0).abs(), [0, size - 1])
                }
                Wrap::Clamp => (place[k].clamp(0.0, 1.0), [0, size - 1]),
            };
            // The middle of the first texel is at 0; from -1/2 to size - 1/2.
            let at = inside * size as f64 - 0.5;
            let low = at.floor();
            let first = if low < 0.0 {
                before
            } else {
                (low as usize).min(size - 1)
            };
            let next = if low < 0.0 { 0 } else { first + 1 };
            ([first, if next < size { next } else { after }], at - low)
        });
        let [(columns, right), (rows, down)] = near;
        let between = |[a, b]: [V; 2], share: f64| a * (1.0 - share) + b * share;
        let row = |y: usize| {
            let texels = columns.map(|x| of(self.texels[y * self.size[0] + x]));
            between(texels, right)
        };
        between(rows.map(row), down)
    }

    fn halved(&self) -> Self {
        let [width, height] = self.size;
        let size = [width, height].map(|side| (side / 2).max(1));
        // Where a side is odd, texels at the limit of two squares count in both.
        let span =
            |at: usize, from: usize, to: usize| at * from / to..((at + 1) * from).div_ceil(to);
        let row = |y: usize| {
            let rows = span(y, height, size[1]);
            let texel = move |x: usize| {
                let mut sum = DVec4::ZERO;
                let mut count = 0.0;
                for y in rows.clone() {
                    for x in span(x, width, size[0]) {
                        sum += weighted(self.texels[y * width + x]);
                        count += 1.0;
                    }
                }
                let opacity = (255.0 * sum.w / count + 0.5) as u8;
                let [r, g, b] = to_srgb(sum.truncate() / sum.w.max(f64::MIN_POSITIVE));
                [r, g, b, opacity]
            };
            (0..size[0]).map(texel)
        };
        let rows = (0..size[1]).into_par_iter();
        Self {
            size,
            texels: rows.flat_map_iter(row).collect(),
        }
    }
}

fn weighted([r, g, b, alpha]: [u8; 4]) -> DVec4 {
    let opacity = f64::from(alpha) / 255.0;
    (to_light([r, g, b]) * opacity).extend(opacity)
}

/// A texture on a triangle: places of its corners in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampler<'t> {
    pub(crate) texture: &'t Texture,
    pub(crate) places: [[f32; 2]; 3],
}

impl Sampler<'_> {
    /// Colour and opacity at shares of the corners, the mean of a square of that side, in the corners' units.
    pub(crate) fn at(&self, corners: &[DVec3; 3], shares: [f64; 3], side: f64) -> (DVec3, f64) {
        let side = side * self.texels_per_unit(corners);
        self.texture.at(self.place(shares), side)
    }

    /// The opacity alone, of a square of so many texels a side.
    pub(crate) fn opacity(&self, shares: [f64; 3], texels: f64) -> f64 {
        self.texture.opacity(self.place(shares), texels)
    }

    fn place(&self, shares: [f64; 3]) -> [f64; 2] {
        let [a, b, c] = self.places.map(|place| place.map(f64::from));
        [0, 1].map(|k| a[k] * shares[0] + b[k] * shares[1] + c[k] * shares[2])
    }

    pub(crate) fn texels_per_unit(&self, corners: &[DVec3; 3]) -> f64 {
        let [a, b, c] = self.places.map(|place| place.map(f64::from));
        let size = self.texture.size();
        let [to_b, to_c] = [b, c].map(|p| [0, 1].map(|k| (p[k] - a[k]) * size[k]));
        let texels = (to_b[0] * to_c[1] - to_b[1] * to_c[0]).abs();
        let [a, b, c] = *corners;
        let area = (b - a).cross(c - a).length();
        (texels / area.max(f64::MIN_POSITIVE)).sqrt()
    }
}
