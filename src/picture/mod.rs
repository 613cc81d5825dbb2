//! From samples to a picture: colour, normal, depth; files; the hash.
//!
//! An engine says which voxel each sample sees and nothing else. What that
//! looks like is made here, once for every engine, so two engines that agree on
//! the voxels agree on every byte of the picture. Rules: `spec/picture.md`.

mod color;
mod error;
mod hash;
mod lights;
mod linear;
pub mod npy;
mod paint;
mod pixels;
#[cfg(feature = "png")]
pub mod png;
mod resolve;
mod rows;
mod shade;
mod shares;
mod sight;

pub use color::{AMBIENT, Background, KEY_LIGHT, Shading};
pub use error::ResolveError;
pub use hash::{hash, hash_rows};
pub use lights::lights;
pub use linear::Linear;
pub use pixels::Pixels;
pub use resolve::{Resolver, resolve};
pub use rows::{Buffer, Rows};
pub use shade::Shader;

/// `depth` where nothing is seen.
pub const NO_DEPTH: f32 = f32::INFINITY;

/// A finished picture: one entry of each buffer for each pixel, row by row
/// from the top left.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Colour, sRGB, and coverage (0 nothing, 255 all), not premultiplied.
    pub rgba: Vec<[u8; 4]>,
    /// View-axis depth in world units at which the pixel's ray enters the
    /// voxel; [`NO_DEPTH`] where nothing is seen.
    pub depth: Vec<f32>,
    /// Unit normal in world directions; zero where nothing is seen.
    pub normal: Vec<[f32; 3]>,
    /// Index, in the file's finest voxels, of the lowest corner of the voxel
    /// seen, and its level (0 = root); `[0, 0, 0, -1]` where nothing is seen.
    pub voxel: Vec<[i32; 4]>,
    /// Graph node seen; -1 where nothing is seen.
    pub node: Vec<i32>,
    /// Records worked on for the pixel, if the frame counted them.
    pub records: Option<Vec<f32>>,
}

impl Picture {
    /// Pixels that show a voxel at their middle sample.
    #[must_use]
    pub fn drawn(&self) -> usize {
        self.node.iter().filter(|&&node| node >= 0).count()
    }
}
