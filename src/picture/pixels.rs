//! The colours of a finished picture.

/// Colours of a picture in the form of a file: without an alpha channel if all pixels are opaque.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pixels {
    pub(super) width: u32,
    pub(super) height: u32,
    /// Red, green, blue, and alpha if there is one, row by row from the top left.
    pub(super) bytes: Vec<u8>,
    pub(super) has_alpha: bool,
}

impl Pixels {
    pub fn opaque(width: u32, height: u32, rgb: Vec<[u8; 3]>) -> Self {
        Self {
            width,
            height,
            bytes: rgb.into_flattened(),
            has_alpha: false,
        }
    }

    pub fn new(width: u32, height: u32, rgba: Vec<[u8; 4]>) -> Self {
        let has_alpha = rgba.iter().any(|pixel| pixel[3] != 255);
        let mut bytes = rgba.into_flattened();
        if !has_alpha {
            let pixels = bytes.len() / 4;
            for pixel in 1..pixels {
                bytes.copy_within(4 * pixel..4 * pixel + 3, 3 * pixel);
            }
            bytes.truncate(3 * pixels);
        }
        Self {
            width,
            height,
            bytes,
            has_alpha,
        }
    }

    pub fn rgba(&self) -> Vec<[u8; 4]> {
        let (with_alpha, _) = self.bytes.as_chunks::<4>();
        let (opaque, _) = self.bytes.as_chunks::<3>();
        match self.has_alpha {
            true => with_alpha.to_vec(),
            false => opaque.iter().map(|&[r, g, b]| [r, g, b, 255]).collect(),
        }
    }

    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }
}
