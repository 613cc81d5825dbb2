//! Generated scenes, made from a few numbers in integers only: the same voxels on every machine. `spec/generators.md`
//! describes the generators and their keys.

mod checker;
mod color;
mod hash;
mod list;
mod maze;
mod menger;
mod random;
mod settings;
mod shell;
mod sierpinski;
mod spec;
mod sphere;
mod terrain;
mod truss;
mod wires;

pub use list::{GENERATORS, Generator, KeyRange};
pub use settings::{Key, Settings};
pub use spec::{PREFIX, Spec, SpecError};
