//! Methods of meshes as [`Drawable`](shiftvox::drawing::Drawable): far voxels, textured voxels, triangles.

mod far;
pub mod mesh_view;
mod textured;
mod triangles;

use std::borrow::Cow;

use shiftvox::drawing::{Buffers, DrawError, Figures, Shown};
use shiftvox::picture::{Picture, Pixels};

use crate::raster::{RasterError, SamplesError};

pub use far::{FarDrawing, FarStyle, resident};
pub use textured::{Erosion, TexturedDrawing, TexturedStyle};
pub use triangles::{TrianglesDrawing, TrianglesStyle};

/// Why a method of meshes did not draw a frame: the contents of [`DrawError::Method`].
#[derive(Debug, thiserror::Error)]
pub enum MethodError {
    /// Far voxels cannot be drawn so.
    #[error(transparent)]
    Far(#[from] crate::far::view::ViewError),
    /// Textured voxels cannot be drawn so.
    #[error(transparent)]
    Textured(#[from] crate::textured::view::ViewError),
    /// A file of textured voxels has no grid with so many cells.
    #[error("the file has no grid of {cells} cells")]
    NoGrid {
        /// The requested number.
        cells: u32,
        /// The numbers of cells of the file's grids.
        has: Vec<u32>,
    },
    /// Triangles cannot be drawn so.
    #[error(transparent)]
    Raster(#[from] RasterError),
    /// A pixel cannot have so many samples.
    #[error(transparent)]
    Samples(#[from] SamplesError),
}

impl From<MethodError> for DrawError {
    fn from(error: MethodError) -> Self {
        Self::Method(Box::new(error))
    }
}

/// Least memory of a sample, bytes: colour, depth, and the triangle or node that is seen.
const MESH_SAMPLE_BYTES: u64 = 8;

/// A picture that a method of meshes drew.
#[derive(Debug)]
struct KeptPicture {
    picture: Picture,
    coverage: Vec<f32>,
    counters: Figures,
    times_ms: Vec<f64>,
}

impl KeptPicture {
    fn shown(&self, details: Figures) -> Shown<'_> {
        let picture = &self.picture;
        Shown {
            pixels: Cow::Owned(Pixels::new(
                picture.width,
                picture.height,
                picture.rgba.clone(),
            )),
            buffers: Buffers::Whole(picture),
            pixels_drawn: picture.drawn(),
            coverage: &self.coverage,
            times_ms: &self.times_ms,
            counters: self.counters.clone(),
            details,
        }
    }
}
