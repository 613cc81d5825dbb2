//! The table of generators and their keys.

use super::{maze, shapes, terrain};
use crate::graph::{Graph, Progress, Voxel};

#[derive(Debug, Clone, Copy)]
pub struct KeyRange {
    pub key: &'static str,
    pub default: u32,
    pub least: u32,
    pub most: u32,
}

/// The numbers of a spec; a key that the generator does not take is 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Settings {
    /// Levels of the scene: it fits a cube of `2^depth` voxels per side. For `menger`, its iterations.
    pub depth: u32,
    pub seed: u32,
    /// Filled voxels, percent.
    pub density: u32,
}

impl Settings {
    pub(super) fn of(&mut self, key: &str) -> &mut u32 {
        match key {
            "depth" => &mut self.depth,
            "density" => &mut self.density,
            _ => &mut self.seed,
        }
    }
}

#[derive(Debug, Clone, Copy)]
pub struct Generator {
    pub name: &'static str,
    pub keys: &'static [KeyRange],
    pub(super) shape: Shape,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Shape {
    Voxels(fn(&Settings, &mut dyn FnMut(Voxel), &dyn Progress)),
    Linked(fn(&Settings) -> Graph),
}

const fn key(key: &'static str, default: u32, least: u32, most: u32) -> KeyRange {
    KeyRange {
        key,
        default,
        least,
        most,
    }
}

const fn depth(default: u32, least: u32, most: u32) -> KeyRange {
    key("depth", default, least, most)
}

const SEED: KeyRange = key("seed", 1, 0, u32::MAX);
const DENSITY: KeyRange = key("density", 10, 0, 100);

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
        shape: Shape::Linked(shapes::sierpinski),
    },
    voxels("sphere", &[depth(7, 1, 10)], shapes::sphere),
    voxels("terrain", &[depth(10, 5, 16), SEED], terrain::voxels),
    voxels("truss", &[depth(8, 4, 12)], shapes::truss),
    voxels("wires", &[depth(8, 4, 12)], shapes::wires),
];
