//! Triangles with a depth buffer: the honest rival.

use super::{as_picture, key_light, view_of};
use crate::graph::Silent;
use crate::lab::error::{Look, Method, Refused, Shown};
use crate::mesh::Surface;
use crate::mesh::raster::{self, Pattern, RasterOptions, RasterPicture, Samples, View};
use crate::picture::{Picture, Shading};
use crate::project::Camera;

/// A mesh drawn as triangles.
pub struct TrianglesMethod<'m, S: ?Sized> {
    mesh: &'m S,
    samples: Samples,
    look: Look,
    ready: Option<(View, RasterOptions)>,
}

impl<'m, S: Surface + ?Sized> TrianglesMethod<'m, S> {
    /// With 1, 4, 16 or 256 samples a pixel, in the middles of equal squares.
    ///
    /// # Errors
    /// With another number.
    pub fn new(mesh: &'m S, per_pixel: u32, look: Look) -> Result<Self, Refused> {
        let samples = Samples::new(per_pixel, Pattern::Regular).map_err(Refused::because)?;
        Ok(Self {
            mesh,
            samples,
            look,
            ready: None,
        })
    }

    fn drawn(&self) -> Result<RasterPicture, Refused> {
        let Some((view, options)) = &self.ready else {
            return Err(Refused::because("no camera yet"));
        };
        raster::draw(self.mesh, view, options, &Silent).map_err(Refused::because)
    }
}

impl<S: Surface + ?Sized> Method for TrianglesMethod<'_, S>
where
    for<'m> &'m S: Send,
{
    fn family(&self) -> &'static str {
        "triangles"
    }

    fn name(&self) -> String {
        match self.samples.per_pixel() {
            1 => "triangles".to_owned(),
            more => format!("triangles {more}"),
        }
    }

    fn settings(&self) -> Vec<(&'static str, String)> {
        vec![("samples", self.samples.per_pixel().to_string())]
    }

    fn kind(&self) -> String {
        "triangles".to_owned()
    }

    fn begin(&mut self, camera: &Camera) -> Result<(), Refused> {
        let view = view_of(camera, self.mesh.bounds()).map_err(Refused::because)?;
        self.ready = Some((view, options(&view, self.samples, self.look)));
        Ok(())
    }

    fn draw(&mut self) -> Result<(), Refused> {
        std::hint::black_box(self.drawn()?);
        Ok(())
    }

    fn show(&mut self) -> Result<Shown, Refused> {
        let drawn = self.drawn()?;
        let pixels = drawn.rgba.len() * self.samples.per_pixel();
        Ok(shown(
            drawn,
            vec![
                ("triangles", self.mesh.len() as u64),
                ("samples", pixels as u64),
            ],
        ))
    }

    fn picture(&mut self) -> Result<Picture, Refused> {
        self.drawn().map(as_picture)
    }

    fn picture_with_cut_of(&mut self, _other: &Camera) -> Result<Option<Picture>, Refused> {
        Ok(None)
    }

    fn end(&mut self) {
        self.ready = None;
    }
}

/// What the rasteriser is to draw with.
pub(super) fn options(view: &View, samples: Samples, look: Look) -> RasterOptions {
    RasterOptions {
        samples,
        light: match look.shading {
            Shading::Lambert => Some(key_light(view)),
            Shading::Flat => None,
        },
        background: Some(look.background),
    }
}

/// A rasterised picture and what was counted.
pub(super) fn shown(drawn: RasterPicture, counters: crate::project::Stats) -> Shown {
    Shown {
        shares: drawn.coverage.clone(),
        picture: as_picture(drawn),
        samples: None,
        vertices: Vec::new(),
        counters,
        remark: None,
    }
}
