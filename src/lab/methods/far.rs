//! Far voxels as a method.

use crate::drawing::mesh_view::{light_of, picture_of_far, view_of};
use crate::far::FarFile;
use crate::far::view::{FarCounts, FarPicture, FarViewer, Opacity, ViewOptions};
use crate::lab::error::{DrawingMethod, PixelStyle, Refused, Shown};
use crate::mesh::raster::RasterCamera;
use crate::picture::Picture;
use crate::project::Camera;

/// What a far voxel method is. By default: the usual file, six opacities, voxels of at most a
/// pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct FarSettings {
    /// What is unlike other files of the scene, such as `plain cosines`; empty for the usual one.
    pub file: String,
    /// What opacities are used for.
    pub opacity: Opacity,
    /// Largest projected side of a voxel, pixels.
    pub voxel_px: f64,
}

impl Default for FarSettings {
    fn default() -> Self {
        let ViewOptions {
            opacity, voxel_px, ..
        } = ViewOptions::default();
        Self {
            file: String::new(),
            opacity,
            voxel_px,
        }
    }
}

/// A file drawn with some settings.
pub struct FarMethod<'f> {
    file: &'f FarFile,
    viewer: FarViewer<'f>,
    settings: FarSettings,
    style: PixelStyle,
    view: Option<RasterCamera>,
}

impl<'f> FarMethod<'f> {
    /// Of a file.
    #[must_use]
    pub fn new(file: &'f FarFile, settings: FarSettings, style: PixelStyle) -> Self {
        Self {
            file,
            viewer: FarViewer::new(file),
            settings,
            style,
            view: None,
        }
    }

    fn drawn(&mut self, cut_of: Option<&RasterCamera>) -> Result<(FarPicture, FarCounts), Refused> {
        let view = self.view.ok_or(Refused::because("no camera yet"))?;
        let options = ViewOptions {
            voxel_px: self.settings.voxel_px,
            opacity: self.settings.opacity,
            light: light_of(&view, self.style.shading),
            background: Some(self.style.background),
            ..ViewOptions::default()
        };
        let cut_of = cut_of.unwrap_or(&view);
        let drawn = self.viewer.draw_with_cut_of(&view, cut_of, &options);
        drawn.map_err(Refused::because)
    }
}

/// Opacities in words.
#[must_use]
pub fn opacity_in_words(opacity: Opacity) -> &'static str {
    match opacity {
        Opacity::None => "none",
        Opacity::Scalar => "scalar",
        Opacity::Six => "six",
    }
}

impl DrawingMethod for FarMethod<'_> {
    fn family(&self) -> &'static str {
        "far voxels"
    }

    fn name(&self) -> String {
        let mut name = format!("far {}", opacity_in_words(self.settings.opacity));
        if self.settings.voxel_px != 1.0 {
            name += &format!(" lod {}", self.settings.voxel_px);
        }
        if !self.settings.file.is_empty() {
            name += &format!(", {}", self.settings.file);
        }
        name
    }

    fn settings(&self) -> Vec<(&'static str, String)> {
        vec![
            (
                "opacity",
                opacity_in_words(self.settings.opacity).to_owned(),
            ),
            ("lod", self.settings.voxel_px.to_string()),
            ("file", self.settings.file.clone()),
        ]
    }

    fn kind(&self) -> String {
        format!("far {}", opacity_in_words(self.settings.opacity))
    }

    fn begin(&mut self, camera: &Camera) -> Result<(), Refused> {
        let view = view_of(camera, self.file.bounds()).map_err(Refused::because)?;
        self.view = Some(view);
        Ok(())
    }

    fn draw(&mut self) -> Result<(), Refused> {
        std::hint::black_box(self.drawn(None)?);
        Ok(())
    }

    fn show(&mut self) -> Result<Shown, Refused> {
        let (drawn, counts) = self.drawn(None)?;
        let shares = drawn.coverage.clone();
        let voxels = counts.opaque_voxels + counts.transparent_voxels;
        Ok(Shown {
            picture: picture_of_far(drawn),
            shares,
            samples: None,
            vertices: Vec::new(),
            counters: vec![
                ("voxels_and_triangles", voxels + counts.triangles),
                ("opaque_voxels", counts.opaque_voxels),
                ("transparent_voxels", counts.transparent_voxels),
                ("triangles", counts.triangles),
                ("nodes_visited", counts.visited),
                ("nodes_hidden", counts.hidden),
            ],
            remark: (voxels == 0).then(|| "triangles alone".to_owned()),
        })
    }

    fn picture(&mut self) -> Result<Picture, Refused> {
        Ok(picture_of_far(self.drawn(None)?.0))
    }

    fn picture_with_cut_of(&mut self, other: &Camera) -> Result<Option<Picture>, Refused> {
        let other = view_of(other, self.file.bounds()).map_err(Refused::because)?;
        Ok(Some(picture_of_far(self.drawn(Some(&other))?.0)))
    }

    fn end(&mut self) {
        self.view = None;
        self.viewer = FarViewer::new(self.file);
    }
}
