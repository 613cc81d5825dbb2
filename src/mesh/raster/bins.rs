//! Which triangles may show in which tile.

use rayon::prelude::*;

use super::View;
use super::clip::Outline;
use crate::mesh::Surface;

/// Pixels along a tile's side.
pub(super) const TILE: u32 = 32;
/// Triangles that are sorted at a time.
const CHUNK: usize = 1 << 16;

/// The triangles of each tile, in their order.
pub(super) struct Bins {
    columns: u32,
    rows: u32,
    /// One after the other; each a list for each tile.
    chunks: Vec<Vec<Vec<u32>>>,
}

impl Bins {
    pub(super) fn fill<S: Surface + ?Sized>(surface: &S, view: &View) -> Self {
        let columns = view.width.div_ceil(TILE);
        let rows = view.height.div_ceil(TILE);
        let count = surface.len();
        let chunks = (0..count.div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let mut lists = vec![Vec::new(); (columns * rows) as usize];
                let begin = chunk * CHUNK;
                for number in begin..count.min(begin + CHUNK) {
                    let Some(outline) = Outline::of(view, &surface.corners(number)) else {
                        continue;
                    };
                    let tiles = outline
                        .pixels()
                        .map(|p| p.map(|c| c.div_euclid(i64::from(TILE))));
                    let [low, high] = tiles;
                    let clamp = |c: i64, most: u32| c.clamp(0, i64::from(most) - 1) as u32;
                    let misses = high[0] < 0
                        || high[1] < 0
                        || low[0] >= i64::from(columns)
                        || low[1] >= i64::from(rows);
                    if misses {
                        continue;
                    }
                    for row in clamp(low[1], rows)..=clamp(high[1], rows) {
                        for column in clamp(low[0], columns)..=clamp(high[0], columns) {
                            lists[(row * columns + column) as usize].push(number as u32);
                        }
                    }
                }
                lists
            })
            .collect();
        Self {
            columns,
            rows,
            chunks,
        }
    }

    /// Number of tiles.
    pub(super) fn tiles(&self) -> usize {
        (self.columns * self.rows) as usize
    }

    /// The first pixel of a tile.
    pub(super) fn corner(&self, tile: usize) -> [u32; 2] {
        let tile = tile as u32;
        [tile % self.columns * TILE, tile / self.columns * TILE]
    }

    /// The triangles of a tile, in their order.
    pub(super) fn triangles(&self, tile: usize) -> impl Iterator<Item = u32> + '_ {
        self.chunks
            .iter()
            .flat_map(move |lists| lists[tile].iter().copied())
    }
}
