//! A finished picture.

use std::borrow::Cow;
use std::io::Write;
use std::path::Path;

use hwmodel::count::Counter;

use super::Error;
#[cfg(feature = "png")]
use crate::budget;
use crate::picture::Buffer;
use crate::picture::npy::{self, Values};
use crate::project::Stats;
use crate::whole;

/// A finished picture: colours, the requested [buffers](crate::Renderer::buffers), and the counters of the engine. All
/// have `width() * height()` entries, row by row from the top left. Colours average all samples of a pixel. Depth,
/// normal, voxel and node are those of one sample: the pixel's only one, or the one right of and below its middle.
#[derive(Debug)]
pub struct Picture {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) buffers: Buffers,
    pub(super) counters: Stats,
    pub(super) operations: Option<Counter>,
}

#[derive(Debug)]
pub(super) struct Buffers {
    pub(super) rgba: Vec<[u8; 4]>,
    pub(super) others: Vec<(Buffer, Values)>,
    pub(super) hash: Option<String>,
}

impl Picture {
    /// Pixels across.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Pixels down.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Red, green, blue (sRGB) and alpha, not premultiplied. Alpha is 255 everywhere unless the background is
    /// [`Background::None`](crate::Background::None); then it is the share of the pixel that shows voxels.
    #[must_use]
    pub fn rgba(&self) -> &[[u8; 4]] {
        &self.buffers.rgba
    }

    /// A pixel's colour, as in [`Picture::rgba`]; `None` outside the picture.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 4]> {
        self.buffers.rgba.get(self.at(x, y)?).copied()
    }

    /// Depth along the view axis, world units, at which the sample's ray enters the voxel; infinity without a voxel.
    ///
    /// # Errors
    /// [`Error::Setting`] if the buffer was not requested.
    pub fn depth(&self) -> Result<&[f32], Error> {
        self.floats(Buffer::Depth)
    }

    /// Unit normals in world directions; zero without a voxel.
    ///
    /// # Errors
    /// [`Error::Setting`] if the buffer was not requested.
    pub fn normals(&self) -> Result<&[[f32; 3]], Error> {
        Ok(self.floats(Buffer::Normal)?.as_chunks().0)
    }

    /// Lowest corner of the visible voxel, in units of the finest voxels, and its level (0 for the whole object).
    /// `[0, 0, 0, -1]` without a voxel.
    ///
    /// # Errors
    /// [`Error::Setting`] if the buffer was not requested.
    pub fn voxels(&self) -> Result<&[[i32; 4]], Error> {
        Ok(self.integers(Buffer::Voxel)?.as_chunks().0)
    }

    /// Visible graph node; -1 without one.
    ///
    /// # Errors
    /// [`Error::Setting`] if the buffer was not requested.
    pub fn nodes(&self) -> Result<&[i32], Error> {
        self.integers(Buffer::Node)
    }

    /// The voxel that a pixel shows: its index, in units of the finest voxels, and its level. `None` without a voxel,
    /// and outside the picture.
    ///
    /// # Errors
    /// [`Error::Setting`] if [`Buffer::Voxel`] was not requested.
    pub fn voxel_at(&self, x: u32, y: u32) -> Result<Option<([i32; 3], u32)>, Error> {
        let voxels = self.voxels()?;
        let voxel = self.at(x, y).and_then(|at| voxels.get(at));
        Ok(voxel.and_then(|&[i, j, k, level]| Some(([i, j, k], u32::try_from(level).ok()?))))
    }

    fn at(&self, x: u32, y: u32) -> Option<usize> {
        let is_inside = x < self.width && y < self.height;
        is_inside.then(|| y as usize * self.width as usize + x as usize)
    }

    /// The engine's counters by name. Names differ by engine; all have `samples_drawn`. The fast engine has
    /// `handed_to_machine`, 1, where the machine drew the frame instead, and the reason, such as `handed_for_rule`.
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

    /// The machine's operations by class, width, stage and level, and its memory accesses, if
    /// [`Renderer::count_operations`](super::Renderer::count_operations) requested them.
    #[must_use]
    pub fn operations(&self) -> Option<&Counter> {
        self.operations.as_ref()
    }

    /// A hash of all buffers, 32 hexadecimal digits: the same on every platform.
    ///
    /// # Errors
    /// [`Error::Setting`] if [`Renderer::hashed`](super::Renderer::hashed) did not request it.
    pub fn hash(&self) -> Result<&str, Error> {
        let missing =
            || Error::Setting("the picture has no hash: Renderer::hashed makes it".into());
        self.buffers.hash.as_deref().ok_or_else(missing)
    }

    /// Writes the colours as a PNG. Replaces an existing file; the file appears whole or not at all.
    ///
    /// # Errors
    /// [`Error::Write`] if the system refuses, [`Error::Memory`] if the file does not fit in memory.
    #[cfg(feature = "png")]
    pub fn save_png(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        // The encoder takes memory unasked, seldom more than the pixels.
        let room = budget::room("a PNG file", 2 * self.rgba().len());
        let mut pixels: Vec<[u8; 4]> = room.map_err(Error::Memory)?;
        pixels.extend_from_slice(self.rgba());
        pixels.shrink_to_fit();
        let pixels = crate::picture::Pixels::new(self.width, self.height, pixels);
        whole::write_with(path.as_ref(), true, |file| {
            pixels.write(file).map_err(std::io::Error::other)
        })
        .map_err(|e| Error::Write(e.into()))
    }

    /// Writes a buffer as a NumPy array: `height x width`, times the entries per pixel if there are several. Replaces
    /// an existing file; the file appears whole or not at all.
    ///
    /// # Errors
    /// [`Error::Write`] if the system refuses, [`Error::Setting`] if the buffer was not requested.
    pub fn save_npy(&self, buffer: Buffer, path: impl AsRef<Path>) -> Result<(), Error> {
        let bytes = match buffer {
            Buffer::Color => Cow::Borrowed(self.rgba().as_flattened()),
            other => self.values(other)?.bytes(),
        };
        let mut shape = vec![self.height as usize, self.width as usize];
        if buffer.entries() > 1 {
            shape.push(buffer.entries());
        }
        let header = npy::header(&shape, &buffer.none());
        whole::write_with(path.as_ref(), true, |file| {
            file.write_all(&header)?;
            file.write_all(&bytes)
        })
        .map_err(|e| Error::Write(e.into()))
    }

    /// The colours and the requested buffers, for bindings to other languages.
    #[doc(hidden)]
    #[must_use]
    pub fn into_buffers(self) -> (Vec<[u8; 4]>, Vec<(Buffer, Values)>) {
        (self.buffers.rgba, self.buffers.others)
    }

    pub(super) fn values(&self, buffer: Buffer) -> Result<&Values, Error> {
        let mut others = self.buffers.others.iter();
        let found = others.find(|(other, _)| *other == buffer);
        found.map(|(_, values)| values).ok_or_else(|| {
            let name = buffer.name();
            Error::Setting(format!(
                "the picture has no {name} buffer: Renderer::buffers requests it"
            ))
        })
    }

    fn floats(&self, buffer: Buffer) -> Result<&[f32], Error> {
        match self.values(buffer)? {
            Values::F32(values) => Ok(values),
            Values::I32(_) | Values::U8(_) => Ok(&[]),
        }
    }

    fn integers(&self, buffer: Buffer) -> Result<&[i32], Error> {
        match self.values(buffer)? {
            Values::I32(values) => Ok(values),
            Values::F32(_) | Values::U8(_) => Ok(&[]),
        }
    }
}
