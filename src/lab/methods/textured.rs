//! Textured voxels as a method.

use super::triangles::{options, shown};
use crate::drawing::mesh_view::{picture_of_triangles, view_of};
use crate::lab::error::{DrawingMethod, PixelStyle, Refused, Shown};
use crate::mesh::raster::{Pattern, RasterCamera, RasterPicture, Samples};
use crate::picture::Picture;
use crate::project::Camera;
use crate::textured::TexturedFile;
use crate::textured::view::{Detail, TexturedCounts, ViewOptions, choose, draw};

/// A `.tvx` file, drawn at a level of detail.
pub struct TexturedMethod<'f> {
    file: &'f TexturedFile,
    detail: Detail,
    samples: Samples,
    style: PixelStyle,
    ready: Option<RasterCamera>,
}

impl<'f> TexturedMethod<'f> {
    /// With 1, 4, 16 or 256 samples a pixel.
    ///
    /// # Errors
    /// With another number.
    pub fn new(
        file: &'f TexturedFile,
        detail: Detail,
        per_pixel: u32,
        style: PixelStyle,
    ) -> Result<Self, Refused> {
        let samples = Samples::new(per_pixel, Pattern::Regular).map_err(Refused::because)?;
        Ok(Self {
            file,
            detail,
            samples,
            style,
            ready: None,
        })
    }

    fn drawn(&self, detail: Detail) -> Result<(RasterPicture, TexturedCounts), Refused> {
        let Some(view) = &self.ready else {
            return Err(Refused::because("no camera yet"));
        };
        let raster = options(view, self.samples, self.style);
        let options = ViewOptions {
            detail,
            samples: raster.samples,
            light: raster.light,
            background: raster.background,
        };
        draw(self.file, view, &options).map_err(Refused::because)
    }

    fn detail_in_words(&self) -> String {
        match self.detail {
            Detail::Auto { .. } => "auto".to_owned(),
            Detail::Level { grid, level } => {
                let cells = self.file.grid(grid).cell_grid().cells();
                format!("{cells} eroded {level}")
            }
        }
    }
}

impl DrawingMethod for TexturedMethod<'_> {
    fn family(&self) -> &'static str {
        "textured voxels"
    }

    fn name(&self) -> String {
        let samples = match self.samples.per_pixel() {
            1 => String::new(),
            more => format!(", {more} samples"),
        };
        format!("textured {}{samples}", self.detail_in_words())
    }

    fn settings(&self) -> Vec<(&'static str, String)> {
        vec![
            ("detail", self.detail_in_words()),
            ("samples", self.samples.per_pixel().to_string()),
        ]
    }

    fn kind(&self) -> String {
        "textured voxels".to_owned()
    }

    fn begin(&mut self, camera: &Camera) -> Result<(), Refused> {
        let view = view_of(camera, self.file.bounds()).map_err(Refused::because)?;
        self.ready = Some(view);
        Ok(())
    }

    fn draw(&mut self) -> Result<(), Refused> {
        std::hint::black_box(self.drawn(self.detail)?);
        Ok(())
    }

    fn show(&mut self) -> Result<Shown, Refused> {
        let (drawn, counts) = self.drawn(self.detail)?;
        let cells = self.file.grid(counts.choice.grid).cell_grid().cells();
        let counters = vec![
            ("triangles", counts.primitives + 2 * counts.surfels),
            ("primitives", counts.primitives),
            ("surfels", counts.surfels),
            ("voxels", counts.voxels),
            ("grid", u64::from(cells)),
            ("erosion", u64::from(counts.choice.level)),
        ];
        let mut shown = shown(drawn, counters);
        if counts.surfels == 0 {
            shown.remark = Some("triangles alone".to_owned());
        }
        Ok(shown)
    }

    fn picture(&mut self) -> Result<Picture, Refused> {
        self.drawn(self.detail)
            .map(|(drawn, _)| picture_of_triangles(drawn))
    }

    fn picture_with_cut_of(&mut self, other: &Camera) -> Result<Option<Picture>, Refused> {
        let Detail::Auto { texel_px } = self.detail else {
            return Ok(None);
        };
        let view = view_of(other, self.file.bounds()).map_err(Refused::because)?;
        let choice = choose(self.file, &view, texel_px);
        let detail = Detail::Level {
            grid: choice.grid,
            level: choice.level,
        };
        let (drawn, _) = self.drawn(detail)?;
        Ok(Some(picture_of_triangles(drawn)))
    }

    fn end(&mut self) {
        self.ready = None;
    }
}
