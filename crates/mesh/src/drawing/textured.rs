//! Textured voxels.

use serde_json::json;

use super::mesh_view::light_of;
use super::{Drawn, Method, MethodDrawing, MethodError};
use crate::raster::{Pattern, RasterCamera, RasterOptions, Samples};
use crate::textured::TexturedFile;
use crate::textured::view::{Detail, TexturedCounts, ViewOptions, choose_grid, draw};
use shiftvox::drawing::Figures;
use shiftvox::graph::MeshBox;
use shiftvox::picture::{Background, Shading};

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
pub struct TexturedStyle {
    pub erosion: Erosion,
    /// Samples per pixel and axis, as a power of two.
    pub aa_log2: u32,
    pub shading: Shading,
    pub background: Background,
}

#[derive(Clone)]
pub struct TexturedMethod<'f> {
    file: &'f TexturedFile,
    style: TexturedStyle,
}

pub type TexturedDrawing<'f> = MethodDrawing<TexturedMethod<'f>>;

impl<'f> TexturedDrawing<'f> {
    pub fn new(file: &'f TexturedFile, style: TexturedStyle) -> Self {
        Self::of(TexturedMethod { file, style })
    }
}

impl TexturedMethod<'_> {
    fn detail(&self, view: &RasterCamera) -> Result<Detail, MethodError> {
        let (level, cells) = match self.style.erosion {
            Erosion::Auto { texel_px } => return Ok(Detail::Auto { texel_px }),
            Erosion::Level { level, cells } => (level, cells),
        };
        let cells_of = |grid: usize| self.file.grid(grid).cell_grid().cells;
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
}

impl Method for TexturedMethod<'_> {
    fn mesh_box(&self) -> MeshBox {
        self.file.mesh_box()
    }

    fn aa_log2(&self) -> u32 {
        self.style.aa_log2
    }

    fn draw(&mut self, view: &RasterCamera) -> Result<Drawn, MethodError> {
        let options = ViewOptions {
            detail: self.detail(view)?,
            raster: RasterOptions {
                samples: Samples::new(1 << (2 * self.style.aa_log2), Pattern::Regular)?,
                light: light_of(view, self.style.shading),
                background: self.style.background.color(),
            },
        };
        let (drawn, counts) = draw(self.file, view, &options)?;
        Ok(Drawn::of_triangles(drawn, counters(self.file, &counts)))
    }

    fn details(&self) -> Figures {
        vec![("engine", json!("textured"))]
    }
}

fn counters(file: &TexturedFile, counts: &TexturedCounts) -> Figures {
    let choice = &counts.choice;
    let cells = file.grid(choice.grid).cell_grid().cells;
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
