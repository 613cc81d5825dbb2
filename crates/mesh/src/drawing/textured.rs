//! Textured voxels as something that can be drawn.

use serde_json::json;

use super::mesh_view::{light_of, picture_of_triangles, view_of};
use super::{KeptPicture, MESH_SAMPLE_BYTES, MethodError};
use crate::raster::{Pattern, RasterCamera, RasterPicture, Samples};
use crate::textured::TexturedFile;
use crate::textured::view::{Detail, TexturedCounts, ViewOptions, choose_grid, draw};
use shiftvox::drawing::{
    COLOR_BYTES, DrawError, Drawable, Figures, Frames, Shown, check_samples, timed,
};
use shiftvox::picture::{Background, Shading};
use shiftvox::project::{Bounds, Camera, Up};

/// How often voxels are eroded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Erosion {
    /// The level of fewest faces, of all grids, whose texels are at most so many pixels; above 0.
    Auto {
        /// Pixels.
        texel_px: f64,
    },
    /// So often; beyond the last level primitives alone are left.
    Level {
        /// Erosions.
        level: u32,
        /// The grid, by its number of cells; else the one that fits the view best.
        cells: Option<u32>,
    },
}

/// What textured voxels are drawn with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TexturedStyle {
    /// Level of detail.
    pub erosion: Erosion,
    /// Samples per pixel and axis, as a power of two.
    pub aa_log2: u32,
    /// Light.
    pub shading: Shading,
    /// What is behind.
    pub background: Background,
}

/// A file of textured voxels that is drawn, once or from many cameras.
pub struct TexturedDrawing<'f> {
    file: &'f TexturedFile,
    style: TexturedStyle,
    kept: Option<KeptPicture>,
}

impl<'f> TexturedDrawing<'f> {
    /// Nothing is drawn yet.
    #[must_use]
    pub fn new(file: &'f TexturedFile, style: TexturedStyle) -> Self {
        Self {
            file,
            style,
            kept: None,
        }
    }

    fn detail(&self, view: &RasterCamera) -> Result<Detail, MethodError> {
        let (level, cells) = match self.style.erosion {
            Erosion::Auto { texel_px } => return Ok(Detail::Auto { texel_px }),
            Erosion::Level { level, cells } => (level, cells),
        };
        let cells_of = |grid: usize| self.file.grid(grid).cell_grid().cells();
        let grid = match cells {
            None => choose_grid(self.file, view, level),
            Some(cells) => (0..self.file.grids())
                .find(|&grid| cells_of(grid) == cells)
                .ok_or_else(|| MethodError::NoGrid {
                    cells,
                    has: (0..self.file.grids()).map(cells_of).collect(),
                })?,
        };
        Ok(Detail::Level { grid, level })
    }

    /// Draws a frame. Which grid fits the view is part of the work.
    fn drawn(&self, view: &RasterCamera) -> Result<(RasterPicture, TexturedCounts), MethodError> {
        let options = ViewOptions {
            detail: self.detail(view)?,
            samples: Samples::new(1 << (2 * self.style.aa_log2), Pattern::Regular)?,
            light: light_of(view, self.style.shading),
            background: self.style.background.color(),
        };
        Ok(draw(self.file, view, &options)?)
    }
}

impl Drawable for TexturedDrawing<'_> {
    fn bounds(&self) -> Bounds {
        Bounds::of_mesh(&self.file.mesh_box())
    }

    fn up(&self) -> Up {
        Up::y_or_z(self.file.y_up())
    }

    fn draw(&mut self, camera: &Camera, runs: u32) -> Result<(), DrawError> {
        self.kept = None;
        check_samples(
            camera,
            self.style.aa_log2,
            MESH_SAMPLE_BYTES,
            COLOR_BYTES,
            0,
        )?;
        let view = view_of(camera, self.file.bounds())?;
        let ((mut drawn, counts), times_ms) = timed(runs, || Ok(self.drawn(&view)?))?;
        let coverage = std::mem::take(&mut drawn.coverage);
        self.kept = Some(KeptPicture {
            picture: picture_of_triangles(drawn),
            coverage,
            counters: counters(self.file, &counts),
            times_ms,
        });
        Ok(())
    }

    fn shown(&self) -> Result<Option<Shown<'_>>, DrawError> {
        let details = || vec![("engine", json!("textured"))];
        Ok(self.kept.as_ref().map(|kept| kept.shown(details())))
    }

    fn frames(&self, camera: &Camera) -> Result<Frames<'_>, DrawError> {
        let view = view_of(camera, self.file.bounds())?;
        Ok(Box::new(move || {
            std::hint::black_box(self.drawn(&view)?);
            Ok(())
        }))
    }
}

fn counters(file: &TexturedFile, counts: &TexturedCounts) -> Figures {
    let choice = &counts.choice;
    let cells = file.grid(choice.grid).cell_grid().cells();
    vec![
        ("grid", json!(cells)),
        ("erosion", json!(choice.level)),
        // Null where the eye is among the voxels.
        ("texel_px", json!((choice.texel_px * 1e3).round() / 1e3)),
        ("primitives", json!(counts.primitives)),
        ("voxels", json!(counts.voxels)),
        ("surfels", json!(counts.surfels)),
    ]
}
