//! The buffers of a picture in groups of rows, so that files and hashes need no whole buffer in memory.

use std::borrow::Cow;
use std::convert::Infallible;
use std::ops::Range;

use super::Picture;
use super::npy::Values;

hwmodel::named! {
    /// A buffer of a picture: `height x width` entries.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    #[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
    pub enum Buffer {
        /// View-axis depth, world units; inf where nothing is seen.
        ///
        /// Depth: `f32`, world units.
        Depth = "depth",
        /// Unit normal in world directions.
        ///
        /// Unit normal: 3 x `f32`.
        Normal = "normal",
        /// File index of the voxel seen, and its level; level -1 where nothing is seen.
        ///
        /// Voxel's index x, y, z and level: 4 x `i32`.
        Voxel = "voxel",
        /// Graph node; -1 where nothing is seen.
        ///
        /// Graph node: `i32`.
        Node = "node",
        /// Records worked on for the pixel.
        ///
        /// Records worked on: `f32`; zeros where they were not counted, as by [`Renderer`](crate::Renderer).
        Records = "records",
        /// Colour and alpha.
        ///
        /// Red, green, blue and alpha: 4 x `u8`.
        Color = "color",
    }
}

impl Buffer {
    pub fn entries(self) -> usize {
        match self {
            Self::Depth | Self::Node | Self::Records => 1,
            Self::Normal => 3,
            Self::Color | Self::Voxel => 4,
        }
    }

    pub fn none(self) -> Values {
        match self {
            Self::Color => Values::U8(Vec::new()),
            Self::Node | Self::Voxel => Values::I32(Vec::new()),
            Self::Depth | Self::Normal | Self::Records => Values::F32(Vec::new()),
        }
    }
}

const SHARE: u32 = 1 << 17;

pub trait Rows {
    type Error;

    fn size(&self) -> (u32, u32);

    /// Some rows of a buffer. Fails when they cannot be made.
    fn rows(&self, buffer: Buffer, rows: Range<u32>) -> Result<Values, Self::Error>;

    fn steps(&self) -> impl Iterator<Item = Range<u32>> {
        let (width, height) = self.size();
        let step = (SHARE / width.max(1)).max(1);
        { 0..height }
            .step_by(step as usize)
            .map(move |from| from..height.min(from.saturating_add(step)))
    }
}

impl Rows for Picture {
    type Error = Infallible;

    fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    fn rows(&self, buffer: Buffer, rows: Range<u32>) -> Result<Values, Infallible> {
        let pixels =
            self.width as usize * rows.start as usize..self.width as usize * rows.end as usize;
        Ok(match buffer {
            Buffer::Color => Values::U8(self.rgba[pixels].as_flattened().to_vec()),
            Buffer::Depth => Values::F32(self.depth[pixels].to_vec()),
            Buffer::Normal => Values::F32(self.normal[pixels].as_flattened().to_vec()),
            Buffer::Voxel => Values::I32(self.voxel[pixels].as_flattened().to_vec()),
            Buffer::Node => Values::I32(self.node[pixels].to_vec()),
            Buffer::Records => Values::F32(match &self.records {
                Some(records) => records[pixels].to_vec(),
                None => vec![0.0; pixels.len()],
            }),
        })
    }
}

impl Values {
    pub fn bytes(&self) -> Cow<'_, [u8]> {
        if cfg!(target_endian = "little") {
            return Cow::Borrowed(match self {
                Self::U8(values) => values,
                Self::I32(values) => bytemuck::cast_slice(values),
                Self::F32(values) => bytemuck::cast_slice(values),
            });
        }
        Cow::Owned(match self {
            Self::U8(values) => values.clone(),
            Self::I32(values) => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
            Self::F32(values) => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
        })
    }
}
