//! Textures and opacities of the triangles of a file (`spec/far.md`, File).

use std::collections::HashMap;
use std::sync::Arc;

use glam::DVec3;

use super::{Sampler, Texture};
use crate::Triangle;

/// Texture and opacity of a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paint {
    /// Its number in the file, or 65,535 for none. Its colours are factors of the triangle's.
    pub texture: u16,
    /// 1 to 255: opaque.
    pub alpha: u8,
    /// Of the corners in the texture.
    pub places: [[f32; 2]; 3],
}

pub(crate) const NO_TEXTURE: u16 = u16::MAX;
pub(crate) const PAINT_BYTES: usize = 27;

impl Paint {
    /// Of opaque triangles without texture.
    pub const NONE: Self = Self {
        texture: NO_TEXTURE,
        alpha: 255,
        places: [[0.0; 2]; 3],
    };

    pub(crate) fn to_bytes(self) -> [u8; PAINT_BYTES] {
        let mut bytes = [0; PAINT_BYTES];
        bytes[..2].copy_from_slice(&self.texture.to_le_bytes());
        bytes[2] = self.alpha;
        let places = self.places.as_flattened().iter();
        for (to, place) in bytes[3..].chunks_exact_mut(4).zip(places) {
            to.copy_from_slice(&place.to_le_bytes());
        }
        bytes
    }

    /// `None` if a place is not finite.
    pub(crate) fn from_bytes(bytes: &[u8; PAINT_BYTES]) -> Option<Self> {
        let number = |at: usize| {
            let bytes = [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]];
            f32::from_le_bytes(bytes)
        };
        let paint = Self {
            texture: u16::from_le_bytes([bytes[0], bytes[1]]),
            alpha: bytes[2],
            places: [3, 11, 19].map(|at| [number(at), number(at + 4)]),
        };
        let places = paint.places.as_flattened();
        places.iter().all(|c| c.is_finite()).then_some(paint)
    }

    /// Whether its texture is one of so many.
    pub(crate) fn is_of(&self, textures: usize) -> bool {
        usize::from(self.texture) < textures || self.texture == NO_TEXTURE
    }

    pub(crate) fn opacity(&self) -> f64 {
        f64::from(self.alpha) / 255.0
    }

    pub(crate) fn sampler<'t>(&self, textures: &'t [Arc<Texture>]) -> Option<Sampler<'t>> {
        let texture = textures.get(usize::from(self.texture))?;
        let places = self.places;
        Some(Sampler { texture, places })
    }

    pub(crate) fn is_opaque(&self, textures: &[Arc<Texture>]) -> bool {
        let texture = textures.get(usize::from(self.texture));
        self.alpha == 255 && texture.is_none_or(|texture| texture.is_opaque())
    }
}

/// The textures of a surface, numbered.
pub(crate) struct Textures {
    pub(crate) list: Vec<Arc<Texture>>,
    /// By address.
    numbers: HashMap<usize, u16>,
}

impl Textures {
    pub(crate) fn new(mut list: Vec<Arc<Texture>>) -> Self {
        list.truncate(usize::from(NO_TEXTURE));
        let addresses = list.iter().map(|texture| Arc::as_ptr(texture).addr());
        let numbers = addresses.zip(0..).collect();
        Self { list, numbers }
    }

    /// Of a triangle, and the colours of its corners.
    pub(crate) fn paint(&self, triangle: &Triangle<'_>) -> (Paint, [DVec3; 3]) {
        let mut paint = Paint {
            alpha: ((255.0 * triangle.alpha + 0.5) as u8).max(1),
            ..Paint::NONE
        };
        let number = |sampler: &Sampler<'_>| {
            let address = std::ptr::from_ref(sampler.texture).addr();
            self.numbers.get(&address).copied()
        };
        match triangle
            .sampler
            .as_ref()
            .and_then(|s| Some((number(s)?, s.places)))
        {
            Some((texture, places)) => {
                (paint.texture, paint.places) = (texture, places);
                (paint, triangle.colors)
            }
            None => (paint, triangle.corner_colors()),
        }
    }
}
