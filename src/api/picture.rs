//! What was drawn.

use std::path::Path;

use hwmodel::count::Counter;

use super::Error;
use crate::picture::{self, Buffer, Rows, npy, store};
use crate::project::Stats;

/// A finished picture: buffers of `width() * height()` entries, row by row from the top left, and what the engine
/// counted.
#[derive(Debug)]
pub struct Picture {
    buffers: picture::Picture,
    counters: Stats,
    operations: Option<Counter>,
}

impl Picture {
    pub(super) fn new(
        buffers: picture::Picture,
        counters: Stats,
        operations: Option<Counter>,
    ) -> Self {
        Self {
            buffers,
            counters,
            operations,
        }
    }

    /// Pixels across.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.buffers.width
    }

    /// Pixels down.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.buffers.height
    }

    /// Colours, sRGB, and coverage (0 nothing, 255 all), not premultiplied.
    #[must_use]
    pub fn rgba(&self) -> &[[u8; 4]] {
        &self.buffers.rgba
    }

    /// Depth along the view axis, world units, at which the ray of a pixel's middle enters the voxel; infinity where
    /// nothing is seen.
    #[must_use]
    pub fn depth(&self) -> &[f32] {
        &self.buffers.depth
    }

    /// Unit normals in world directions; zero where nothing is seen.
    #[must_use]
    pub fn normals(&self) -> &[[f32; 3]] {
        &self.buffers.normal
    }

    /// Index, finest voxels of the file, of the lowest corner of the voxel that is seen, and its level (0: the
    /// whole object); `[0, 0, 0, -1]` where nothing is seen.
    #[must_use]
    pub fn voxels(&self) -> &[[i32; 4]] {
        &self.buffers.voxel
    }

    /// Graph node that is seen; -1 where nothing is.
    #[must_use]
    pub fn nodes(&self) -> &[i32] {
        &self.buffers.node
    }

    /// What the engine counted, by name: nodes, samples, what was skipped and why (`spec/lab.md`).
    #[must_use]
    pub fn counters(&self) -> &[(&'static str, u64)] {
        &self.counters
    }

    /// A counter by its name.
    #[must_use]
    pub fn counter(&self, name: &str) -> Option<u64> {
        let mut counters = self.counters.iter();
        counters.find(|(n, _)| *n == name).map(|&(_, count)| count)
    }

    /// The machine's operations by class, width, stage and level, and its memory accesses, where
    /// [`Renderer::count_operations`](super::Renderer::count_operations) was asked for.
    #[must_use]
    pub fn operations(&self) -> Option<&Counter> {
        self.operations.as_ref()
    }

    /// A hash of all buffers, 32 hexadecimal digits: the same on every platform.
    #[must_use]
    pub fn hash(&self) -> String {
        picture::hash(&self.buffers)
    }

    /// Writes the colours as a PNG. Replaces what is there; the file appears whole or not at all.
    ///
    /// # Errors
    /// [`Error::Write`] where the system refuses.
    #[cfg(feature = "png")]
    pub fn save_png(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let picture::Picture { width, height, .. } = self.buffers;
        let pixels = picture::png::Pixels::new(width, height, self.buffers.rgba.clone());
        store::write_with(path.as_ref(), true, |file| {
            pixels.write(file).map_err(std::io::Error::other)
        })?;
        Ok(())
    }

    /// Writes a buffer as an array of NumPy: `height x width`, times the entries of a pixel where it has several.
    ///
    /// # Errors
    /// [`Error::Write`] where the system refuses.
    pub fn save_npy(&self, buffer: Buffer, path: impl AsRef<Path>) -> Result<(), Error> {
        let Ok(values) = self.buffers.rows(buffer, 0..self.height());
        let mut shape = vec![self.height() as usize, self.width() as usize];
        if buffer.entries() > 1 {
            shape.push(buffer.entries());
        }
        store::write(
            path.as_ref(),
            &npy::encode(&npy::Array { shape, values }),
            true,
        )?;
        Ok(())
    }
}
