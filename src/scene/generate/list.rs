//! The table of generators and their keys.

use super::settings::{Key, Settings};
use super::{maze, shapes, sierpinski, terrain};
use crate::graph::{Graph, Progress, Voxel};

/// The range and default of a generator's key.
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
    /// The keys it takes.
    pub keys: &'static [KeyRange],
    pub(super) shape: Shape,
}

/// A generator's function, which makes the scene.
#[derive(Debug, Clone, Copy)]
pub(super) enum Shape {
    /// Voxel by voxel.
    Voxels(fn(&Settings, &mut dyn FnMut(Voxel), &dyn Progress)),
    /// As a graph with cycles.
    Linked(fn(&Settings) -> Graph),
}

impl Generator {
    /// The range of `key`, if it has that key.
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

const fn voxels(
    name: &'static str,
    keys: &'static [KeyRange],
    make: fn(&Settings, &mut dyn FnMut(Voxel), &dyn Progress),
) -> Generator {
    let shape = Shape::Voxels(make);
    Generator { name, keys, shape }
}

/// All generators, by name; `spec/generators.md` describes them.
pub const GENERATORS: &[Generator] = &[
    voxels("checker", &[depth(6, 1, 10)], shapes::checker),
    voxels("maze", &[depth(7, 2, 12), SEED], maze::voxels),
    voxels("menger", &[depth(5, 1, 8)], shapes::menger),
    voxels("random", &[depth(6, 1, 10), DENSITY, SEED], shapes::random),
    voxels("shell", &[depth(8, 1, 12)], shapes::shell),
    Generator {
        name: "sierpinski",
        keys: &[depth(30, 1, 30)],
        shape: Shape::Linked(sierpinski::graph),
    },
    voxels("sphere", &[depth(7, 1, 10)], shapes::sphere),
    voxels("terrain", &[depth(10, 5, 16), SEED], terrain::voxels),
    voxels("truss", &[depth(8, 4, 12)], shapes::truss),
    voxels("wires", &[depth(8, 4, 12)], shapes::wires),
];
