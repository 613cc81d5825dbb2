//! The picture in progress: masks of open samples, and their contents.
//!
//! Masks have a bit per open sample, in words of 8 x 8 samples (tiles), and a bit per tile with open samples, in words of
//! 8 x 8 tiles (blocks). Samples outside the picture count as drawn. Squares (`directions.rs`) lie anywhere.

use super::lanes::{Isa, Scalar};
use super::window::{ALL, BLOCK_LOG2, LEFT_COLUMN, TILE_LOG2, Window, bits};
use crate::budget::{self, Shortage};
use crate::frame::{Blend, NO_NODE, color_word};

const TILES_PER_BLOCK: usize = 1 << (BLOCK_LOG2 - TILE_LOG2);

#[derive(Debug)]
pub(super) struct Fill<'p> {
    pub(super) bounds: Window,
    grid: TileGrid,
    first_tile: usize,
    /// A band may have only the lower tiles of these.
    first_block_row: i32,
    part: FillPart<'p>,
    pub(super) open: u64,
}

#[derive(Debug)]
pub(super) struct FillPart<'p> {
    tiles: &'p mut [u64],
    blocks: &'p mut [u64],
}

fn resize(masks: &mut Vec<u64>, length: usize) -> Result<(), Shortage> {
    if masks.len() != length {
        *masks = budget::filled("the open samples of a picture", 0, length)?;
    }
    Ok(())
}

#[derive(Debug, Default)]
pub(super) struct FillMemory {
    tiles: Vec<u64>,
    blocks: Vec<u64>,
}

impl FillMemory {
    pub(super) fn resize(&mut self, grid: &TileGrid) -> Result<(), Shortage> {
        let beyond = grid.tiles_across + 2;
        let tiles = grid.tiles_down * grid.tiles_across + beyond;
        resize(&mut self.tiles, tiles)?;
        // Each band has its own row of blocks; there may be a band for each row of tiles.
        let block_rows = grid.tiles_down.div_ceil(TILES_PER_BLOCK) + grid.tiles_down;
        resize(&mut self.blocks, block_rows * grid.blocks_across)
    }

    pub(super) fn part(&mut self) -> FillPart<'_> {
        FillPart {
            tiles: &mut self.tiles,
            blocks: &mut self.blocks,
        }
    }
}

impl FillPart<'_> {
    pub(super) fn split(self, grid: &TileGrid, top: usize, rows: usize) -> (Self, Self) {
        let (tiles, tiles_rest) = self.tiles.split_at_mut(rows * grid.tiles_across);
        let block_rows = (top + rows).div_ceil(TILES_PER_BLOCK) - top / TILES_PER_BLOCK;
        let (blocks, blocks_rest) = self.blocks.split_at_mut(block_rows * grid.blocks_across);
        let part = |tiles, blocks| Self { tiles, blocks };
        (part(tiles, blocks), part(tiles_rest, blocks_rest))
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TileGrid {
    pub(super) tiles_across: usize,
    pub(super) tiles_down: usize,
    pub(super) blocks_across: usize,
}

impl TileGrid {
    pub(super) fn new(width: u32, height: u32) -> Self {
        let blocks_across = (width as usize).div_ceil(1 << BLOCK_LOG2);
        Self {
            tiles_across: blocks_across * TILES_PER_BLOCK,
            tiles_down: (height as usize).div_ceil(1 << TILE_LOG2),
            blocks_across,
        }
    }
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
    pub(super) fn clear(grid: &TileGrid, bounds: Window, part: FillPart<'p>) -> Self {
        let across = (bounds.right - bounds.left + 1) as u64;
        let down = (bounds.bottom - bounds.top + 1) as u64;
        let fill = Self {
            bounds,
            grid: *grid,
            first_tile: (bounds.top >> TILE_LOG2) as usize * grid.tiles_across,
            first_block_row: bounds.top >> BLOCK_LOG2,
            part,
            open: across * down,
        };
        fill.part.tiles.fill(0);
        fill.part.blocks.fill(0);
        let tiles = bounds.coarser(TILE_LOG2);
        for y in tiles.top..=tiles.bottom {
            for x in tiles.left..=tiles.right {
                let at = fill.tile_at(x, y);
                fill.part.tiles[at] = bounds.bits(x << TILE_LOG2, y << TILE_LOG2);
                let (block, bit) = fill.block_of(x, y);
                fill.part.blocks[block] |= bit;
            }
        }
        fill
    }

    #[inline(always)]
    fn tile_at(&self, x: i32, y: i32) -> usize {
        let from_top = (y as usize).wrapping_mul(self.grid.tiles_across);
        from_top
            .wrapping_add(x as usize)
            .wrapping_sub(self.first_tile)
    }

    #[inline(always)]
    fn block_of(&self, x: i32, y: i32) -> (usize, u64) {
        let row = ((y >> 3) - self.first_block_row) as usize;
        let at = row * self.grid.blocks_across + (x >> 3) as usize;
        (at, 1u64 << ((y & 7) << 3 | (x & 7)))
    }

    #[inline(always)]
    fn tile(&self, at: usize) -> u64 {
        self.part.tiles.get(at).copied().unwrap_or(0)
    }

    #[inline(always)]
    pub(super) fn open_in_square(&self, window: &Window) -> u64 {
        let (x, y) = ((window.left & 7) as u32, (window.top & 7) as u32);
        let more_x = (window.right - window.left) as usize;
        let more_y = (window.bottom - window.top) as usize;
        let at = self.tile_at(window.left >> TILE_LOG2, window.top >> TILE_LOG2);
        let below = at.wrapping_add(self.grid.tiles_across);
        let [a, b, c, d] = match self.part.tiles.get(at..below.wrapping_add(2)) {
            Some(tiles) => [tiles[0], tiles[1], tiles[below - at], tiles[below - at + 1]],
            None => [at, at + 1, below, below + 1].map(|at| self.tile(at)),
        };
        let up = |upper: u64, lower: u64| upper >> (8 * y) | lower << 1 << (63 - 8 * y);
        let (left, right) = (up(a, c) >> x, up(b, d) << 1 << (7 - x));
        let own = COLUMNS[8 - x as usize];
        ((left ^ right) & own ^ right) & SQUARES[(more_y << 3 | more_x) & 63]
    }

    #[inline(always)]
    fn mark_at(&mut self, at: usize, x: i32, y: i32, samples: u64) {
        if let Some(tile) = self.part.tiles.get_mut(at) {
            *tile &= !samples;
            // No branch for tiles without drawn samples: unpredictable.
            if (*tile == 0) & (samples != 0) {
                let (block, bit) = self.block_of(x, y);
                self.part.blocks[block] &= !bit;
            }
        }
    }

    #[inline(always)]
    pub(super) fn mark_tile(&mut self, x: i32, y: i32, samples: u64) {
        self.open -= u64::from(samples.count_ones());
        self.mark_at(self.tile_at(x, y), x, y, samples);
    }

    #[inline(always)]
    pub(super) fn mark_square(&mut self, window: &Window, samples: u64) {
        let (x, y) = ((window.left & 7) as u32, (window.top & 7) as u32);
        let (tile_x, tile_y) = (window.left >> TILE_LOG2, window.top >> TILE_LOG2);
        self.open -= u64::from(samples.count_ones());
        let at = self.tile_at(tile_x, tile_y);
        if window.right >> TILE_LOG2 == tile_x && window.bottom >> TILE_LOG2 == tile_y {
            self.mark_at(at, tile_x, tile_y, samples << (8 * y + x));
            return;
        }
        let below = at.wrapping_add(self.grid.tiles_across);
        let left = samples << x & !COLUMNS[x as usize];
        let right = samples >> 1 >> (7 - x) & COLUMNS[x as usize];
        self.mark_at(at, tile_x, tile_y, left << (8 * y));
        self.mark_at(at.wrapping_add(1), tile_x + 1, tile_y, right << (8 * y));
        let [left, right] = [left, right].map(|samples| samples >> 1 >> (63 - 8 * y));
        self.mark_at(below, tile_x, tile_y + 1, left);
        self.mark_at(below.wrapping_add(1), tile_x + 1, tile_y + 1, right);
    }

    #[inline(always)]
    pub(super) fn open_in_tile(&self, x: i32, y: i32, window: &Window) -> u64 {
        self.tile(self.tile_at(x, y)) & window.bits(x << TILE_LOG2, y << TILE_LOG2)
    }

    #[inline(always)]
    pub(super) fn has_open_tile(&self, window: &Window) -> bool {
        let tiles = window.coarser(TILE_LOG2);
        let blocks = window.coarser(BLOCK_LOG2);
        if blocks.left == blocks.right && blocks.top == blocks.bottom {
            let shape = (tiles.bottom - tiles.top) << 3 | (tiles.right - tiles.left);
            let row = (blocks.top - self.first_block_row) as usize;
            let at = row * self.grid.blocks_across + blocks.left as usize;
            let first = (tiles.top & 7) << 3 | (tiles.left & 7);
            let wanted = SQUARES[shape as usize & 63] << first;
            return self.part.blocks[at] & wanted != 0;
        }
        let mut y = blocks.top;
        while y <= blocks.bottom {
            let mut x = blocks.left;
            while x <= blocks.right {
                let (at, _) = self.block_of(x << 3, y << 3);
                if self.part.blocks[at] & tiles.bits(x << 3, y << 3) != 0 {
                    return true;
                }
                x += 1;
            }
            y += 1;
        }
        false
    }

    /// Whether a sample of a window may be open. In windows larger than a tile, tiles that are not full count as open.
    #[inline(always)]
    pub(super) fn is_open(&self, window: &Window) -> bool {
        if window.right - window.left < 8 && window.bottom - window.top < 8 {
            return self.open_in_square(window) != 0;
        }
        self.has_open_tile(window)
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
    pub(super) fn show<I: Isa>(
        &mut self,
        isa: I,
        [x, y]: [i32; 2],
        samples: u64,
        node: u32,
        voxel: [i32; 4],
    ) {
        let first = self.at(x, y);
        let word = self.word(node);
        let end = first + 7 * self.width + 8;
        match self.shown.get_mut(first..end) {
            Some(rows) => isa.store_masked(rows, self.width, samples, word),
            None => Scalar.store_masked(&mut self.shown[first..], self.width, samples, word),
        }
        if self.wants_voxels() {
            for bit in bits(samples) {
                self.voxel[first + (bit >> 3) * self.width + (bit & 7)] = voxel;
            }
        }
    }

    pub(super) fn clear(&mut self) {
        let nothing = if self.color.is_empty() { NO_NODE } else { 0 };
        self.shown.fill(nothing);
        self.voxel.fill(crate::frame::NO_VOXEL);
    }
}
