//! The picture: size, samples, colours, buffers.

use clap::Args;
use clap::builder::PossibleValuesParser;

use super::values::Size;
use shiftvox::picture::{Background, Buffer, Shading};

#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Picture")]
pub(crate) struct PictureArgs {
    /// Pixels, such as 512 (square) or 640x360 [default: 512]
    #[arg(long, value_name = "N|WxH")]
    pub(crate) size: Option<Size>,
    /// Samples per pixel and axis: 1, 2 or 4
    #[arg(long, value_name = "N", default_value = "1",
          value_parser = PossibleValuesParser::new(["1", "2", "4"]))]
    pub(crate) aa: String,
    /// Shading
    #[arg(long, value_enum, default_value_t)]
    pub(crate) shade: Shading,
    /// Background in sRGB, 0 to 255 each, or none (transparent) [default: 236,239,244]
    #[arg(long, value_name = "R,G,B|none")]
    pub(crate) background: Option<Background>,
    /// Buffers to write beside the picture, as {out stem}.{aov}.npy
    #[arg(long, value_enum, value_delimiter = ',', value_name = "LIST")]
    pub(crate) aov: Vec<Buffer>,
}

impl PictureArgs {
    pub(crate) fn size(&self) -> (u32, u32) {
        self.size.unwrap_or(Size::square(512)).pair()
    }

    pub(crate) fn aa_log2(&self) -> u32 {
        match self.aa.as_str() {
            "4" => 2,
            "2" => 1,
            _ => 0,
        }
    }
}
