//! Textured voxels.

use serde_json::json;

use super::mesh_view::light_of;
use super::{Drawn, Method, MethodDrawing, MethodError};
use crate::raster::{Pattern, RasterCamera, RasterOptions, Samples};
use crate::textured::TexturedFile;
use crate::textured::view::{Erosion, TexturedCounts, ViewOptions, draw};
use shiftvox::drawing::Figures;
use shiftvox::graph::MeshBox;
use shiftvox::picture::{Background, Shading};

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

impl Method for TexturedMethod<'_> {
    fn mesh_box(&self) -> MeshBox {
        self.file.mesh_box()
    }

    fn aa_log2(&self) -> u32 {
        self.style.aa_log2
    }

    fn draw(&mut self, view: &RasterCamera) -> Result<Drawn, MethodError> {
        let options = ViewOptions {
            erosion: self.style.erosion,
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
