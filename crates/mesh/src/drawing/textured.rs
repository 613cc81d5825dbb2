//! Textured voxels.

use serde_json::json;

use super::mesh_view::light_of;
use super::triangles::node_of;
use super::{Drawn, MeshDrawing};
use crate::raster::{Pattern, RasterCamera, RasterOptions, Samples};
use crate::textured::TexturedFile;
use crate::textured::view::{self, Erosion, TexturedCounts, ViewOptions};
use shiftvox::drawing::Figures;
use shiftvox::picture::{Background, Shading};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TexturedStyle {
    pub erosion: Erosion,
    /// Samples per pixel and axis, as a power of two.
    pub aa_log2: u32,
    pub shading: Shading,
    pub background: Background,
}

pub fn of_textured(file: &TexturedFile, style: TexturedStyle) -> MeshDrawing<'_> {
    let draw = move |view: &RasterCamera| {
        let options = ViewOptions {
            erosion: style.erosion,
            raster: RasterOptions {
                samples: Samples::new(style.aa_log2, Pattern::Regular),
                light: light_of(view, style.shading),
                background: style.background.color(),
            },
        };
        let (drawn, counts) = view::draw(file, view, &options)?;
        let details = vec![("engine", json!("textured"))];
        Ok(Drawn::new(drawn, node_of, counters(file, &counts), details))
    };
    MeshDrawing::new(file.mesh_box(), style.aa_log2, Box::new(draw))
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
