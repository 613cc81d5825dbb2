//! Generated scenes, made from a few numbers in integers only: the same voxels on every machine. `spec/generators.md`
//! describes the generators and their keys.

mod list;
mod maze;
mod shapes;
mod spec;
mod terrain;

pub use list::{GENERATORS, Generator, KeyRange, Settings};
pub use spec::{PREFIX, Spec, SpecError};

const PALETTE: [[u8; 3]; 8] = [
    [214, 96, 77],
    [244, 165, 96],
    [230, 205, 120],
    [134, 184, 106],
    [78, 154, 148],
    [67, 120, 178],
    [126, 97, 168],
    [190, 110, 150],
];

fn palette(which: u32) -> [u8; 3] {
    PALETTE[which as usize % PALETTE.len()]
}

/// A light colour that grows with the position in a cube of `side` voxels.
fn gradient(index: [i32; 3], side: i32) -> [u8; 3] {
    index.map(|i| (70 + i64::from(i) * 170 / i64::from(side)) as u8)
}

/// The benchmark's hash of two coordinates and a seed.
#[inline]
fn hash(a: u32, b: u32, seed: u32) -> u32 {
    let mut h =
        a.wrapping_mul(0x9E37_79B1) ^ b.wrapping_mul(0x85EB_CA77) ^ seed.wrapping_mul(0xC2B2_AE3D);
    h ^= h >> 15;
    h = h.wrapping_mul(0x2C1B_3C6D);
    h ^= h >> 12;
    h = h.wrapping_mul(0x297A_2D39);
    h ^ h >> 15
}
