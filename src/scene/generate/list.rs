//! The generators that there are, and the keys that each takes.

use super::settings::{Key, Settings};
use super::{checker, maze, menger, random, shell, sierpinski, sphere, terrain, truss, wires};
use crate::graph::{Graph, Progress, Voxel};

/// What a generator takes for a key.
#[derive(Debug, Clone, Copy)]
pub struct KeyRange {
    /// The key.
    pub key: Key,
    /// Its default value.
    pub default: u32,
    /// Least value.
    pub least: u32,
    /// Greatest value.
    pub most: u32,
}

/// One kind of scene.
#[derive(Debug, Clone, Copy)]
pub struct Generator {
    /// Its name in a spec.
    pub name: &'static str,
    /// One line about it.
    pub about: &'static str,
    /// The keys it takes.
    pub keys: &'static [KeyRange],
    pub(super) shape: Shape,
}

/// How a generator gives its scene.
#[derive(Debug, Clone, Copy)]
pub(super) enum Shape {
    /// Voxel by voxel.
    Voxels(fn(&Settings, &mut dyn FnMut(Voxel), &dyn Progress)),
    /// As a graph with cycles.
    Linked(fn(&Settings) -> Graph),
}

impl Generator {
    /// What it takes for `key`, if it takes it.
    #[must_use]
    pub fn range(&self, key: Key) -> Option<&'static KeyRange> {
        self.keys.iter().find(|range| range.key == key)
    }
}

const fn depth(default: u32, least: u32, most: u32) -> KeyRange {
    KeyRange {
        key: Key::Depth,
        default,
        least,
        most,
    }
}

const SEED: KeyRange = KeyRange {
    key: Key::Seed,
    default: 1,
    least: 0,
    most: u32::MAX,
};

const DENSITY: KeyRange = KeyRange {
    key: Key::Density,
    default: 10,
    least: 0,
    most: 100,
};

/// All generators, by name.
pub const GENERATORS: &[Generator] = &[
    Generator {
        name: "checker",
        about: "a three-dimensional checkerboard: every second voxel",
        keys: &[depth(6, 1, 10)],
        shape: Shape::Voxels(checker::voxels),
    },
    Generator {
        name: "maze",
        about: "walls of a perfect maze on a floor",
        keys: &[depth(7, 2, 12), SEED],
        shape: Shape::Voxels(maze::voxels),
    },
    Generator {
        name: "menger",
        about: "Menger's sponge; depth counts iterations, so that depth 5 is 243 voxels a side",
        keys: &[depth(5, 1, 8)],
        shape: Shape::Voxels(menger::voxels),
    },
    Generator {
        name: "random",
        about: "voxels strewn at random; density in percent",
        keys: &[depth(6, 1, 10), DENSITY, SEED],
        shape: Shape::Voxels(random::voxels),
    },
    Generator {
        name: "shell",
        about: "a hollow ball whose shell no path passes, not even over corners",
        keys: &[depth(8, 1, 12)],
        shape: Shape::Voxels(shell::voxels),
    },
    Generator {
        name: "sierpinski",
        about: "Sierpinski's tetrahedron: one node that is four of its own children",
        keys: &[depth(30, 1, 30)],
        shape: Shape::Linked(sierpinski::graph),
    },
    Generator {
        name: "sphere",
        about: "a solid ball",
        keys: &[depth(7, 1, 10)],
        shape: Shape::Voxels(sphere::voxels),
    },
    Generator {
        name: "terrain",
        about: "hills under floating balls, hollow: the benchmark's large scene",
        keys: &[depth(10, 5, 16), SEED],
        shape: Shape::Voxels(terrain::voxels),
    },
    Generator {
        name: "truss",
        about: "a lattice of bars one voxel thin, eight cells a side",
        keys: &[depth(8, 4, 12)],
        shape: Shape::Voxels(truss::voxels),
    },
    Generator {
        name: "wires",
        about: "a fan of 81 wires one voxel thin",
        keys: &[depth(8, 4, 12)],
        shape: Shape::Voxels(wires::voxels),
    },
];
