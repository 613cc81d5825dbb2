//! Triangles to pixels, with a depth buffer: the reference picture of a mesh.
//!
//! Corners are projected in `f64` and rounded to 1/4096 pixel. From there on coverage is decided exactly, in integers,
//! with the top-left rule. Depth is the plane's at the sample, not interpolated between rounded corners. The picture is
//! cut into bins that threads draw on their own, each with its triangles in order, so that any number of threads gives
//! the same picture. Rules: `spec/mesh.md`.

mod bin;
mod bins;
mod clip;
mod edges;
mod samples;
mod shade;

use glam::DVec3;
use rayon::prelude::*;

pub(crate) use bin::mixed;
pub(crate) use edges::Edges;
pub use samples::{Pattern, Samples};
pub use shade::Light;

use super::Surface;
use bin::Bin;
use bins::Bins;
use shiftvox::graph::Progress;

/// The number in place of a triangle where there is none.
pub const NOTHING: u32 = u32::MAX;
/// Most pixels a side: what the bits of an edge function have room for.
pub const MAX_SIDE: u32 = 1 << 15;

/// A pinhole camera: what the rasteriser, far voxels and textured voxels draw from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RasterCamera {
    /// Position of the eye, world units.
    pub eye: DVec3,
    /// Unit vector towards growing pixel x.
    pub right: DVec3,
    /// Unit vector towards falling pixel y.
    pub up: DVec3,
    /// Unit vector along the view axis.
    pub forward: DVec3,
    /// Pixels per unit of slope.
    pub focal_px: f64,
    /// Pixels across, 1 to [`MAX_SIDE`].
    pub width: u32,
    /// Pixels down, 1 to [`MAX_SIDE`].
    pub height: u32,
    /// Depth below which nothing is drawn, world units, above 0.
    pub near: f64,
}

impl RasterCamera {
    pub(crate) fn seen(&self, point: DVec3) -> DVec3 {
        let offset = point - self.eye;
        let axes = [self.right, self.up, self.forward];
        DVec3::from_array(axes.map(|axis| offset.dot(axis)))
    }

    /// The place in the picture of a point given by [`RasterCamera::seen`], pixels from the top left corner.
    pub(crate) fn place(&self, seen: DVec3) -> [f64; 2] {
        [
            f64::from(self.width) / 2.0 + seen.x / seen.z * self.focal_px,
            f64::from(self.height) / 2.0 - seen.y / seen.z * self.focal_px,
        ]
    }

    pub(crate) fn check(&self) -> Result<(), RasterError> {
        let side = 1..=MAX_SIDE;
        if !side.contains(&self.width) || !side.contains(&self.height) {
            return Err(RasterError::Size(self.width, self.height));
        }
        let axes = [self.eye, self.right, self.up, self.forward];
        let positive = |x: f64| x > 0.0 && x.is_finite();
        match axes.iter().all(|v| v.is_finite()) && positive(self.near) && positive(self.focal_px) {
            true => Ok(()),
            false => Err(RasterError::Camera),
        }
    }
}

/// How a surface is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RasterOptions {
    /// The number of samples per pixel, and their places.
    pub samples: Samples,
    /// The light, or `None` for unlit colours.
    pub light: Option<Light>,
    /// The background, sRGB, or `None` for transparent.
    pub background: Option<[u8; 3]>,
}

/// Why nothing was drawn.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RasterError {
    /// The picture has no pixels or too many.
    #[error("a picture has 1 to {MAX_SIDE} pixels a side, not {0} x {1}")]
    Size(u32, u32),
    /// The camera has a number that is not finite, or a near depth or focal length not above 0.
    #[error("the camera's numbers must be finite, its near depth and focal length above 0")]
    Camera,
    /// More triangles than 32 bits number.
    #[error("{0} triangles are more than 32 bits can number")]
    TooMany(usize),
}

/// A finished picture, row by row from the top left.
#[derive(Debug, Clone, PartialEq)]
pub struct RasterPicture {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Colour, sRGB, and coverage, not premultiplied; averaged in linear light.
    pub rgba: Vec<[u8; 4]>,
    /// Share of the pixel's samples that see something.
    pub coverage: Vec<f32>,
    /// View-axis depth of the opaque surface, world units. It is taken at the sample right of and below the pixel's middle,
    /// or at the middle with one sample, and infinite where that sample sees nothing.
    pub depth: Vec<f32>,
    /// The triangle that this sample sees, of far voxels the node, or [`NOTHING`].
    pub seen: Vec<u32>,
}

/// Draws a surface. Both sides of a triangle are drawn. Of triangles at the same depth the first that faces the eye
/// counts, or else the first.
///
/// # Errors
/// See [`RasterError`].
pub fn draw(
    surface: &dyn Surface,
    view: &RasterCamera,
    options: &RasterOptions,
    progress: &dyn Progress,
) -> Result<RasterPicture, RasterError> {
    draw_before(surface, view, options, None, progress)
}

/// [`draw`], before a picture of these depths, row by row.
pub(crate) fn draw_before(
    surface: &dyn Surface,
    view: &RasterCamera,
    options: &RasterOptions,
    depths: Option<&[f32]>,
    progress: &dyn Progress,
) -> Result<RasterPicture, RasterError> {
    let (width, height) = (view.width, view.height);
    view.check()?;
    if u32::try_from(surface.len()).map_or(true, |count| count == NOTHING) {
        return Err(RasterError::TooMany(surface.len()));
    }
    let bins = Bins::fill(surface, view);
    progress.begin("draw triangles", bins.len() as u64);
    let bins: Vec<Bin> = (0..bins.len())
        .into_par_iter()
        .map(|number| {
            let bin = Bin::draw(surface, view, options, &bins, number, depths);
            progress.advance(1);
            bin
        })
        .collect();
    progress.end();
    let pixels = width as usize * height as usize;
    let mut picture = RasterPicture {
        width,
        height,
        rgba: vec![[0; 4]; pixels],
        coverage: vec![0.0; pixels],
        depth: vec![f32::INFINITY; pixels],
        seen: vec![NOTHING; pixels],
    };
    for bin in &bins {
        bin.store(&mut picture);
    }
    Ok(picture)
}
