//! Scenes made from a few numbers, in integers only: the same voxels on every
//! machine. What each is, and which keys it takes: `spec/generators.md`.

mod checker;
mod color;
mod hash;
mod list;
mod maze;
mod menger;
mod random;
mod shell;
mod sierpinski;
mod spec;
mod sphere;
mod terrain;
mod truss;
mod wires;

pub use list::{GENERATORS, Generator, Key, KeyRange};
pub use spec::{PREFIX, Settings, Spec, SpecError};
