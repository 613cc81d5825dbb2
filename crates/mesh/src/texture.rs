//! Textures: pictures on triangles, averaged over as much of them as a sample or a voxel sees.
//!
//! A texture has copies of half its size, a quarter and so on, down to one texel. A sample of many texels reads a
//! copy with texels of its own size, and costs as much as a sample of one. Colours are averaged in linear light, by
//! opacity.

pub(crate) mod paint;
pub(crate) mod stored;

use std::ops::{Add, Mul};

use glam::{DVec2, DVec3, DVec4};
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

/// Most squares read for one parallelogram.
const MOST_SQUARES: f64 = 16.0;

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

    /// Colour, linear light, and opacity of a parallelogram around a place: across from the left and down from the top, in
    /// sizes of the picture.
    pub(crate) fn at(&self, place: [f64; 2], image: Image) -> (DVec3, f64) {
        let mean = self.mean(place, image, weighted);
        if mean.w <= 0.0 {
            return (DVec3::ONE, 0.0);
        }
        (mean.truncate() / mean.w, mean.w.min(1.0))
    }

    /// The opacity of [`Texture::at`].
    pub(crate) fn opacity(&self, place: [f64; 2], image: Image) -> f64 {
        self.mean(place, image, opacity).min(1.0)
    }

    /// An image that is longer than wide is read as a row of squares of its width, with the same variances.
    fn mean<V: Mean>(&self, place: [f64; 2], image: Image, of: impl Fn([u8; 4]) -> V + Copy) -> V {
        let Image {
            across,
            product,
            down,
        } = image;
        if across + down <= SPREAD * SPREAD && !self.is_mask {
            return self.levels[0].at(place, self.wrap, of);
        }
        let half = (across - down) / 2.0;
        let swing = (half * half + product * product).sqrt();
        let length = ((across + down) / 2.0 + swing).sqrt();
        let area = (across * down - product * product).max(0.0).sqrt();
        let width = (area / length).max(length / MOST_SQUARES);
        let count = (length / width.max(SPREAD)).round();
        if !(2.0..=MOST_SQUARES).contains(&count) {
            // Where the eye is in the triangle's plane, numbers are infinite, or none.
            let side = match length.is_finite() {
                true => area.sqrt(),
                false => length,
            };
            return self.sharp(self.read(place, self.level(side), of), side);
        }
        let variance = length.powi(2) - width.max(SPREAD).powi(2);
        let along = match half >= 0.0 {
            true => DVec2::new(half + swing, product),
            false => DVec2::new(product, swing - half),
        };
        let along = along.normalize() * (variance / (count * count - 1.0)).sqrt();
        let (finer, rest) = self.level(width);
        let square = |number: u32| {
            let number = f64::from(number);
            let place = [0, 1].map(|k| {
                let steps = number - (count - 1.0) / 2.0;
                place[k] + along[k] * steps / self.size()[k]
            });
            // Each reads one copy, as many of them the coarser one as its share.
            let coarser = [number + 1.0, number].map(|n| (n * rest + 0.5) as usize);
            let level = finer + coarser[0] - coarser[1];
            self.sharp(self.levels[level].at(place, self.wrap, of), width)
        };
        let first = square(0);
        (1..count as u32).fold(first, |sum, number| sum + square(number)) * (1.0 / count)
    }

    /// The edge of a hole is half way between texels, and as wide as the sample.
    fn sharp<V: Mean>(&self, read: V, side: f64) -> V {
        let opacity = read.opacity();
        if !self.is_mask || side >= 1.0 || opacity <= 0.0 {
            return read;
        }
        let sharp = 0.5 + (opacity - 0.5) / side.max(1e-9);
        read * (sharp.clamp(0.0, 1.0) / opacity)
    }

    /// Number of a copy, and the share of the next.
    fn level(&self, side: f64) -> (usize, f64) {
        if side <= SPREAD {
            return (0, 0.0);
        }
        let coarsest = (self.levels.len() - 1) as f64;
        let level = libm::log2(side / SPREAD).min(coarsest);
        (level as usize, level.fract())
    }

    fn read<V: Mean>(
        &self,
        place: [f64; 2],
        (finer, rest): (usize, f64),
        of: impl Fn([u8; 4]) -> V + Copy,
    ) -> V {
        let read = self.levels[finer].at(place, self.wrap, of);
        match self.levels.get(finer + 1).filter(|_| rest > 0.0) {
            Some(coarser) => read * (1.0 - rest) + coarser.at(place, self.wrap, of) * rest,
            None => read,
        }
    }
}

/// A square's image in a texture, in texels: squares and product of the rows of its matrix.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Image {
    across: f64,
    product: f64,
    down: f64,
}

impl Image {
    pub(crate) fn by([u, v]: [DVec3; 2]) -> Self {
        Self {
            across: u.length_squared(),
            product: u.dot(v),
            down: v.length_squared(),
        }
    }
}

trait Mean: Copy + Add<Output = Self> + Mul<f64, Output = Self> {
    fn opacity(self) -> f64;
}

impl Mean for f64 {
    fn opacity(self) -> f64 {
        self
    }
}

impl Mean for DVec4 {
    fn opacity(self) -> f64 {
        self.w
    }
}

impl Level {
    /// The mean of a value of the four nearest texels, by their distances.
    fn at<V: Mean>(&self, place: [f64; 2], wrap: [Wrap; 2], of: impl Fn([u8; 4]) -> V) -> V {
        let near = [0, 1].map(|k| {
            let size = self.size[k];
            let (inside, [before, after]) = match wrap[k] {
                Wrap::Repeat => ((place[k] - floor(place[k])).min(1.0), [size - 1, 0]),
                Wrap::Mirror => {
                    let turn = place[k] - 2.0 * floor(place[k] / 2.0);
                    ((1.0 - (turn - 1.0).abs()).max(0.0), [0, size - 1])
                }
                Wrap::Clamp => (place[k].clamp(0.0, 1.0), [0, size - 1]),
            };
            // The middle of the first texel is at 0; from -1/2 to size - 1/2.
            let at = inside * size as f64 - 0.5;
            let low = if at < 0.0 { -1 } else { at as i32 };
            let first = if low < 0 {
                before
            } else {
                (low as usize).min(size - 1)
            };
            let next = if low < 0 { 0 } else { first + 1 };
            let share = at - f64::from(low);
            ([first, if next < size { next } else { after }], share)
        });
        let [(columns, right), (rows, down)] = near;
        let between = |[a, b]: [V; 2], share: f64| a * (1.0 - share) + b * share;
        // Without `map` of arrays, which is a call for each entry.
        let texel = |x: usize, y: usize| of(self.texels[y * self.size[0] + x]);
        let row = |y: usize| between([texel(columns[0], y), texel(columns[1], y)], right);
        between([row(rows[0]), row(rows[1])], down)
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

/// Without a call, for numbers below 2^63.
fn floor(number: f64) -> f64 {
    let whole = number as i64 as f64;
    if whole > number { whole - 1.0 } else { whole }
}

fn opacity([.., alpha]: [u8; 4]) -> f64 {
    f64::from(alpha) / 255.0
}

fn weighted([r, g, b, alpha]: [u8; 4]) -> DVec4 {
    let opacity = opacity([r, g, b, alpha]);
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
        let rows = self.texels_along(corners).map(|along| along * side);
        self.texture.at(self.place(shares), Image::by(rows))
    }

    /// Texels to the right and down in the texture, per unit along the triangle.
    pub(crate) fn texels_along(&self, corners: &[DVec3; 3]) -> [DVec3; 2] {
        let (to_b, to_c) = (corners[1] - corners[0], corners[2] - corners[0]);
        let normal = to_b.cross(to_c);
        let normal = normal / normal.length_squared().max(f64::MIN_POSITIVE);
        let [of_b, of_c] = [to_c.cross(normal), normal.cross(to_b)];
        [0, 1].map(|k| {
            let [a, b, c] = self.places.map(|place| f64::from(place[k]));
            (of_b * (b - a) + of_c * (c - a)) * self.texture.size()[k]
        })
    }

    /// The opacity alone, of a square of so many texels a side.
    pub(crate) fn opacity(&self, shares: [f64; 3], texels: f64) -> f64 {
        let (texture, place) = (self.texture, self.place(shares));
        let read = texture.read(place, texture.level(texels), opacity);
        texture.sharp(read, texels).min(1.0)
    }

    pub(crate) fn place(&self, shares: [f64; 3]) -> [f64; 2] {
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
