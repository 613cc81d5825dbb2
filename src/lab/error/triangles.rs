//! The triangle rasteriser as a method: what other ways to draw a mesh have to beat.

use super::mesh_view::{mesh_light, mesh_view};
use super::method::{Method, Refused, Shown};
use super::voxels::Look;
use crate::graph::Silent;
use crate::mesh::Surface;
use crate::mesh::raster::{self, RasterOptions, RasterPicture, Samples, View};
use crate::picture::Picture;
use crate::project::Camera;

/// Triangles at some samples a pixel, in the middles of equal squares.
pub struct TrianglesMethod<'m> {
    surface: &'m dyn Surface,
    samples: Samples,
    look: Look,
    view: Option<View>,
}

impl<'m> TrianglesMethod<'m> {
    /// At so many samples.
    #[must_use]
    pub fn new(surface: &'m dyn Surface, samples: Samples, look: Look) -> Self {
        Self {
            surface,
            samples,
            look,
            view: None,
        }
    }

    fn drawn(&self) -> Result<RasterPicture, Refused> {
        let view = self.view.ok_or(Refused::because("no camera yet"))?;
        let options = RasterOptions {
            samples: self.samples,
            light: mesh_light(&view, self.look.shading),
            background: Some(self.look.background),
        };
        raster::draw(self.surface, &view, &options, &Silent).map_err(Refused::because)
    }
}

impl Method for TrianglesMethod<'_> {
    fn family(&self) -> &'static str {
        "triangles"
    }

    fn name(&self) -> String {
        format!("triangles {}", self.samples.per_pixel())
    }

    fn settings(&self) -> Vec<(&'static str, String)> {
        vec![("samples", self.samples.per_pixel().to_string())]
    }

    fn kind(&self) -> String {
        "triangles".to_owned()
    }

    fn begin(&mut self, camera: &Camera) -> Result<(), Refused> {
        let view = mesh_view(camera, self.surface.bounds()).map_err(Refused::because)?;
        self.view = Some(view);
        Ok(())
    }

    fn draw(&mut self) -> Result<(), Refused> {
        std::hint::black_box(self.drawn()?);
        Ok(())
    }

    fn show(&mut self) -> Result<Shown, Refused> {
        let drawn = self.drawn()?;
        let shares = drawn.coverage.clone();
        Ok(Shown {
            picture: picture_of(drawn),
            shares,
            samples: None,
            vertices: Vec::new(),
            counters: vec![
                ("primitives", self.surface.len() as u64),
                ("triangles", self.surface.len() as u64),
            ],
            remark: None,
        })
    }

    fn picture(&mut self) -> Result<Picture, Refused> {
        Ok(picture_of(self.drawn()?))
    }

    fn picture_with_cut_of(&mut self, _: &Camera) -> Result<Option<Picture>, Refused> {
        Ok(None)
    }

    fn end(&mut self) {
        self.view = None;
    }
}

fn picture_of(drawn: RasterPicture) -> Picture {
    let pixels = drawn.rgba.len();
    let node = |&triangle: &u32| i32::try_from(triangle).unwrap_or(-1);
    Picture {
        width: drawn.width,
        height: drawn.height,
        rgba: drawn.rgba,
        depth: drawn.depth,
        normal: vec![[0.0; 3]; pixels],
        voxel: vec![[0, 0, 0, -1]; pixels],
        node: drawn.triangle.iter().map(node).collect(),
        records: None,
    }
}
