//! A depth pyramid of the picture so far: the greatest depth of each square of pixels.

use super::cut::Outline;
use crate::raster::RasterCamera;

/// The most squares along a side that a query reads.
const SQUARES: usize = 4;
/// Depths are rounded to single precision: what is nearer by less counts as visible.
const MARGIN: f64 = 1e-5;

struct Level {
    width: usize,
    height: usize,
    depth: Vec<f32>,
}

/// The greatest depth of pixels, of 2 by 2 of them, of 4 by 4, and so on.
/// Infinite where anything is empty.
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

    /// Whether everything in an outline is behind what is drawn. False where that is not certain.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::looking;
    use glam::DVec3;

    #[test]
    fn only_boxes_behind_everything_are_hidden() {
        let view = looking(DVec3::ZERO, DVec3::Z, [37, 21], 20.0);
        let mut depth = vec![5.0f32; 37 * 21];
        depth[10 * 37 + 30] = f32::INFINITY;
        let fill = Fill::of(&depth, &view);
        // Left, top, side and depth of a box.
        for (x, y, side, depth, is_hidden) in [
            (3.0, 3.0, 9.0, 6.0, true),
            (3.0, 3.0, 9.0, 4.0, false),
            (3.0, 3.0, 9.0, 5.0, false),
            (28.0, 8.0, 4.0, 6.0, false),
            (31.0, 10.0, 0.0, 6.0, true),
            (0.0, 0.0, 40.0, 6.0, false),
        ] {
            let outline = Outline {
                pixels: Some([[x, y], [x + side, y + side]]),
                depth,
                ..Outline::anywhere()
            };
            assert_eq!(
                fill.hides(&view, &outline),
                is_hidden,
                "{x} {y} {side} {depth}"
            );
        }
        assert!(!fill.hides(&view, &Outline::anywhere()));
    }
}
