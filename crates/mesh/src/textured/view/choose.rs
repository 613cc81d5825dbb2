//! The choice of grid and level for a camera, future work in Tellier and Baroud 2003.

use glam::DVec3;

use crate::raster::RasterCamera;
use crate::textured::store::TexturedFile;

/// A grid and a level, and the size of its texels in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    pub grid: usize,
    pub level: u32,
    /// The size of the largest texel, pixels, at the nearest point of the box around the voxels that are left. 0 without
    /// voxels, infinite from within the box.
    pub texel_px: f64,
    /// The greatest distance between a face and the surface that it shows, pixels, likewise.
    pub behind_px: f64,
}

impl Choice {
    /// A given one. Levels above the last are the last.
    pub(super) fn of(file: &TexturedFile, view: &RasterCamera, grid: usize, level: u32) -> Self {
        let row = file.grid(grid).levels().row(level);
        let lattice = file.grid(grid).cell_grid();
        let reach = DVec3::from_array(row.reach.map(f64::from));
        // Pixels of a length at the nearest voxel that is left. Division by zero: infinite.
        let in_pixels = |length: f64| {
            let [low, high] = row.cells.map(|cell| lattice.corner(cell));
            let away = (low - view.eye).max(view.eye - high).max(DVec3::ZERO);
            match row.voxels {
                0 => 0.0,
                _ => length * view.focal_px / away.length(),
            }
        };
        Self {
            grid,
            level: row.level,
            texel_px: in_pixels(lattice.texel_size()),
            behind_px: in_pixels((reach * lattice.cell_size()).max_element()),
        }
    }
}

/// The level of fewest faces, a surfel counting as two, of all grids, whose texels are at most so many pixels, and which
/// shows nothing farther behind a face; or primitives alone.
pub fn choose(file: &TexturedFile, view: &RasterCamera, most_px: f64) -> Choice {
    let mut best = (u64::MAX, Choice::of(file, view, 0, u32::MAX));
    for grid in 0..file.grids() {
        for row in file.grid(grid).levels().rows() {
            let choice = Choice::of(file, view, grid, row.level);
            let cost = row.primitives + 2 * row.surfels;
            if choice.texel_px.max(choice.behind_px) <= most_px && cost < best.0 {
                best = (cost, choice);
            }
        }
    }
    best.1
}

/// The grid for a level that is given: the coarsest whose texels are at most a pixel, or else the finest.
pub fn choose_grid(file: &TexturedFile, view: &RasterCamera, level: u32) -> usize {
    let is_fine = |&grid: &usize| Choice::of(file, view, grid, level).texel_px <= 1.0;
    let last = file.grids() - 1;
    (0..file.grids()).find(is_fine).unwrap_or(last)
}
