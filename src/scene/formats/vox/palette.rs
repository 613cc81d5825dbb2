//! The colours of colour indices.
//!
//! Index 0 is no voxel. Index `i` is entry `i - 1` of the file's palette, whose 256th entry some exporters omit. Alpha
//! is ignored: exporters write 255 or 0 arbitrarily. `IMAP` changes no colour.

use super::AGAIN;
use super::chunk::Chunk;
use crate::scene::fault::Fault;

#[derive(Debug, Clone)]
pub(super) struct Palette {
    rgba: [[u8; 4]; 256],
    /// Entries in the file, 0 without a palette.
    pub given: usize,
}

impl Palette {
    /// MagicaVoxel's own: the cube of six steps without black, brightest first, then shades of red, green, blue and grey.
    pub(super) fn default_colors() -> Self {
        const SHADES: [u8; 10] = [0xee, 0xdd, 0xbb, 0xaa, 0x88, 0x77, 0x55, 0x44, 0x22, 0x11];
        let mut rgba = [[0, 0, 0, 0]; 256];
        for (i, entry) in rgba[1..=215].iter_mut().enumerate() {
            let step = |by: usize| 255 - 51 * (i / by % 6) as u8;
            *entry = [step(36), step(6), step(1), 255];
        }
        for (i, shade) in SHADES.into_iter().enumerate() {
            rgba[216 + i] = [shade, 0, 0, 255];
            rgba[226 + i] = [0, shade, 0, 255];
            rgba[236 + i] = [0, 0, shade, 255];
            rgba[246 + i] = [shade, shade, shade, 255];
        }
        Self { rgba, given: 0 }
    }

    pub(super) fn read(chunk: &Chunk<'_>) -> Result<Self, Box<Fault>> {
        let (entries, rest) = chunk.content.as_chunks::<4>();
        if !rest.is_empty() || entries.len() > 256 {
            return Err(Fault::new(
                "chunk RGBA",
                chunk.offset as u64,
                "a palette of at most 256 entries of 4 bytes",
                format!("{} bytes", chunk.content.len()),
                AGAIN,
            ));
        }
        let mut palette = Self::default_colors();
        palette.given = entries.len();
        for (slot, entry) in palette.rgba[1..].iter_mut().zip(entries) {
            *slot = *entry;
        }
        Ok(palette)
    }

    #[inline]
    pub(super) fn color(&self, index: u8) -> [u8; 3] {
        let [r, g, b, _] = self.rgba[usize::from(index)];
        [r, g, b]
    }

    pub(super) fn entries(&self) -> &[[u8; 4]] {
        &self.rgba[1..=self.given.min(255)]
    }
}
