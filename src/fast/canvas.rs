//! The picture in progress: masks of open samples, and their contents.
//!
//! Masks have a bit per open sample, in words of 8 x 8 samples (tiles). Samples outside the picture count as drawn.
//! Squares (`directions.rs`) lie anywhere.

use super::lanes::{Isa, Scalar};
use super::window::{ALL, LEFT_COLUMN, TILE_LOG2, Window, bits};
use crate::budget::{self, Shortage};
use crate::frame::{Blend, NO_NODE, color_word};
use crate::graph::prefetch;

#[derive(Debug)]
pub(super) struct Fill<'p> {
    pub(super) bounds: Window,
    tiles_across: usize,
    first_tile: usize,
    tiles: &'p mut [u64],
    pub(super) open: u64,
}

pub(super) fn tiles_across(width: u32) -> usize {
    (width as usize).div_ceil(1 << TILE_LOG2)
}

/// Makes room for the masks of a picture.
pub(super) fn resize(tiles: &mut Vec<u64>, width: u32, height: u32) -> Result<(), Shortage> {
    let across = tiles_across(width);
    // Squares at the end have tiles beyond.
    let length = (height as usize).div_ceil(1 << TILE_LOG2) * across + across + 2;
    if tiles.len() != length {
        *tiles = budget::filled("the open samples of a picture", 0, length)?;
    }
    Ok(())
}

static COLUMNS: [u64; 9] = {
    let mut masks = [0; 9];
    let mut i = 0;
    while i <= 8 {
        masks[i] = (0xff >> (8 - i)) * LEFT_COLUMN;
        i += 1;
    }
    masks
};

/// The first rows and columns of a tile, by `8 * (rows - 1) + columns - 1`.
static SQUARES: [u64; 64] = {
    let mut masks = [0; 64];
    let mut rows = 0;
    while rows < 8 {
        let mut columns = 0;
        while columns < 8 {
            masks[8 * rows + columns] =
                ((0xff >> (7 - columns)) * LEFT_COLUMN) & (ALL >> (56 - 8 * rows));
            columns += 1;
        }
        rows += 1;
    }
    masks
};

impl<'p> Fill<'p> {
    pub(super) fn clear(tiles_across: usize, bounds: Window, tiles: &'p mut [u64]) -> Self {
        let across = (bounds.right - bounds.left + 1) as u64;
        let down = (bounds.bottom - bounds.top + 1) as u64;
        let fill = Self {
            bounds,
            tiles_across,
            first_tile: (bounds.top >> TILE_LOG2) as usize * tiles_across,
            tiles,
            open: across * down,
        };
        fill.tiles.fill(0);
        let tiles = bounds.coarser(TILE_LOG2);
        for y in tiles.top..=tiles.bottom {
            for x in tiles.left..=tiles.right {
                let at = fill.tile_at(x, y);
                fill.tiles[at] = bounds.bits(x << TILE_LOG2, y << TILE_LOG2);
            }
        }
        fill
    }

    #[inline(always)]
    fn tile_at(&self, x: i32, y: i32) -> usize {
        let from_top = (y as usize).wrapping_mul(self.tiles_across);
        from_top
            .wrapping_add(x as usize)
            .wrapping_sub(self.first_tile)
    }

    #[inline(always)]
    fn tile(&self, at: usize) -> u64 {
        self.tiles.get(at).copied().unwrap_or(0)
    }

    #[inline(always)]
    pub(super) fn open_in_square(&self, window: &Window) -> u64 {
        let (x, y) = ((window.left & 7) as u32, (window.top & 7) as u32);
        let more_x = (window.right - window.left) as usize;
        let more_y = (window.bottom - window.top) as usize;
        let at = self.tile_at(window.left >> TILE_LOG2, window.top >> TILE_LOG2);
        let below = at.wrapping_add(self.tiles_across);
        let [a, b, c, d] = match self.tiles.get(at..below.wrapping_add(2)) {
            Some(tiles) => [tiles[0], tiles[1], tiles[below - at], tiles[below - at + 1]],
            None => [at, at + 1, below, below + 1].map(|at| self.tile(at)),
        };
        let up = |upper: u64, lower: u64| upper >> (8 * y) | lower << 1 << (63 - 8 * y);
        let (left, right) = (up(a, c) >> x, up(b, d) << 1 << (7 - x));
        let own = COLUMNS[8 - x as usize];
        ((left ^ right) & own ^ right) & SQUARES[(more_y << 3 | more_x) & 63]
    }

    #[inline(always)]
    fn mark_at(&mut self, at: usize, samples: u64) {
        if let Some(tile) = self.tiles.get_mut(at) {
            *tile &= !samples;
        }
    }

    #[inline(always)]
    pub(super) fn mark_tile(&mut self, x: i32, y: i32, samples: u64) {
        self.open -= u64::from(samples.count_ones());
        self.mark_at(self.tile_at(x, y), samples);
    }

    #[inline(always)]
    pub(super) fn mark_square(&mut self, window: &Window, samples: u64) {
        let (x, y) = ((window.left & 7) as u32, (window.top & 7) as u32);
        let (tile_x, tile_y) = (window.left >> TILE_LOG2, window.top >> TILE_LOG2);
        self.open -= u64::from(samples.count_ones());
        let at = self.tile_at(tile_x, tile_y);
        if window.right >> TILE_LOG2 == tile_x && window.bottom >> TILE_LOG2 == tile_y {
            self.mark_at(at, samples << (8 * y + x));
            return;
        }
        let below = at.wrapping_add(self.tiles_across);
        let left = samples << x & !COLUMNS[x as usize];
        let right = samples >> 1 >> (7 - x) & COLUMNS[x as usize];
        self.mark_at(at, left << (8 * y));
        self.mark_at(at.wrapping_add(1), right << (8 * y));
        let [left, right] = [left, right].map(|samples| samples >> 1 >> (63 - 8 * y));
        self.mark_at(below, left);
        self.mark_at(below.wrapping_add(1), right);
    }

    #[inline(always)]
    pub(super) fn open_in_tile(&self, x: i32, y: i32, window: &Window) -> u64 {
        self.tile(self.tile_at(x, y)) & window.bits(x << TILE_LOG2, y << TILE_LOG2)
    }

    /// Whether a sample of a window may be open. In windows larger than a tile, tiles that are not full count as open.
    #[inline(always)]
    pub(super) fn is_open(&self, window: &Window) -> bool {
        if window.right - window.left < 8 && window.bottom - window.top < 8 {
            return self.open_in_square(window) != 0;
        }
        let tiles = window.coarser(TILE_LOG2);
        (tiles.top..=tiles.bottom).any(|y| {
            let row = self.tile_at(tiles.left, y)..=self.tile_at(tiles.right, y);
            self.tiles[row].iter().any(|&tile| tile != 0)
        })
    }
}

#[derive(Debug)]
pub(super) struct Pixels<'f> {
    pub(super) width: usize,
    pub(super) top: i32,
    pub(super) shown: &'f mut [u32],
    /// Colours by node; empty where nodes are wanted.
    pub(super) color: &'f [[u8; 3]],
    /// Empty where voxels are not wanted.
    pub(super) voxel: &'f mut [[i32; 4]],
    pub(super) blend: &'f mut [Blend],
}

impl Pixels<'_> {
    #[inline(always)]
    pub(super) fn wants_voxels(&self) -> bool {
        !self.voxel.is_empty()
    }

    #[inline(always)]
    pub(super) fn word(&self, node: u32) -> u32 {
        if self.color.is_empty() {
            return node;
        }
        let color = self.color.get(node as usize);
        color.map_or(0, |&color| color_word(color))
    }

    #[inline(always)]
    pub(super) fn at(&self, x: i32, y: i32) -> usize {
        (y - self.top) as usize * self.width + x as usize
    }

    #[inline(always)]
    pub(super) fn set(&mut self, at: usize, word: u32) {
        if let Some(shown) = self.shown.get_mut(at) {
            *shown = word;
        }
    }

    /// Begins to read a square's rows, because [`Pixels::write`] reads what it does not change.
    #[inline(always)]
    pub(super) fn prefetch(&self, square: &Window) {
        let first = self.at(square.left, square.top);
        (0..8).for_each(|row| prefetch(self.shown, first + row * self.width));
    }

    /// Writes words at samples of a square; `step` from a row's words to the next row's.
    #[inline(always)]
    pub(super) fn write<I: Isa>(
        &mut self,
        isa: I,
        [x, y]: [i32; 2],
        samples: u64,
        words: &[u32],
        step: usize,
    ) {
        let (first, width) = (self.at(x, y), self.width);
        match self.shown.get_mut(first..first + 7 * width + 8) {
            Some(rows) => isa.store_masked(rows, width, samples, words, step),
            None => Scalar.store_masked(&mut self.shown[first..], width, samples, words, step),
        }
    }

    #[inline(always)]
    pub(super) fn show<I: Isa>(
        &mut self,
        isa: I,
        [x, y]: [i32; 2],
        samples: u64,
        node: u32,
        voxel: [i32; 4],
    ) {
        self.write(isa, [x, y], samples, &[self.word(node); 8], 0);
        if self.wants_voxels() {
            let first = self.at(x, y);
            for bit in bits(samples) {
                self.voxel[first + (bit >> 3) * self.width + (bit & 7)] = voxel;
            }
        }
    }

    /// Before drawing: clears voxels, and the nodes of a blended picture, whose drawn samples may stay open.
    pub(super) fn clear(&mut self) {
        if !self.blend.is_empty() {
            self.shown.fill(NO_NODE);
        }
        self.voxel.fill(crate::frame::NO_VOXEL);
    }

    /// After drawing: clears the samples that are still open, so that others are written once.
    pub(super) fn clear_open(&mut self, fill: &Fill<'_>) {
        if !self.blend.is_empty() {
            return;
        }
        let nothing = if self.color.is_empty() { NO_NODE } else { 0 };
        let rows = self.shown.chunks_mut(self.width << TILE_LOG2);
        for (rows, tiles) in rows.zip(fill.tiles.chunks(fill.tiles_across)) {
            for (x, &open) in tiles.iter().enumerate() {
                if open == ALL {
                    for row in rows.chunks_mut(self.width) {
                        row[8 * x..][..8].fill(nothing);
                    }
                    continue;
                }
                for bit in bits(open) {
                    rows[(bit >> 3) * self.width + 8 * x + (bit & 7)] = nothing;
                }
            }
        }
    }
}
