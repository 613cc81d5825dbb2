//! What was drawn.

use std::path::Path;

use hwmodel::count::Counter;

use super::Error;
use crate::picture::{self, Buffer, Rows, npy};
use crate::project::Stats;
use crate::whole;

/// A finished picture: buffers of `width() * height()` entries, row by row from the top left, and what the engine
/// counted. Colours average all samples of a pixel. Depth, normal, voxel and node are those of one sample: the
/// pixel's only one, or of several the one right of and below its middle.
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

    /// Red, green, blue (sRGB) and alpha, not premultiplied. Alpha is 255 everywhere unless the background is
    /// [`Background::None`](crate::Background::None); then it is the share of the pixel that shows voxels.
    #[must_use]
    pub fn rgba(&self) -> &[[u8; 4]] {
        &self.buffers.rgba
    }

    /// Depth along the view axis, world units, at which the sample's ray enters the voxel; infinity where nothing is
    /// seen.
    #[must_use]
    pub fn depth(&self) -> &[f32] {
        &self.buffers.depth
    }

    /// Unit normals in world directions; zero where nothing is seen.
    #[must_use]
    pub fn normals(&self) -> &[[f32; 3]] {
        &self.buffers.normal
    }

    /// Lowest corner of the voxel that is seen, in units of the finest voxels, and its level (0: the
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

    /// What the engine counted, by name. Names differ by engine; all have `samples_drawn`. The fast engine has
    /// `handed_to_machine`, 1, where it could not draw the frame itself, and why ([`Declined::counter`]).
    ///
    /// [`Declined::counter`]: crate::Declined::counter
    #[must_use]
    pub fn counters(&self) -> &[(&'static str, u64)] {
        &self.counters
    }

    /// The voxel that a pixel shows: its index, finest voxels of the file, and its level. `None` where nothing is seen,
    /// and outside the picture.
    #[must_use]
    pub fn voxel_at(&self, x: u32, y: u32) -> Option<([i32; 3], u32)> {
        let &[i, j, k, level] = self.buffers.voxel.get(self.at(x, y)?)?;
        Some(([i, j, k], u32::try_from(level).ok()?))
    }

    /// A pixel's colour, as in [`Picture::rgba`]; `None` outside the picture.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 4]> {
        self.buffers.rgba.get(self.at(x, y)?).copied()
    }

    fn at(&self, x: u32, y: u32) -> Option<usize> {
        let is_inside = x < self.width() && y < self.height();
        is_inside.then(|| y as usize * self.width() as usize + x as usize)
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

    /// The buffers themselves, for bindings to other languages.
    #[doc(hidden)]
    #[must_use]
    pub fn into_buffers(self) -> picture::Picture {
        self.buffers
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
        whole::write_with(path.as_ref(), true, |file| {
            pixels.write(file).map_err(std::io::Error::other)
        })
        .map_err(|e| Error::Write(e.into()))
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
        let bytes = npy::encode(&npy::Array { shape, values });
        whole::write(path.as_ref(), &bytes, true).map_err(|e| Error::Write(e.into()))
    }
}
