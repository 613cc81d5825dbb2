//! The triangles of a mesh as something that can be drawn: the reference picture of the other
//! methods.

use serde_json::json;

use super::mesh_view::{light_of, picture_of_triangles, view_of};
use super::{KeptPicture, MESH_SAMPLE_BYTES, MethodError};
use crate::raster::{self, RasterCamera, RasterOptions, RasterPicture, Samples};
use crate::{Mesh, mesh_box};
use shiftvox::drawing::{COLOR_BYTES, DrawError, Drawable, Frames, Shown, check_samples, timed};
use shiftvox::graph::Progress;
use shiftvox::picture::{Background, Shading};
use shiftvox::project::{Bounds, Camera, Up};

/// What triangles are drawn with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrianglesStyle {
    /// Samples of a pixel.
    pub samples: Samples,
    /// Light.
    pub shading: Shading,
    /// What is behind.
    pub background: Background,
}

/// A mesh that is drawn with a depth buffer, once or from many cameras.
pub struct TrianglesDrawing<'m> {
    mesh: &'m Mesh,
    up: Up,
    style: TrianglesStyle,
    progress: &'m dyn Progress,
    kept: Option<KeptPicture>,
}

impl<'m> TrianglesDrawing<'m> {
    /// Nothing is drawn yet.
    #[must_use]
    pub fn new(mesh: &'m Mesh, up: Up, style: TrianglesStyle, progress: &'m dyn Progress) -> Self {
        Self {
            mesh,
            up,
            style,
            progress,
            kept: None,
        }
    }

    fn drawn(&self, view: &RasterCamera) -> Result<RasterPicture, MethodError> {
        let options = RasterOptions {
            samples: self.style.samples,
            light: light_of(view, self.style.shading),
            background: self.style.background.color(),
        };
        Ok(raster::draw(self.mesh, view, &options, self.progress)?)
    }
}

impl Drawable for TrianglesDrawing<'_> {
    fn bounds(&self) -> Bounds {
        Bounds::of_mesh(&mesh_box(self.mesh, self.up == Up::Y))
    }

    fn up(&self) -> Up {
        self.up
    }

    fn draw(&mut self, camera: &Camera, runs: u32) -> Result<(), DrawError> {
        self.kept = None;
        check_samples(camera, 0, MESH_SAMPLE_BYTES, COLOR_BYTES, 0)?;
        let view = view_of(camera, self.mesh.bounds())?;
        let (mut drawn, times_ms) = timed(runs, || Ok(self.drawn(&view)?))?;
        let samples = drawn.rgba.len() * self.style.samples.per_pixel();
        let coverage = std::mem::take(&mut drawn.coverage);
        self.kept = Some(KeptPicture {
            picture: picture_of_triangles(drawn),
            coverage,
            counters: vec![
                ("triangles", json!(self.mesh.triangles().len())),
                ("samples", json!(samples)),
            ],
            times_ms,
        });
        Ok(())
    }

    fn shown(&self) -> Result<Option<Shown<'_>>, DrawError> {
        let details = || vec![("engine", json!("triangles"))];
        Ok(self.kept.as_ref().map(|kept| kept.shown(details())))
    }

    fn frames(&self, camera: &Camera) -> Result<Frames<'_>, DrawError> {
        let view = view_of(camera, self.mesh.bounds())?;
        Ok(Box::new(move || {
            std::hint::black_box(self.drawn(&view)?);
            Ok(())
        }))
    }
}
