//! Far voxels as a method.

use super::{key_light, view_of};
use crate::far::FarFile;
use crate::far::view::{Counts, FarPicture, FarViewer, Opacity, ViewOptions};
use crate::lab::error::{Look, Method, Refused, Shown};
use crate::mesh::raster::View;
use crate::picture::{Picture, Shading};
use crate::project::Camera;

/// A `.far` file, drawn with opacities or without.
pub struct FarMethod<'f> {
    file: &'f FarFile,
    opacity: Opacity,
    look: Look,
    ready: Option<(View, FarViewer<'f>)>,
}

impl<'f> FarMethod<'f> {
    /// Voxels of at most a pixel.
    #[must_use]
    pub fn new(file: &'f FarFile, opacity: Opacity, look: Look) -> Self {
        Self {
            file,
            opacity,
            look,
            ready: None,
        }
    }

    fn drawn(&mut self) -> Result<(FarPicture, Counts), Refused> {
        let Some((view, viewer)) = &mut self.ready else {
            return Err(Refused::because("no camera yet"));
        };
        let options = ViewOptions {
            opacity: self.opacity,
            light: match self.look.shading {
                Shading::Lambert => Some(key_light(view)),
                Shading::Flat => None,
            },
            background: Some(self.look.background),
            ..ViewOptions::default()
        };
        viewer.draw(view, &options).map_err(Refused::because)
    }

    fn opacity_name(&self) -> &'static str {
        match self.opacity {
            Opacity::None => "none",
            Opacity::Scalar => "scalar",
            Opacity::Six => "six",
        }
    }
}

impl Method for FarMethod<'_> {
    fn family(&self) -> &'static str {
        "far voxels"
    }

    fn name(&self) -> String {
        format!("far {}", self.opacity_name())
    }

    fn settings(&self) -> Vec<(&'static str, String)> {
        vec![("opacity", self.opacity_name().to_owned())]
    }

    fn kind(&self) -> String {
        "far voxels".to_owned()
    }

    fn begin(&mut self, camera: &Camera) -> Result<(), Refused> {
        let view = view_of(camera, self.file.bounds()).map_err(Refused::because)?;
        self.ready = Some((view, FarViewer::new(self.file)));
        Ok(())
    }

    fn draw(&mut self) -> Result<(), Refused> {
        std::hint::black_box(self.drawn()?);
        Ok(())
    }

    fn show(&mut self) -> Result<Shown, Refused> {
        let (drawn, counts) = self.drawn()?;
        let voxels = counts.opaque_voxels + counts.transparent_voxels;
        Ok(Shown {
            shares: drawn.coverage.clone(),
            picture: as_picture(drawn),
            samples: None,
            vertices: Vec::new(),
            counters: vec![
                ("voxels_and_triangles", voxels + counts.triangles),
                ("opaque_voxels", counts.opaque_voxels),
                ("transparent_voxels", counts.transparent_voxels),
                ("triangles", counts.triangles),
                ("nodes_visited", counts.visited),
            ],
            remark: (voxels == 0).then(|| "triangles alone".to_owned()),
        })
    }

    fn picture(&mut self) -> Result<Picture, Refused> {
        self.drawn().map(|(drawn, _)| as_picture(drawn))
    }

    fn picture_with_cut_of(&mut self, _other: &Camera) -> Result<Option<Picture>, Refused> {
        Ok(None)
    }

    fn end(&mut self) {
        self.ready = None;
    }
}

fn as_picture(drawn: FarPicture) -> Picture {
    let pixels = drawn.rgba.len();
    Picture {
        width: drawn.width,
        height: drawn.height,
        rgba: drawn.rgba,
        depth: drawn.depth,
        normal: vec![[0.0; 3]; pixels],
        voxel: vec![[0, 0, 0, -1]; pixels],
        node: drawn.node,
        records: None,
    }
}
