//! Why a mesh, or voxels of one, were not drawn.

use shiftvox::drawing::DrawError;
use shiftvox::graph::file::FileError;

use crate::raster::RasterError;

/// The contents of [`DrawError::Method`].
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Raster(#[from] RasterError),
    #[error("voxels are drawn at a size above 0 pixels, not {0}")]
    VoxelSize(f64),
    #[error("the file has no grid of {cells} cells")]
    NoGrid {
        cells: u32,
        /// The numbers of cells of the file's grids.
        has: Vec<u32>,
    },
    #[error("texels are wanted at a size above 0 pixels, not {0}")]
    TexelSize(f64),
}

impl From<ViewError> for DrawError {
    fn from(error: ViewError) -> Self {
        Self::Method(Box::new(error))
    }
}
