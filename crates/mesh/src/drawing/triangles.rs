//! The triangles of a mesh: the reference picture of the other methods.

use serde_json::json;

use super::mesh_view::light_of;
use super::{Drawn, MeshDrawing};
use crate::raster::{self, NOTHING, RasterCamera, RasterOptions, Samples};
use crate::{Mesh, mesh_box};
use shiftvox::graph::Progress;
use shiftvox::picture::{Background, Shading};
use shiftvox::project::Up;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrianglesStyle {
    pub samples: Samples,
    pub shading: Shading,
    pub background: Background,
}

pub fn of_triangles<'m>(
    mesh: &'m Mesh,
    up: Up,
    style: TrianglesStyle,
    progress: &'m dyn Progress,
) -> MeshDrawing<'m> {
    let draw = move |view: &RasterCamera| {
        let options = RasterOptions {
            samples: style.samples,
            light: light_of(view, style.shading),
            background: style.background.color(),
        };
        let drawn = raster::draw(mesh, view, &options, progress)?;
        let samples = drawn.rgba.len() * style.samples.per_pixel();
        let triangles = mesh.triangles().len();
        let counters = vec![("triangles", json!(triangles)), ("samples", json!(samples))];
        let details = vec![("engine", json!("triangles"))];
        Ok(Drawn::new(drawn, node_of, counters, details))
    };
    MeshDrawing::new(mesh_box(mesh, up == Up::Y), 0, Box::new(draw))
}

/// Triangles are of no node: 0 where one is seen, else -1.
pub(super) fn node_of(triangle: u32) -> i32 {
    -i32::from(triangle == NOTHING)
}
