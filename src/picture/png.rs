//! PNG in and out: 8 bits per channel, sRGB.

use std::io::{Cursor, Write};

use png::{BitDepth, ColorType, Compression, Decoder, Encoder, Filter, Limits, Transformations};

pub use super::pixels::Pixels;
pub use png::{DecodingError, EncodingError};

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    pub width: u32,
    pub height: u32,
    pub rgba: Vec<[u8; 4]>,
}

const MAX_SIDE: u32 = crate::project::camera::MAX_SIDE;

impl Pixels {
    /// Writes a PNG file. Fails if the picture is empty or its size does not fit its pixels, and those of `to`.
    pub fn write(&self, to: impl Write) -> Result<(), EncodingError> {
        let mut encoder = Encoder::new(to, self.width, self.height);
        encoder.set_color(match self.has_alpha {
            true => ColorType::Rgba,
            false => ColorType::Rgb,
        });
        encoder.set_depth(BitDepth::Eight);
        encoder.set_compression(Compression::Fast);
        encoder.set_filter(Filter::Adaptive);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.bytes)?;
        writer.finish()
    }
}

/// The bytes of a PNG file; without an alpha channel if all pixels are opaque. Fails if the picture is empty or its
/// size does not fit its pixels.
pub fn encode(width: u32, height: u32, rgba: &[[u8; 4]]) -> Result<Vec<u8>, EncodingError> {
    let mut bytes = Vec::new();
    Pixels::new(width, height, rgba.to_vec()).write(&mut bytes)?;
    Ok(bytes)
}

/// Pixels across and down, from a PNG file's header; `None` if the bytes are not a PNG.
pub fn size(bytes: &[u8]) -> Option<(u32, u32)> {
    let header = bytes.strip_prefix(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR")?;
    let (width, rest) = header.split_first_chunk()?;
    let (height, _) = rest.split_first_chunk()?;
    Some((u32::from_be_bytes(*width), u32::from_be_bytes(*height)))
}

/// Reads a PNG file's bytes. Fails if they are not a PNG, or have more than 32768 pixels per side.
pub fn decode(bytes: &[u8]) -> Result<Image, DecodingError> {
    let limits = Limits { bytes: 512 << 20 };
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
    // Palettes and fewer than 8 bits become 8 bits per channel; 16 bits stay.
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info()?;
    let (width, height) = reader.info().size();
    if width > MAX_SIDE || height > MAX_SIDE {
        return Err(DecodingError::LimitsExceeded);
    }
    let size = reader.output_buffer_size();
    let mut bytes = vec![0; size.ok_or(DecodingError::LimitsExceeded)?];
    reader.next_frame(&mut bytes)?;
    let (color, depth) = reader.output_color_type();
    if depth == BitDepth::Sixteen {
        let (channels, _) = bytes.as_chunks::<2>();
        bytes = channels
            .iter()
            .map(|&c| to_8_bits(u16::from_be_bytes(c)))
            .collect();
    }
    let rgba = match color {
        ColorType::Grayscale => bytes.iter().map(|&g| [g, g, g, 255]).collect(),
        ColorType::GrayscaleAlpha => {
            let (pixels, _) = bytes.as_chunks::<2>();
            pixels.iter().map(|&[g, a]| [g, g, g, a]).collect()
        }
        ColorType::Rgba => bytes.as_chunks::<4>().0.to_vec(),
        ColorType::Rgb | ColorType::Indexed => {
            let (pixels, _) = bytes.as_chunks::<3>();
            pixels.iter().map(|&[r, g, b]| [r, g, b, 255]).collect()
        }
    };
    Ok(Image {
        width,
        height,
        rgba,
    })
}

fn to_8_bits(channel: u16) -> u8 {
    ((u32::from(channel) + 128) / 257) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_come_back_and_other_types_are_converted() {
        for alpha in [255, 7] {
            let rgba = vec![[1, 2, 3, 255], [4, 5, 6, alpha]];
            let bytes = encode(2, 1, &rgba).unwrap();
            let image = decode(&bytes).unwrap();
            assert_eq!(size(&bytes), Some((2, 1)));
            assert_eq!((image.width, image.height, image.rgba), (2, 1, rgba));
        }
        assert!(decode(b"not a picture").is_err() && size(b"not a picture").is_none());
        let sixteen = [0x01, 0x7f, 0xff, 0xff, 0x01, 0x82, 0x80, 0x00];
        for (color, depth, data, expected) in [
            (
                ColorType::Grayscale,
                BitDepth::One,
                &[0x40][..],
                [[0, 0, 0, 255], [255; 4]],
            ),
            (
                ColorType::Indexed,
                BitDepth::One,
                &[0x80],
                [[6, 5, 4, 255], [9, 8, 7, 255]],
            ),
            (
                ColorType::GrayscaleAlpha,
                BitDepth::Sixteen,
                &sixteen,
                [[1, 1, 1, 255], [2, 2, 2, 128]],
            ),
        ] {
            let mut bytes = Vec::new();
            let mut encoder = Encoder::new(&mut bytes, 2, 1);
            encoder.set_color(color);
            encoder.set_depth(depth);
            encoder.set_palette(&[9, 8, 7, 6, 5, 4][..]);
            let mut writer = encoder.write_header().unwrap();
            writer.write_image_data(data).unwrap();
            writer.finish().unwrap();
            assert_eq!(decode(&bytes).unwrap().rgba, expected);
        }
    }
}
