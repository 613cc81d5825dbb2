//! Pictures of textures: files of BMP, JPEG, PNG, TGA and WebP, each decoded once.

use std::collections::HashMap;
use std::io::{self, Cursor};
use std::rc::Rc;
use std::sync::Arc;

use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, guess_format};

use crate::texture::{AlphaMode, Wrap};
use crate::{MeshBuilder, Texture};

const MOST_ACROSS: u32 = 16_384;
const MOST_BYTES: u64 = 1 << 30;

struct Picture {
    size: [usize; 2],
    /// sRGB and opacity, row by row from the top.
    texels: Vec<[u8; 4]>,
}

impl Picture {
    fn decode(name: &str, bytes: &[u8], most_bytes: u64) -> Result<Self, String> {
        let format = format_of(name, bytes)?;
        let told = |error: ImageError| error.to_string().replace('\n', " ");
        let reader = ImageReader::with_format(Cursor::new(bytes), format);
        let decoder = reader.into_decoder().map_err(told)?;
        let (width, height) = decoder.dimensions();
        if width == 0 || height == 0 {
            return Err("it is empty".to_owned());
        }
        let size = 4 * u64::from(width) * u64::from(height);
        if width > MOST_ACROSS || height > MOST_ACROSS || size > most_bytes {
            return Err(format!(
                "{width} x {height} texels are too many: a side may have {MOST_ACROSS}, and all textures 1 GiB"
            ));
        }
        let picture = DynamicImage::from_decoder(decoder).map_err(told)?;
        let mut texels = picture.into_rgba8().as_chunks::<4>().0.to_vec();
        if format == ImageFormat::Tga {
            read_opacity_bits(bytes, &mut texels);
            // Some programs write 32 bits per texel and mean 24.
            if texels.iter().all(|texel| texel[3] == 0) {
                texels.iter_mut().for_each(|texel| texel[3] = 255);
            }
        }
        Ok(Self {
            size: [width as usize, height as usize],
            texels,
        })
    }
}

/// Whether a JPEG has no end after its first scan. Its decoder fills up what is not there.
fn is_cut(bytes: &[u8]) -> bool {
    let mut rest = bytes.strip_prefix(&[0xff, 0xd8]).unwrap_or_default();
    while let &[0xff, mark, high, low, ..] = rest {
        if mark == 0xda {
            return !rest.windows(2).any(|pair| pair == [0xff, 0xd9]);
        }
        let length = usize::from(u16::from_be_bytes([high, low]));
        rest = rest.get(2 + length..).unwrap_or_default();
    }
    false
}

/// Opacity bits of a TGA of 16 bits that says it has them. The decoder leaves them out, but as a picture of grey and
/// opacity it gives the bytes of a texel.
fn read_opacity_bits(bytes: &[u8], texels: &mut [[u8; 4]]) {
    let (2 | 10, 16, 1) = (bytes[2], bytes[16], bytes[17] & 15) else {
        return;
    };
    let mut bytes = bytes.to_vec();
    bytes[2] += 1;
    bytes[17] += 7;
    let reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Tga);
    let halves = reader.decode().map(DynamicImage::into_luma_alpha8);
    let halves = halves.iter().flat_map(|halves| halves.pixels());
    for (texel, half) in texels.iter_mut().zip(halves) {
        texel[3] = if half.0[1] < 128 { 0 } else { 255 };
    }
}

/// By the first bytes of a file, or for TGA, which has no mark, by its name.
fn format_of(name: &str, bytes: &[u8]) -> Result<ImageFormat, String> {
    let kinds = [1, 2, 3, 9, 10, 11];
    let is_tga = || {
        let is_named = name.to_ascii_lowercase().ends_with(".tga");
        is_named && bytes.get(2).is_some_and(|kind| kinds.contains(kind))
    };
    match guess_format(bytes).ok() {
        Some(format) if format.reading_enabled() => Ok(format),
        Some(format) => Err(format!(
            "it is {}; convert it to PNG, for example with magick, or in glTF with \
             gltf-transform png --formats \"*\"",
            format.extensions_str()[0].to_uppercase()
        )),
        None if bytes.starts_with(b"\xabKTX 20") => {
            Err("it is KTX2; in glTF, convert it with gltf-transform ktxdecompress".to_owned())
        }
        None if is_tga() => Ok(ImageFormat::Tga),
        None => Err("it is not BMP, JPEG, PNG, WebP, or TGA in a file named so".to_owned()),
    }
}

/// The pictures of a texture, by their names.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parts<'n> {
    pub(super) color: Option<&'n str>,
    /// Opacity, if it is not that of the colour.
    pub(super) opacity: Option<&'n str>,
    pub(super) mode: AlphaMode,
    pub(super) wrap: [Wrap; 2],
}

#[derive(Default)]
pub(super) struct Textures {
    pictures: HashMap<String, Option<Rc<Picture>>>,
    /// By their parts.
    made: HashMap<String, Option<Arc<Texture>>>,
    bytes: u64,
    warnings: Vec<String>,
}

impl Textures {
    /// `read` gives the file of a name.
    pub(super) fn get(
        &mut self,
        parts: Parts<'_>,
        read: impl Fn(&str) -> io::Result<Vec<u8>>,
    ) -> Option<Arc<Texture>> {
        let key = format!("{parts:?}");
        if let Some(known) = self.made.get(&key) {
            return known.clone();
        }
        let color = parts.color.and_then(|name| self.picture(name, &read));
        let opacity = parts.opacity.and_then(|name| self.picture(name, &read));
        let made = match (color, opacity) {
            (None, None) => None,
            (Some(color), None) => Some((color.size, color.texels.clone())),
            (color, Some(opacity)) => Some(together(color.as_deref(), &opacity)),
        };
        let made =
            made.map(|(size, texels)| Arc::new(Texture::new(size, texels, parts.mode, parts.wrap)));
        self.made.insert(key, made.clone());
        made
    }

    fn picture(
        &mut self,
        name: &str,
        read: impl Fn(&str) -> io::Result<Vec<u8>>,
    ) -> Option<Rc<Picture>> {
        if let Some(known) = self.pictures.get(name) {
            return known.clone();
        }
        let left = MOST_BYTES.saturating_sub(self.bytes);
        let file = read(name).map_err(|error| error.to_string());
        let picture = file.and_then(|bytes| {
            let picture = Picture::decode(name, &bytes, left)?;
            Ok((picture, is_cut(&bytes)))
        });
        let told = match &picture {
            Ok((_, false)) => None,
            Ok(_) => Some("is cut short: its last part may be grey".to_owned()),
            Err(reason) => Some(format!(
                "cannot be read ({reason}); what has no other picture keeps its plain colour"
            )),
        };
        let told = told.map(|told| format!("the texture {name} {told}"));
        self.warnings.extend(told);
        let picture = picture.ok().map(|(picture, _)| Rc::new(picture));
        self.bytes += picture.as_ref().map_or(0, |p| 4 * p.texels.len() as u64);
        self.pictures.insert(name.to_owned(), picture.clone());
        picture
    }

    pub(super) fn tell(&self, builder: &mut MeshBuilder) {
        for warning in &self.warnings {
            builder.warn(warning);
        }
    }
}

/// A picture's colours, or white, with the opacities of another: its own, or its brightness if it is opaque. It is as
/// large as the larger of the two.
fn together(color: Option<&Picture>, opacity: &Picture) -> ([usize; 2], Vec<[u8; 4]>) {
    let size = [0, 1].map(|k| opacity.size[k].max(color.map_or(0, |color| color.size[k])));
    let is_grey = opacity.texels.iter().all(|texel| texel[3] == 255);
    let texel = |of: &Picture, x: usize, y: usize| {
        let [x, y] = [x * of.size[0] / size[0], y * of.size[1] / size[1]];
        of.texels[y * of.size[0] + x]
    };
    let both = |x, y| {
        let [r, g, b, _] = color.map_or([255; 4], |color| texel(color, x, y));
        let [grey, _, _, alpha] = texel(opacity, x, y);
        [r, g, b, if is_grey { grey } else { alpha }]
    };
    let rows = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| both(x, y)));
    (size, rows.collect())
}
