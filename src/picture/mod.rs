//! From samples to a picture (`spec/picture.md`): colour, normal, depth, files and the hash. An engine only determines the
//! voxel of each sample, so engines that agree on the voxels agree on every byte.

mod color;
mod hash;
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
pub use hash::{hash, hash_rows};

pub use linear::{Linear, lights};
pub use pixels::Pixels;
pub use resolve::{ResolveError, Resolver, resolve};
pub use rows::{Buffer, Rows};
pub use shade::Shader;

/// `depth` where nothing is seen.
pub const NO_DEPTH: f32 = f32::INFINITY;

/// A finished picture: one entry of each buffer per pixel, row by row from the top left.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    pub width: u32,
    pub height: u32,
    pub rgba: Vec<[u8; 4]>,
    /// View-axis depth in world units at which the pixel's ray enters the voxel; [`NO_DEPTH`] without one.
    pub depth: Vec<f32>,
    /// Unit normal in world directions; zero without a voxel.
    pub normal: Vec<[f32; 3]>,
    /// File index of the lowest corner of the visible voxel, in finest voxels, and its level (0 = root);
    /// `[0, 0, 0, -1]` without a voxel.
    pub voxel: Vec<[i32; 4]>,
    pub node: Vec<i32>,
    /// Records processed for the pixel, if the frame counted them.
    pub records: Option<Vec<f32>>,
}

impl Picture {
    pub fn drawn(&self) -> usize {
        self.node.iter().filter(|&&node| node >= 0).count()
    }
}
