//! Textured voxels to a picture.
//!
//! The primitives of eroded voxels and the surfels of those that are left go to the rasteriser as triangles: one depth
//! buffer, any camera. Where a texel is transparent, what is behind shows.

mod choose;
mod scene;

use crate::raster::{self, RasterCamera, RasterOptions, RasterPicture};
use crate::view_error::ViewError;
use shiftvox::graph::Silent;

pub use choose::{Choice, choose, choose_grid};

use super::store::TexturedFile;
use scene::Shown;

/// How often voxels are eroded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Erosion {
    /// The level of fewest faces, of all grids, whose texels are at most so many pixels; above 0.
    Auto { texel_px: f64 },
    /// So often; beyond the last level primitives alone are left.
    Level {
        level: u32,
        /// The grid, by its number of cells; else the one that fits the view best.
        cells: Option<u32>,
    },
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewOptions {
    pub erosion: Erosion,
    pub raster: RasterOptions,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TexturedCounts {
    pub choice: Choice,
    pub primitives: u64,
    pub surfels: u64,
    pub voxels: u64,
}

pub fn draw(
    file: &TexturedFile,
    view: &RasterCamera,
    options: &ViewOptions,
) -> Result<(RasterPicture, TexturedCounts), ViewError> {
    let cells_of = |grid: usize| file.grid(grid).cell_grid().cells;
    let choice = match options.erosion {
        Erosion::Auto { texel_px } if texel_px > 0.0 => choose(file, view, texel_px),
        Erosion::Auto { texel_px } => return Err(ViewError::TexelSize(texel_px)),
        Erosion::Level { level, cells } => {
            let grid = match cells {
                None => choose_grid(file, view, level),
                Some(cells) => (0..file.grids())
                    .find(|&grid| cells_of(grid) == cells)
                    .ok_or_else(|| ViewError::NoGrid {
                        cells,
                        has: (0..file.grids()).map(cells_of).collect(),
                    })?,
            };
            Choice::of(file, view, grid, level)
        }
    };
    let grid = file.grid(choice.grid);
    grid.ensure()?;
    let shown = Shown::new(file, grid, choice.level)?;
    let picture = raster::draw(&shown, view, &options.raster, &Silent)?;
    let row = grid.levels().row(choice.level);
    let counts = TexturedCounts {
        choice,
        primitives: row.primitives,
        surfels: row.surfels,
        voxels: row.voxels,
    };
    Ok((picture, counts))
}
