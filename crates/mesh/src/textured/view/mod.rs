//! Textured voxels to a picture.
//!
//! The primitives of eroded voxels and the surfels of those that are left go to the rasteriser as triangles: one depth
//! buffer, any camera. Where a texel is transparent, what is behind shows.

mod choose;
mod scene;

use crate::raster::{
    self, Light, RasterCamera, RasterError, RasterOptions, RasterPicture, Samples,
};
use shiftvox::graph::Silent;

pub use choose::{Choice, choose, choose_grid};

use super::store::{TexturedError, TexturedFile};
use scene::Shown;

/// The grid and the level to draw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Detail {
    /// The level of fewest faces, of all grids, whose texels are at most so many pixels.
    Auto {
        /// Pixels, above 0.
        texel_px: f64,
    },
    /// This one.
    Level {
        /// Number of the grid.
        grid: usize,
        /// Erosions; from the last level on primitives alone.
        level: u32,
    },
}

/// How textured voxels are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewOptions {
    /// The grid and the level.
    pub detail: Detail,
    /// The number of samples per pixel, and their places.
    pub samples: Samples,
    /// The light, or `None` for unlit colours.
    pub light: Option<Light>,
    /// The background, sRGB, or `None` for transparent.
    pub background: Option<[u8; 3]>,
}

/// Why nothing was drawn.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// The file's data is damaged.
    #[error(transparent)]
    File(#[from] TexturedError),
    /// The camera or the picture's size.
    #[error(transparent)]
    Raster(#[from] RasterError),
    /// There is no such grid.
    #[error("there is no grid {0}: the file has {1}")]
    Grid(usize, usize),
    /// The size of texels.
    #[error("texels are wanted at a size above 0 pixels, not {0}")]
    TexelSize(f64),
}

/// Counts of one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TexturedCounts {
    /// The grid and level that are drawn.
    pub choice: Choice,
    /// Primitives given to the rasteriser.
    pub primitives: u64,
    /// Surfels given to the rasteriser.
    pub surfels: u64,
    /// Voxels that are left.
    pub voxels: u64,
}

/// Draws a frame.
///
/// # Errors
/// See [`ViewError`].
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
    let raster_options = RasterOptions {
        samples: options.samples,
        light: options.light,
        background: options.background,
    };
    let shown = Shown::new(file, grid, choice.level);
    let picture = raster::draw(&shown, view, &raster_options, &Silent)?;
    let row = grid.levels().row(choice.level);
    let counts = TexturedCounts {
        choice,
        primitives: row.primitives,
        surfels: row.surfels,
        voxels: row.voxels,
    };
    Ok((picture, counts))
}
