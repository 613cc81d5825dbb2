//! Textured voxels to a picture.
//!
//! The primitives of eroded voxels and the surfels of those that are left go to the rasteriser as triangles: one depth
//! buffer, any camera. Where a texel is transparent, what is behind shows.

mod choose;
mod scene;

use crate::raster::{self, RasterCamera, RasterError, RasterOptions, RasterPicture};
use shiftvox::graph::Silent;

pub use choose::{Choice, choose, choose_grid};

use super::store::{TexturedError, TexturedFile};
use scene::Shown;

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Detail {
    /// The level of fewest faces, of all grids, whose texels are at most so many pixels.
    Auto {
        /// Pixels, above 0.
        texel_px: f64,
    },
    Level {
        grid: usize,
        /// Erosions; from the last level on primitives alone.
        level: u32,
    },
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewOptions {
    pub detail: Detail,
    pub raster: RasterOptions,
}

#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    #[error(transparent)]
    File(#[from] TexturedError),
    #[error(transparent)]
    Raster(#[from] RasterError),
    #[error("there is no grid {0}: the file has {1}")]
    Grid(usize, usize),
    #[error("texels are wanted at a size above 0 pixels, not {0}")]
    TexelSize(f64),
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
    let choice = match options.detail {
        Detail::Auto { texel_px } if texel_px > 0.0 => choose(file, view, texel_px),
        Detail::Auto { texel_px } => return Err(ViewError::TexelSize(texel_px)),
        Detail::Level { grid, .. } if grid >= file.grids() => {
            return Err(ViewError::Grid(grid, file.grids()));
        }
        Detail::Level { grid, level } => Choice::of(file, view, grid, level),
    };
    let grid = file.grid(choice.grid);
    grid.ensure()?;
    let shown = Shown::new(file, grid, choice.level);
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
