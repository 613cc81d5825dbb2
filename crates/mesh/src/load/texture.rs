//! Textures, as far as they count here: the mean colour of a triangle's part of one.

use std::collections::HashMap;
use std::io::{self, Cursor};
use std::rc::Rc;

use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::MeshBuilder;
use shiftvox::picture::png;
use shiftvox::srgb::to_linear;

const MOST_ACROSS: u32 = 16_384;
const MOST_BYTES: u64 = 1 << 30;
const MOST_SAMPLES: u32 = 48;

#[derive(Debug)]
pub(super) struct Texture {
    width: u32,
    height: u32,
    /// sRGB and opacity, row by row from the top.
    texels: Vec<u8>,
}

impl Texture {
    fn decode(bytes: &[u8], most_bytes: u64) -> Result<Self, String> {
        let (width, height, texels);
        if let Some(size) = png::size(bytes) {
            (width, height) = size;
            check_size(width, height, most_bytes)?;
            let image = png::decode(bytes).map_err(|error| error.to_string())?;
            texels = image.rgba.into_flattened();
        } else if bytes.starts_with(b"\xff\xd8") {
            let failed = |error: DecodeErrors| error.to_string();
            let options = DecoderOptions::default()
                .jpeg_set_out_colorspace(ColorSpace::RGBA)
                .set_max_width(MOST_ACROSS as usize)
                .set_max_height(MOST_ACROSS as usize);
            let mut decoder = JpegDecoder::new_with_options(Cursor::new(bytes), options);
            decoder.decode_headers().map_err(failed)?;
            let size = decoder.dimensions().unwrap_or_default();
            (width, height) = (size.0 as u32, size.1 as u32);
            check_size(width, height, most_bytes)?;
            texels = decoder.decode().map_err(failed)?;
            if texels.len() != 4 * size.0 * size.1 {
                return Err("its colours are not supported".to_owned());
            }
        } else {
            return Err("it is neither PNG nor JPEG".to_owned());
        }
        Ok(Self {
            width,
            height,
            texels,
        })
    }

    /// The mean colour, linear light, of a triangle with these corners: across from the left and down from the top, in
    /// sizes of the picture. Transparent texels count less. Nothing where a corner is no number, or all is transparent.
    pub(super) fn mean(&self, corners: [[f64; 2]; 3]) -> Option<[f32; 3]> {
        if !corners.as_flattened().iter().all(|c| c.is_finite()) {
            return None;
        }
        let size = [f64::from(self.width), f64::from(self.height)];
        let points = corners.map(|corner| [0, 1].map(|k| corner[k] * size[k]));
        let longest =
            (0..3).flat_map(|i| [0, 1].map(|k| (points[i][k] - points[(i + 1) % 3][k]).abs()));
        let steps = (longest.fold(1.0, f64::max).ceil() as u32).min(MOST_SAMPLES);
        let (mut sum, mut weight) = ([0.0; 3], 0.0);
        // The middles of equal small triangles: `steps * steps` of them, half of which stand on their heads.
        for i in 0..steps {
            for j in 0..steps - i {
                for third in 1..=if i + j + 1 < steps { 2 } else { 1 } {
                    let part = |n: u32| (f64::from(n) + f64::from(third) / 3.0) / f64::from(steps);
                    let (b, c) = (part(i), part(j));
                    let shares = [1.0 - b - c, b, c];
                    let at = [0, 1].map(|k| (0..3).map(|n| shares[n] * points[n][k]).sum::<f64>());
                    let [r, g, b, alpha] = self.texel(at);
                    let opacity = f64::from(alpha) / 255.0;
                    for (sum, byte) in sum.iter_mut().zip([r, g, b]) {
                        *sum += to_linear(f64::from(byte) / 255.0) * opacity;
                    }
                    weight += opacity;
                }
            }
        }
        (weight > 0.0).then(|| sum.map(|sum| (sum / weight) as f32))
    }

    fn texel(&self, [across, down]: [f64; 2]) -> [u8; 4] {
        let place = |at: f64, size: u32| {
            (at.floor().rem_euclid(f64::from(size)) as usize).min(size as usize - 1)
        };
        let (x, y) = (place(across, self.width), place(down, self.height));
        self.texels.as_chunks::<4>().0[y * self.width as usize + x]
    }
}

fn check_size(width: u32, height: u32, most_bytes: u64) -> Result<(), String> {
    if width == 0 || height == 0 {
        return Err("it is empty".to_owned());
    }
    let bytes = 4 * u64::from(width) * u64::from(height);
    if width > MOST_ACROSS || height > MOST_ACROSS || bytes > most_bytes {
        return Err(format!("{width} x {height} texels are too many"));
    }
    Ok(())
}

#[derive(Debug, Default)]
pub(super) struct Textures {
    known: HashMap<String, Option<Rc<Texture>>>,
    bytes: u64,
    failed: Vec<(String, String)>,
}

impl Textures {
    pub(super) fn get(
        &mut self,
        name: &str,
        read: impl FnOnce() -> io::Result<Vec<u8>>,
    ) -> Option<Rc<Texture>> {
        if let Some(known) = self.known.get(name) {
            return known.clone();
        }
        let left = MOST_BYTES.saturating_sub(self.bytes);
        let file = read().map_err(|error| error.to_string());
        let texture = file.and_then(|bytes| Texture::decode(&bytes, left));
        let texture = texture.map_err(|reason| self.failed.push((name.to_owned(), reason)));
        let texture = texture.ok().map(Rc::new);
        self.bytes += texture.as_ref().map_or(0, |t| t.texels.len() as u64);
        self.known.insert(name.to_owned(), texture.clone());
        texture
    }

    pub(super) fn tell(&self, builder: &mut MeshBuilder) {
        for (name, reason) in &self.failed {
            builder.warn(format!(
                "the texture {name} cannot be read ({reason}); what has it keeps its plain colour"
            ));
        }
    }
}
