//! The choice of grid and level for a camera, which is future work in Tellier and Baroud 2003.

use glam::DVec3;

use crate::raster::RasterCamera;
use crate::textured::store::{Grid, TexturedFile};

/// A grid and a level, and how large its texels are on the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// Number of the grid.
    pub grid: usize,
    /// Erosions.
    pub level: u32,
    /// The size of the largest texel, pixels, at the nearest point of the box around the remaining voxels. 0 without
    /// voxels, infinite from within the box.
    pub texel_px: f64,
    /// How far behind a face lies what it shows, pixels, at the most, seen so.
    pub behind_px: f64,
}

impl Choice {
    /// A given one. Levels above the last are the last.
    pub(super) fn of(file: &TexturedFile, view: &RasterCamera, grid: usize, level: u32) -> Self {
        let levels = file.grid(grid).levels();
        let level = level.min(levels.last());
        Self {
            grid,
            level,
            texel_px: texel_px(&file.grid(grid), level, view),
            behind_px: behind_px(&file.grid(grid), level, view),
        }
    }
}

/// The level of fewest faces, a surfel counting as two, of all grids, whose
/// texels are at most so many pixels, and which shows nothing farther behind a
/// face than that. Primitives alone always are.
pub fn choose(file: &TexturedFile, view: &RasterCamera, most_px: f64) -> Choice {
    let mut best: Option<(u64, Choice)> = None;
    for grid in 0..file.grids() {
        for row in file.grid(grid).levels().rows() {
            let choice = Choice::of(file, view, grid, row.level);
            let cost = row.primitives + 2 * row.surfels;
            let is_better = best.is_none_or(|(least, _)| cost < least);
            if choice.texel_px.max(choice.behind_px) <= most_px && is_better {
                best = Some((cost, choice));
            }
        }
    }
    let all = Choice::of(file, view, 0, u32::MAX);
    best.map_or(all, |(_, choice)| choice)
}

/// The grid for a level that is given: the coarsest whose texels are at most a
/// pixel, or else the finest.
pub fn choose_grid(file: &TexturedFile, view: &RasterCamera, level: u32) -> usize {
    let is_fine = |&grid: &usize| texel_px(&file.grid(grid), level, view) <= 1.0;
    let last = file.grids() - 1;
    (0..file.grids()).find(is_fine).unwrap_or(last)
}

/// Size of the largest texel of a level.
fn texel_px(grid: &Grid<'_>, level: u32, view: &RasterCamera) -> f64 {
    in_pixels(grid, level, view, grid.cell_grid().texel_size())
}

/// How far behind its face something may lie, seen from the side.
fn behind_px(grid: &Grid<'_>, level: u32, view: &RasterCamera) -> f64 {
    let reach = DVec3::from_array(grid.levels().reach(level).map(f64::from));
    let longest = (reach * grid.cell_grid().cell_size()).max_element();
    in_pixels(grid, level, view, longest)
}

/// A length, world units, at the nearest voxel that a level leaves.
fn in_pixels(grid: &Grid<'_>, level: u32, view: &RasterCamera, length: f64) -> f64 {
    let Some(cells) = grid.levels().box_of(level) else {
        return 0.0;
    };
    let lattice = grid.cell_grid();
    let [low, high] = cells.map(|cell| lattice.corner(cell));
    let away = (low - view.eye).max(view.eye - high).max(DVec3::ZERO);
    // Division by zero: infinite.
    length * view.focal_px / away.length()
}
