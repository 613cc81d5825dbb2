//! PNG in and out: 8 bits a channel, sRGB.

use std::io::{BufRead, Cursor, Seek, Write};

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageError, ImageReader, Limits};

pub use super::pixels::Pixels;

/// Colours of a picture, without anything else.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// sRGB and alpha, row by row from the top left.
    pub rgba: Vec<[u8; 4]>,
}

/// Most pixels a side that are read.
const MAX_SIDE: u32 = crate::project::camera::MAX_SIDE;

impl Pixels {
    /// Writes a PNG file's bytes.
    ///
    /// # Errors
    /// When sizes and pixels do not fit together, and those of `to`.
    pub fn write(&self, to: impl Write) -> Result<(), ImageError> {
        let kind = match self.has_alpha {
            true => ExtendedColorType::Rgba8,
            false => ExtendedColorType::Rgb8,
        };
        PngEncoder::new_with_quality(to, CompressionType::Fast, FilterType::Adaptive).write_image(
            &self.bytes,
            self.width,
            self.height,
            kind,
        )
    }
}

/// The bytes of a PNG file; without an alpha channel where all pixels are opaque.
///
/// # Errors
/// When sizes and pixels do not fit together.
pub fn encode(width: u32, height: u32, rgba: &[[u8; 4]]) -> Result<Vec<u8>, ImageError> {
    let mut bytes = Vec::new();
    Pixels::new(width, height, rgba.to_vec()).write(&mut bytes)?;
    Ok(bytes)
}

/// Pixels across and down, as a PNG file's header has them; `None` of what begins otherwise.
#[must_use]
pub fn size(bytes: &[u8]) -> Option<(u32, u32)> {
    let header = bytes.strip_prefix(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR")?;
    let (width, rest) = header.split_first_chunk()?;
    let (height, _) = rest.split_first_chunk()?;
    Some((u32::from_be_bytes(*width), u32::from_be_bytes(*height)))
}

/// Reads a PNG file's bytes.
///
/// # Errors
/// When they are no PNG, or one of more than 32768 pixels a side.
pub fn decode(bytes: &[u8]) -> Result<Image, ImageError> {
    decode_from(Cursor::new(bytes))
}

fn decode_from(input: impl BufRead + Seek) -> Result<Image, ImageError> {
    let mut reader = ImageReader::with_format(input, image::ImageFormat::Png);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    reader.limits(limits);
    let image = reader.decode()?.into_rgba8();
    let (width, height) = image.dimensions();
    Ok(Image {
        width,
        height,
        rgba: image.pixels().map(|pixel| pixel.0).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_come_back() {
        let opaque = vec![[1, 2, 3, 255], [4, 5, 6, 255]];
        let clear = vec![[1, 2, 3, 255], [4, 5, 6, 7]];
        for rgba in [opaque, clear] {
            let bytes = encode(2, 1, &rgba).unwrap();
            let image = decode(&bytes).unwrap();
            assert_eq!(size(&bytes), Some((2, 1)));
            assert_eq!((image.width, image.height, image.rgba), (2, 1, rgba));
        }
        assert!(decode(b"not a picture").is_err());
        assert_eq!(size(b"not a picture"), None);
    }
}
