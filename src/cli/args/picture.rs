//! The picture: size, samples, colours, buffers.

use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};

use super::{Setting, Size, word};
use crate::picture::{Background, Buffer, Shading};

/// A buffer that can be written beside the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Aov {
    /// View-axis depth, world units; inf where nothing is seen.
    Depth,
    /// Unit normal in world directions.
    Normal,
    /// File index of the voxel seen, and its level; level -1 where nothing is seen.
    Voxel,
    /// Graph node; -1 where nothing is seen.
    Node,
    /// Records worked on for the pixel.
    Records,
    /// Colour and alpha.
    Color,
}

impl Aov {
    /// The name in file names.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Normal => "normal",
            Self::Voxel => "voxel",
            Self::Node => "node",
            Self::Records => "records",
            Self::Color => "color",
        }
    }

    /// The buffer of a picture that it is.
    pub(in crate::cli) fn buffer(self) -> Buffer {
        match self {
            Self::Depth => Buffer::Depth,
            Self::Normal => Buffer::Normal,
            Self::Voxel => Buffer::Voxel,
            Self::Node => Buffer::Node,
            Self::Records => Buffer::Records,
            Self::Color => Buffer::Color,
        }
    }
}

/// How colours depend on where a voxel looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum ShadeName {
    /// Colours as the file has them.
    Flat,
    /// A key light that moves with the camera, over an ambient floor.
    #[default]
    Lambert,
}

/// The picture.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Picture")]
pub struct PictureArgs {
    /// Pixels: 512 for a square, or 640x360 [default: 512]
    #[arg(long, value_name = "N|WxH")]
    pub size: Option<Size>,
    /// Samples per pixel and axis: 1, 2 or 4
    #[arg(long, value_name = "N", default_value = "1",
          value_parser = PossibleValuesParser::new(["1", "2", "4"]))]
    pub aa: String,
    /// Shading
    #[arg(long, value_enum, default_value_t)]
    pub shade: ShadeName,
    /// What is behind the object: sRGB, 0 to 255 each, or none (transparent) [default: 236,239,244]
    #[arg(long, value_name = "R,G,B|none")]
    pub background: Option<Background>,
    /// Buffers to write beside the picture, as {out stem}.{aov}.npy
    #[arg(long, value_enum, value_delimiter = ',', value_name = "LIST")]
    pub aov: Vec<Aov>,
}

/// Size where none is given.
const DEFAULT_SIDE: u32 = 512;

impl PictureArgs {
    /// Width and height, pixels.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        self.size
            .map_or((DEFAULT_SIDE, DEFAULT_SIDE), |s| (s.width, s.height))
    }

    /// Samples per pixel and axis, as a power of two.
    #[must_use]
    pub fn aa_log2(&self) -> u32 {
        match self.aa.as_str() {
            "4" => 2,
            "2" => 1,
            _ => 0,
        }
    }

    /// Shading of the picture.
    #[must_use]
    pub fn shading(&self) -> Shading {
        match self.shade {
            ShadeName::Flat => Shading::Flat,
            ShadeName::Lambert => Shading::Lambert,
        }
    }

    /// Every setting, for a configuration file.
    #[must_use]
    pub fn settings(&self) -> Vec<Setting> {
        let (width, height) = self.size();
        let background = self.background.unwrap_or_default();
        let mut settings = vec![
            ("size", Size { width, height }.to_string().into()),
            ("aa", i64::from(1 << self.aa_log2()).into()),
            ("shade", word(&self.shade)),
            ("background", background.to_string().into()),
        ];
        if !self.aov.is_empty() {
            let names: Vec<_> = self.aov.iter().map(|aov| aov.name().into()).collect();
            settings.push(("aov", toml::Value::Array(names)));
        }
        settings
    }
}
