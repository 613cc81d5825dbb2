//! Colours: shading, the background, linear light and the box filter.

use std::str::FromStr;

use glam::DVec3;

/// Dependence of a voxel's colour on its orientation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Shading {
    /// The file's colours.
    Flat,
    /// A key light that moves with the camera, over an ambient floor, by Lambert's law.
    #[default]
    Lambert,
}

/// The picture behind the object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Background {
    /// Transparent pixels.
    None,
    /// A colour, sRGB.
    Color([u8; 3]),
}

impl Default for Background {
    fn default() -> Self {
        Self::Color([236, 239, 244])
    }
}

impl Background {
    pub fn color(self) -> Option<[u8; 3]> {
        match self {
            Self::None => None,
            Self::Color(color) => Some(color),
        }
    }
}

impl FromStr for Background {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "none" {
            return Ok(Self::None);
        }
        let wrong =
            || format!("`{text}` is no background: write R,G,B with 0 to 255 each, or none");
        let parts: Vec<u8> = text
            .split(',')
            .map(|part| part.trim().parse::<u8>())
            .collect::<Result<_, _>>()
            .map_err(|_| wrong())?;
        parts.try_into().map(Self::Color).map_err(|_| wrong())
    }
}

/// The key light in the camera's right, up and back: over the left shoulder, so that the three visible faces of a box
/// differ in brightness.
pub const KEY_LIGHT: DVec3 = DVec3::new(-0.3, 0.6, 0.75);
/// Ambient light, of 256.
pub const AMBIENT: u32 = 64;

#[derive(Clone, Copy)]
pub(super) struct Light {
    /// Direction to the key light. `None`: full light everywhere.
    key: Option<DVec3>,
}

impl Light {
    pub(super) fn new(shading: Shading, axes: [DVec3; 3]) -> Self {
        let key = KEY_LIGHT.normalize();
        Self {
            key: (shading == Shading::Lambert)
                .then(|| axes[0] * key.x + axes[1] * key.y + axes[2] * key.z),
        }
    }

    pub(super) fn is_directed(&self) -> bool {
        self.key.is_some()
    }

    /// The lit share of a surface's colour, of 256.
    pub(super) fn on(&self, normal: DVec3) -> u32 {
        let Some(key) = self.key else { return 256 };
        let cosine = normal.dot(key).clamp(0.0, 1.0);
        AMBIENT + (cosine * f64::from(256 - AMBIENT) + 0.5) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backgrounds() {
        assert_eq!("1, 2,255".parse(), Ok(Background::Color([1, 2, 255])));
        for bad in ["", "1,2", "1,2,256", "1,2,3,4"] {
            assert!(bad.parse::<Background>().is_err(), "{bad}");
        }
    }
}
