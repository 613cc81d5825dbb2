//! The triangle rasteriser as a method: what other ways to draw a mesh have to beat.

use crate::drawing::mesh_view::{light_of, picture_of_triangles, view_of};
use crate::graph::Silent;
use crate::lab::error::{DrawingMethod, PixelStyle, Refused, Shown};
use crate::mesh::Surface;
use crate::mesh::raster::{self, Pattern, RasterCamera, RasterOptions, RasterPicture, Samples};
use crate::picture::Picture;
use crate::project::{Camera, Stats};

/// Triangles at some samples a pixel, in the middles of equal squares.
pub struct TrianglesMethod<'m> {
    surface: &'m dyn Surface,
    samples: Samples,
    style: PixelStyle,
    view: Option<RasterCamera>,
}

impl<'m> TrianglesMethod<'m> {
    /// With 1, 4, 16 or 256 samples a pixel.
    ///
    /// # Errors
    /// With another number.
    pub fn new(
        surface: &'m dyn Surface,
        per_pixel: u32,
        style: PixelStyle,
    ) -> Result<Self, Refused> {
        let samples = Samples::new(per_pixel, Pattern::Regular).map_err(Refused::because)?;
        Ok(Self {
            surface,
            samples,
            style,
            view: None,
        })
    }

    fn drawn(&self) -> Result<RasterPicture, Refused> {
        let view = self.view.ok_or(Refused::because("no camera yet"))?;
        let options = options(&view, self.samples, self.style);
        raster::draw(self.surface, &view, &options, &Silent).map_err(Refused::because)
    }
}

impl DrawingMethod for TrianglesMethod<'_> {
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
        let view = view_of(camera, self.surface.bounds()).map_err(Refused::because)?;
        self.view = Some(view);
        Ok(())
    }

    fn draw(&mut self) -> Result<(), Refused> {
        std::hint::black_box(self.drawn()?);
        Ok(())
    }

    fn show(&mut self) -> Result<Shown, Refused> {
        let drawn = self.drawn()?;
        let samples = drawn.rgba.len() * self.samples.per_pixel();
        let counters = vec![
            ("triangles", self.surface.len() as u64),
            ("samples", samples as u64),
        ];
        Ok(shown(drawn, counters))
    }

    fn picture(&mut self) -> Result<Picture, Refused> {
        Ok(picture_of_triangles(self.drawn()?))
    }

    fn picture_with_cut_of(&mut self, _: &Camera) -> Result<Option<Picture>, Refused> {
        Ok(None)
    }

    fn end(&mut self) {
        self.view = None;
    }
}

/// What the rasteriser is to draw with.
pub(super) fn options(view: &RasterCamera, samples: Samples, style: PixelStyle) -> RasterOptions {
    RasterOptions {
        samples,
        light: light_of(view, style.shading),
        background: Some(style.background),
    }
}

/// A rasterised picture and what was counted.
pub(super) fn shown(drawn: RasterPicture, counters: Stats) -> Shown {
    Shown {
        shares: drawn.coverage.clone(),
        picture: picture_of_triangles(drawn),
        samples: None,
        vertices: Vec::new(),
        counters,
        remark: None,
    }
}
