//! Large and near solids, by the exact planes of their silhouettes: whole blocks and tiles of samples at a time.

use super::band::Band;
use super::exact::{Cover, Outline};
use super::lanes::Isa;
use super::window::{BLOCK_LOG2, TILE_LOG2, Window, bits};

fn cell_of(x: i32, y: i32, log2: u32, window: &Window) -> Window {
    let (left, top, side) = (x << log2, y << log2, 1 << log2);
    Window::of([left, top, left + side - 1, top + side - 1]).and(window)
}

#[inline(always)]
pub(super) fn draw<I: Isa>(
    band: &mut Band<'_, I>,
    outline: &Outline,
    window: &Window,
    node: u32,
    voxel: [i32; 4],
) {
    band.counters.solids += 1;
    for y in window.top >> BLOCK_LOG2..=window.bottom >> BLOCK_LOG2 {
        for x in window.left >> BLOCK_LOG2..=window.right >> BLOCK_LOG2 {
            let block = cell_of(x, y, BLOCK_LOG2, window);
            if block.is_empty() || band.switches.hidden && !band.fill.is_open(&block) {
                continue;
            }
            let cover = outline.cover(&block);
            if cover != Cover::None {
                draw_block(band, outline, &block, cover, node, voxel);
            }
        }
    }
}

#[inline(always)]
fn draw_block<I: Isa>(
    band: &mut Band<'_, I>,
    outline: &Outline,
    block: &Window,
    cover: Cover,
    node: u32,
    voxel: [i32; 4],
) {
    for y in block.top >> TILE_LOG2..=block.bottom >> TILE_LOG2 {
        for x in block.left >> TILE_LOG2..=block.right >> TILE_LOG2 {
            let open = band.fill.open_in_tile(x, y, block);
            if open == 0 {
                continue;
            }
            let (left, top) = (x << TILE_LOG2, y << TILE_LOG2);
            let tile = cell_of(x, y, TILE_LOG2, block);
            let cover = if cover == Cover::All {
                cover
            } else {
                outline.cover(&tile)
            };
            let samples = match cover {
                Cover::None => 0,
                Cover::All => open,
                Cover::Some => {
                    band.counters.exact_samples += u64::from(open.count_ones());
                    bits(open).fold(0, |covered, bit| {
                        let (x, y) = (left + (bit as i32 & 7), top + (bit as i32 >> 3));
                        covered | u64::from(outline.covers(band.exact, x, y)) << bit
                    })
                }
            };
            if samples != 0 {
                band.counters.tiles_filled += u64::from(samples == u64::MAX);
                let drawn = band.show([left, top], samples, node, voxel);
                band.counters.samples_drawn += u64::from(drawn.count_ones());
                band.fill.mark_tile(x, y, drawn);
            }
        }
    }
}
