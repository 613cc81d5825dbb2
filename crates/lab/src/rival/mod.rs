//! The rival of the light hardware: a ray caster with integers, adders and shifts alone.
//!
//! One ray per sample walks the octree from cell to cell, and its first voxel is drawn. The walk needs no division and no
//! multiplication, because a ray meets the plane `u` of an axis at `(u - o) / d`, and two such times are compared by the
//! sign of
//!
//! ```text
//! D(k) = (u(k) - o(k)) d(k + 1) - (u(k + 1) - o(k + 1)) d(k)        k = 0, 1, 2 (modulo 3)
//! ```
//!
//! for the planes at which a cell ends. Another cell moves planes by sides of cells, powers of two, so `D` changes by
//! shifted components of `d`. From ray to ray, `d` and the moments `o(k) d(k + 1) - o(k + 1) d(k)` change by constants.
//! Axes are mirrored so that `d` is not negative.
//!
//! Rounding: the host rounds those constants once. All else is exact.
//!
//! It is a [`Workload`](hwmodel::cycles::Workload) of the cycle model. Its node format, caches, pixels and outer memory are
//! those of the design that it is compared with. As for that design, the address of a child is not counted.

mod description;
mod order;
mod ray;
mod view;
mod workload;

pub use description::{RayStage, Rival, RivalStack};
pub use workload::{Cast, cast};

/// Bits of a counter of levels, as in the machine.
const LEVEL_BITS: u32 = 6;

#[cfg(test)]
mod tests;
#[cfg(test)]
pub(crate) use tests::views;
