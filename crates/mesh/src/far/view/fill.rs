//! A depth pyramid of the picture so far: the greatest depth of each square of pixels.

use super::cut::Outline;
use crate::raster::RasterCamera;

const SQUARES: usize = 4;
/// Depths are rounded to single precision: what is nearer by less counts as visible.
const MARGIN: f64 = 1e-5;

struct Level {
    width: usize,
    height: usize,
    depth: Vec<f32>,
}

pub(super) struct Fill {
    levels: Vec<Level>,
}

impl Fill {
    pub(super) fn of(depth: &[f32], view: &RasterCamera) -> Self {
        let mut levels = vec![Level {
            width: view.width as usize,
            height: view.height as usize,
            depth: depth.to_vec(),
        }];
        while let Some(last) = levels.last()
            && last.width.max(last.height) > 1
        {
            let (width, height) = (last.width.div_ceil(2), last.height.div_ceil(2));
            let mut depth = vec![0.0f32; width * height];
            for y in 0..last.height {
                let row = &last.depth[y * last.width..(y + 1) * last.width];
                let above = &mut depth[y / 2 * width..(y / 2 + 1) * width];
                for (x, &below) in row.iter().enumerate() {
                    above[x / 2] = above[x / 2].max(below);
                }
            }
            levels.push(Level {
                width,
                height,
                depth,
            });
        }
        Self { levels }
    }

    /// False where that is not certain.
    pub(super) fn hides(&self, view: &RasterCamera, outline: &Outline) -> bool {
        let Some([low, high]) = outline.pixels else {
            return false;
        };
        let clamp = |c: f64, side: u32| c.clamp(0.0, f64::from(side) - 1.0) as usize;
        let (x0, x1) = (clamp(low[0], view.width), clamp(high[0], view.width));
        let (y0, y1) = (clamp(low[1], view.height), clamp(high[1], view.height));
        let nearest = outline.depth * (1.0 - MARGIN);
        let mut level = 0;
        while level + 1 < self.levels.len() && (x1 >> level) - (x0 >> level) + 1 > SQUARES
            || level + 1 < self.levels.len() && (y1 >> level) - (y0 >> level) + 1 > SQUARES
        {
            level += 1;
        }
        let squares = &self.levels[level];
        (y0 >> level..=y1 >> level).all(|y| {
            (x0 >> level..=x1 >> level)
                .all(|x| f64::from(squares.depth[y * squares.width + x]) < nearest)
        })
    }
}
