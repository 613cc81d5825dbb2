//! Materials, and colours in linear light.

use std::sync::{Arc, LazyLock};

use glam::DVec3;
use shiftvox::scene::DEFAULT_COLOR;
use shiftvox::srgb::to_linear;

use crate::Texture;
use crate::geometry::point;

/// How the numbers of a colour in a file are meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum ColorSpace {
    /// As shown on a screen.
    #[default]
    Srgb,
    /// In proportion to light, as Blender writes them.
    Linear,
}

/// The surface of a triangle.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Its name in the file.
    pub name: String,
    /// Diffuse colour, linear light, 0 to 1.
    pub diffuse: [f32; 3],
    /// Opacity, 0 to 1. Triangles of opacity 0 are left out.
    pub alpha: f32,
    /// Colour and opacity at each place, factors of the ones above.
    pub texture: Option<Arc<Texture>>,
}

impl Material {
    /// An opaque material of an sRGB colour.
    pub fn of_srgb(name: impl Into<String>, color: [u8; 3]) -> Self {
        Self {
            name: name.into(),
            diffuse: color.map(srgb_to_linear),
            alpha: 1.0,
            texture: None,
        }
    }

    pub(crate) fn default_color() -> Self {
        Self::of_srgb("no material", DEFAULT_COLOR)
    }

    /// White, for triangles that have the colours of their vertices and no material.
    pub(crate) fn vertex_colors() -> Self {
        Self::of_srgb("vertex colours", [255; 3])
    }

    /// A material from numbers of a file, which are clamped to 0 to 1.
    pub fn of_numbers(
        name: impl Into<String>,
        color: [f32; 3],
        space: ColorSpace,
        alpha: f32,
    ) -> Self {
        let unit = |value: f32| if value >= 0.0 { value.min(1.0) } else { 0.0 };
        Self {
            name: name.into(),
            diffuse: color.map(|value| match space {
                ColorSpace::Linear => unit(value),
                ColorSpace::Srgb => to_linear(f64::from(unit(value))) as f32,
            }),
            alpha: if alpha.is_nan() { 1.0 } else { unit(alpha) },
            texture: None,
        }
    }
}

static LINEAR: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| to_linear(byte as f64 / 255.0) as f32));

/// Linear light of an sRGB byte.
pub fn srgb_to_linear(byte: u8) -> f32 {
    LINEAR[usize::from(byte)]
}

const SLOTS: usize = 4096;

/// For each step of light the first byte whose light is not below it.
static FIRST: LazyLock<[u8; SLOTS]> = LazyLock::new(|| {
    std::array::from_fn(|slot| {
        let light = slot as f64 / SLOTS as f64;
        LINEAR.partition_point(|&entry| f64::from(entry) < light) as u8
    })
});

/// The sRGB byte whose linear light is nearest; of two the brighter.
pub fn linear_to_srgb(light: f64) -> u8 {
    let table: &[f32; 256] = &LINEAR;
    // NaN becomes 0, which is black.
    let slot = ((light * SLOTS as f64) as usize).min(SLOTS - 1);
    let mut above = usize::from(FIRST[slot]);
    while above < 256 && f64::from(table[above]) < light {
        above += 1;
    }
    match above {
        0 => 0,
        256 => 255,
        _ => {
            let to_above = f64::from(table[above]) - light;
            let to_below = light - f64::from(table[above - 1]);
            above as u8 - u8::from(to_above > to_below)
        }
    }
}

pub(crate) fn to_light(bytes: [u8; 3]) -> DVec3 {
    point(bytes.map(srgb_to_linear))
}

pub(crate) fn to_srgb(light: DVec3) -> [u8; 3] {
    light.to_array().map(linear_to_srgb)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_becomes_the_nearest_byte_and_numbers_become_light() {
        let steps = (-100..20_300).map(|step| f64::from(step) / 20_000.0);
        let bytes = (0..=255).map(|byte| f64::from(srgb_to_linear(byte)));
        for light in steps.chain(bytes) {
            let distance = |byte: &u8| (f64::from(srgb_to_linear(*byte)) - light).abs();
            let nearest = (0..=255u8).rev();
            let nearest = nearest.min_by(|a, b| distance(a).total_cmp(&distance(b)));
            assert_eq!(Some(linear_to_srgb(light)), nearest, "{light}");
        }
        assert_eq!([0.5, f64::NAN].map(linear_to_srgb), [188, 0]);
        let srgb = Material::of_numbers("a", [1.5, -1.0, f32::NAN], ColorSpace::Srgb, 2.0);
        assert_eq!((srgb.diffuse, srgb.alpha), ([1.0, 0.0, 0.0], 1.0));
        let linear = Material::of_numbers("b", [0.5, 7.0, 0.0], ColorSpace::Linear, -0.5);
        assert_eq!((linear.diffuse, linear.alpha), ([0.5, 1.0, 0.0], 0.0));
    }
}
