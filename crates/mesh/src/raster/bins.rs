//! Bins: squares of 32 x 32 pixels, and which triangles may show in each.

use rayon::prelude::*;

use super::RasterCamera;
use super::clip::Outline;
use crate::Surface;

pub(super) const BIN: u32 = 32;
const CHUNK: usize = 1 << 16;

pub(super) struct Bins {
    columns: u32,
    rows: u32,
    chunks: Vec<Vec<Vec<u32>>>,
}

impl Bins {
    pub(super) fn fill(surface: &dyn Surface, view: &RasterCamera) -> Self {
        let columns = view.width.div_ceil(BIN);
        let rows = view.height.div_ceil(BIN);
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
                    let bins = |p: [i64; 2]| p.map(|c| c.div_euclid(i64::from(BIN)));
                    let [low, high] = outline.pixels().map(bins);
                    for row in low[1].max(0)..=high[1].min(i64::from(rows) - 1) {
                        for column in low[0].max(0)..=high[0].min(i64::from(columns) - 1) {
                            let bin = row * i64::from(columns) + column;
                            lists[bin as usize].push(number as u32);
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

    pub(super) fn len(&self) -> usize {
        (self.columns * self.rows) as usize
    }

    pub(super) fn corner(&self, bin: usize) -> [u32; 2] {
        let bin = bin as u32;
        [bin % self.columns * BIN, bin / self.columns * BIN]
    }

    pub(super) fn triangles(&self, bin: usize) -> impl Iterator<Item = u32> + '_ {
        self.chunks
            .iter()
            .flat_map(move |lists| lists[bin].iter().copied())
    }
}
