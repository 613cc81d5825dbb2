//! The triangles of a mesh: the reference picture of the other methods.

use serde_json::json;

use super::mesh_view::light_of;
use super::{Drawn, Method, MethodDrawing, MethodError};
use crate::raster::{self, RasterCamera, RasterOptions, Samples};
use crate::{Mesh, mesh_box};
use shiftvox::drawing::Figures;
use shiftvox::graph::{MeshBox, Progress};
use shiftvox::picture::{Background, Shading};
use shiftvox::project::Up;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrianglesStyle {
    pub samples: Samples,
    pub shading: Shading,
    pub background: Background,
}

#[derive(Clone)]
pub struct TrianglesMethod<'m> {
    mesh: &'m Mesh,
    mesh_box: MeshBox,
    style: TrianglesStyle,
    progress: &'m dyn Progress,
}

pub type TrianglesDrawing<'m> = MethodDrawing<TrianglesMethod<'m>>;

impl<'m> TrianglesDrawing<'m> {
    pub fn new(mesh: &'m Mesh, up: Up, style: TrianglesStyle, progress: &'m dyn Progress) -> Self {
        Self::of(TrianglesMethod {
            mesh,
            mesh_box: mesh_box(mesh, up == Up::Y),
            style,
            progress,
        })
    }
}

impl Method for TrianglesMethod<'_> {
    fn mesh_box(&self) -> MeshBox {
        self.mesh_box
    }

    fn aa_log2(&self) -> u32 {
        0
    }

    fn draw(&mut self, view: &RasterCamera) -> Result<Drawn, MethodError> {
        let samples = self.style.samples;
        let options = RasterOptions {
            samples,
            light: light_of(view, self.style.shading),
            background: self.style.background.color(),
        };
        let drawn = raster::draw(self.mesh, view, &options, self.progress)?;
        let samples = drawn.rgba.len() * samples.per_pixel();
        let triangles = self.mesh.triangles().len();
        let counters = vec![("triangles", json!(triangles)), ("samples", json!(samples))];
        Ok(Drawn::of_triangles(drawn, counters))
    }

    fn details(&self) -> Figures {
        vec![("engine", json!("triangles"))]
    }
}
