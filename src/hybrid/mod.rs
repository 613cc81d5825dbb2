//! The hybrid: decimated triangles for what is wider than a pixel, far voxels for what is not.
//!
//! A mesh as a few levels of detail, each for a size of pixel that doubles from level to level. A
//! level has triangles, decimated by less than its pixel, and beside them far voxels of its size,
//! made of the parts that are too thin for it: leaves, wires. Which it has is measured when it is
//! made. Nearer than the finest level the mesh itself is drawn. Rules: `docs/which-method.md`.

mod build;
mod parts;

use glam::DVec3;

pub use build::{HybridError, HybridOptions, build};

use crate::far::FarFile;
use crate::far::record::NODE_BYTES;
use crate::far::view::{FarPicture, FarViewer, ViewError, ViewOptions};
use crate::mesh::raster::RasterCamera;
use crate::mesh::{Mesh, Surface};

/// One level of detail.
#[derive(Debug)]
pub struct Level {
    /// The pixel that it is made for, world units; the mesh itself has 0.
    pub pixel: f64,
    /// What is wide.
    pub surface: Option<Mesh>,
    /// What is thin.
    pub thin: Option<FarFile>,
    /// Bytes of both as they are drawn: a compact mesh, records of voxels.
    pub bytes: u64,
}

impl Level {
    fn new(pixel: f64, surface: Option<(Mesh, u64)>, thin: Option<FarFile>) -> Self {
        let of_triangles = surface.as_ref().map_or(0, |(_, bytes)| *bytes);
        let of_voxels = thin
            .as_ref()
            .map_or(0, |file| file.nodes()[0].voxel_bytes() + NODE_BYTES as u64);
        Self {
            pixel,
            surface: surface.map(|(mesh, _)| mesh),
            thin,
            bytes: of_triangles + of_voxels,
        }
    }

    /// Draws it; with the number of triangles and voxels.
    pub(crate) fn draw(
        &self,
        view: &RasterCamera,
        options: &ViewOptions,
    ) -> Result<(FarPicture, [u64; 2]), ViewError> {
        let options = ViewOptions {
            // The root's voxels, of which this level is made, at any distance.
            voxel_px: f64::MAX.sqrt(),
            ..*options
        };
        let surface = self.surface.as_ref().map(|mesh| mesh as &dyn Surface);
        let (picture, counts) = match &self.thin {
            Some(file) => FarViewer::new(file).draw_with(view, surface, &options)?,
            None => crate::far::view::draw_surface(view, surface, &options)?,
        };
        let voxels = counts.opaque_voxels + counts.transparent_voxels;
        Ok((picture, [counts.triangles, voxels]))
    }
}

/// A mesh in levels of detail.
#[derive(Debug)]
pub struct Hybrid {
    /// From fine to coarse; the first is the mesh itself.
    pub levels: Vec<Level>,
    low: DVec3,
    high: DVec3,
}

impl Hybrid {
    /// Lowest and highest corner of the box around the mesh.
    #[must_use]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        (self.low, self.high)
    }

    /// Bytes of all levels.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.levels.iter().map(|level| level.bytes).sum()
    }

    /// The coarsest level whose pixel is nowhere larger than so many of the picture's.
    #[must_use]
    pub fn level(&self, view: &RasterCamera, pixels: f64) -> &Level {
        let outside = (self.low - view.eye).max(view.eye - self.high);
        let distance = outside.max(DVec3::ZERO).length();
        let fits = |level: &&Level| level.pixel * view.focal_px <= pixels * distance;
        // The mesh itself has pixels of size 0.
        self.levels
            .iter()
            .rev()
            .find(fits)
            .unwrap_or(&self.levels[0])
    }

    /// Draws it; with the level and the number of triangles and voxels.
    /// `options.voxel_px` is the largest pixel of a level.
    ///
    /// # Errors
    /// See [`ViewError`].
    pub fn draw(
        &self,
        view: &RasterCamera,
        options: &ViewOptions,
    ) -> Result<(FarPicture, &Level, [u64; 2]), ViewError> {
        let level = self.level(view, options.voxel_px);
        let (picture, counts) = level.draw(view, options)?;
        Ok((picture, level, counts))
    }
}
