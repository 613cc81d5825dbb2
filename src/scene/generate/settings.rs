//! The numbers that a generated scene is made from.

use std::fmt;

/// A number that a spec can set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Key {
    /// Levels of the scene: it fits a cube of `2^depth` voxels a side. For `menger`, its iterations.
    Depth,
    /// Seed of a random scene.
    Seed,
    /// Share of the voxels that are filled, percent.
    Density,
}

impl Key {
    /// All keys, in the order in which a spec is written.
    pub const ALL: [Self; 3] = [Self::Depth, Self::Density, Self::Seed];

    /// The key as it is written in a spec.
    pub fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Seed => "seed",
            Self::Density => "density",
        }
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The numbers of a spec; a key that the generator does not take is 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Settings {
    /// Levels of the scene (iterations for `menger`).
    pub depth: u32,
    /// Seed of a random scene.
    pub seed: u32,
    /// Filled voxels, percent.
    pub density: u32,
}

impl Settings {
    pub(super) fn of(&self, key: Key) -> u32 {
        match key {
            Key::Depth => self.depth,
            Key::Seed => self.seed,
            Key::Density => self.density,
        }
    }

    pub(super) fn set(&mut self, key: Key, value: u32) {
        match key {
            Key::Depth => self.depth = value,
            Key::Seed => self.seed = value,
            Key::Density => self.density = value,
        }
    }
}
