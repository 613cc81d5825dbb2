//! Conversion between sRGB bytes and linear light, by tables.

use super::Shading;
use super::color::Light;
use super::shade::towards_eye;
use super::sight::Sight;
use crate::budget::{self, Shortage};
use crate::graph::{Graph, PackedNormal};
use crate::project::FrameSetup;
use rayon::prelude::*;
use std::sync::LazyLock;

use crate::srgb::to_linear;

const LIGHTS: usize = 1 << 16;

/// Linear light of the sRGB bytes, 16 bits per channel, and back.
pub struct Linear {
    of: [u16; 256],
    /// For each linear light the byte whose light is nearest. 64 KB, of which a picture uses a part.
    nearest: Box<[u8; LIGHTS]>,
}

impl Linear {
    pub fn tables() -> &'static Self {
        static TABLES: LazyLock<Linear> = LazyLock::new(Linear::new);
        &TABLES
    }

    fn new() -> Self {
        let mut of = [0; 256];
        for (byte, entry) in of.iter_mut().enumerate() {
            *entry = (to_linear(byte as f64 / 255.0) * 65535.0 + 0.5) as u16;
        }
        let mut nearest = Box::new([u8::MAX; LIGHTS]);
        let mut from = 0;
        for byte in 0..255usize {
            // A byte is nearest up to midway to the next; on the middle the brighter one is taken.
            let to = (usize::from(of[byte]) + usize::from(of[byte + 1])).div_ceil(2);
            nearest[from..to].fill(byte as u8);
            from = to;
        }
        Self { of, nearest }
    }

    #[inline]
    pub fn decode(&self, color: [u8; 3]) -> [u32; 3] {
        color.map(|byte| u32::from(self.of[usize::from(byte)]))
    }

    /// The colour whose linear light is nearest; of two the brighter.
    #[inline]
    pub(super) fn encode(&self, light: [u32; 3]) -> [u8; 3] {
        self.encode_16(light.map(|value| value.min(u32::from(u16::MAX))))
    }

    #[inline]
    pub(super) fn encode_16(&self, light: [u32; 3]) -> [u8; 3] {
        light.map(|value| self.nearest[usize::from(value as u16)])
    }
}

/// Linear light by node, 0 to 65535 per channel; empty where the frame's rule does not blend.
///
/// A picture that is shaded afterwards knows the face and the ray of each sample. Here a node has one light for all
/// samples: its normal is turned towards the camera's plane, and a node without one is lit as if it faced the camera.
pub fn lights(
    graph: &Graph,
    setup: &FrameSetup,
    shading: Shading,
) -> Result<Vec<[u16; 3]>, Shortage> {
    if !setup.options.coverage.blends() {
        return Ok(Vec::new());
    }
    let mut lights = budget::room("the light of all nodes", graph.len())?;
    let sight = Sight::new(setup);
    let [_, _, back] = sight.axes();
    let light = Light::new(shading, sight.axes());
    let linear = Linear::tables();
    let lit = |node: u32| {
        let normal = PackedNormal::decode(graph.normal_of(node));
        let normal = normal.map_or(back, |normal| towards_eye(normal, -back));
        let share = light.on(normal);
        let full = linear.decode(graph.color_of(node));
        full.map(|channel| ((channel * share) >> 8) as u16)
    };
    let nodes = 0..graph.len() as u32;
    nodes.into_par_iter().map(lit).collect_into_vec(&mut lights);
    Ok(lights)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_light_becomes_the_nearest_byte_of_two_the_brighter() {
        let linear = Linear::tables();
        assert!(
            linear.of.is_sorted_by(|a, b| a < b),
            "bytes have a light each"
        );
        assert_eq!((linear.of[0], linear.of[255]), (0, u16::MAX));
        for light in 0..=u16::MAX {
            let apart = |byte: &u8| light.abs_diff(linear.of[usize::from(*byte)]);
            let nearest = (0..=255u8).max_by_key(|byte| std::cmp::Reverse(apart(byte)));
            let channel = u32::from(light);
            assert_eq!(
                linear.encode([channel; 3]).map(Some),
                [nearest; 3],
                "{light}"
            );
        }
        assert_eq!(linear.encode([65536, u32::MAX, 0]), [255, 255, 0]);
    }

    #[test]
    fn lights_are_those_of_the_standard() {
        let linear = Linear::tables();
        for byte in 0..=255u8 {
            // By `std`'s own power, which may differ in the last place, never in 16 bits.
            let value = f64::from(byte) / 255.0;
            let light = match byte {
                0..=10 => value / 12.92,
                _ => ((value + 0.055) / 1.055).powf(2.4),
            };
            let expected = (light * 65535.0).round() as u32;
            assert_eq!(linear.decode([byte; 3]), [expected; 3]);
        }
    }
}
