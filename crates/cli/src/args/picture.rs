//! The picture: size, samples, colours, buffers.

use clap::Args;
use clap::builder::PossibleValuesParser;

use super::setting::{Setting, word};
use super::values::Size;
use shiftvox::picture::{Background, Buffer, Shading};

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
    pub shade: Shading,
    /// Background: sRGB, 0 to 255 each, or none (transparent) [default: 236,239,244]
    #[arg(long, value_name = "R,G,B|none")]
    pub background: Option<Background>,
    /// Buffers to write beside the picture, as {out stem}.{aov}.npy
    #[arg(long, value_enum, value_delimiter = ',', value_name = "LIST")]
    pub aov: Vec<Buffer>,
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
