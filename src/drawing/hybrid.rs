//! The hybrid as something that can be drawn.

use serde_json::json;

use super::mesh_view::{light_of, picture_of_far, view_of};
use super::{
    DrawError, Drawable, Frames, KeptPicture, MESH_SAMPLE_BYTES, Shown, check_samples, timed,
};
use crate::far::view::ViewOptions;
use crate::hybrid::Hybrid;
use crate::mesh::raster::RasterCamera;
use crate::picture::{Background, Shading};
use crate::project::{Bounds, Camera, Up};

/// What a hybrid is drawn with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HybridStyle {
    /// Largest pixel of a level, in pixels of the picture; above 0.
    pub level_px: f64,
    /// Samples per pixel and axis, as a power of two: 0, 1, 2 or 4.
    pub aa_log2: u32,
    /// Light.
    pub shading: Shading,
    /// What is behind.
    pub background: Background,
}

impl HybridStyle {
    fn options(&self, view: &RasterCamera) -> ViewOptions {
        ViewOptions {
            voxel_px: self.level_px,
            samples_across: 1 << self.aa_log2,
            light: light_of(view, self.shading),
            background: self.background.color(),
            ..ViewOptions::default()
        }
    }
}

/// A hybrid that is drawn, once or from many cameras.
pub struct HybridDrawing<'h> {
    hybrid: &'h Hybrid,
    style: HybridStyle,
    kept: Option<KeptPicture>,
}

impl<'h> HybridDrawing<'h> {
    /// Nothing is drawn yet.
    #[must_use]
    pub fn new(hybrid: &'h Hybrid, style: HybridStyle) -> Self {
        Self {
            hybrid,
            style,
            kept: None,
        }
    }
}

impl Drawable for HybridDrawing<'_> {
    /// The box around the mesh; which corners it fills is not kept.
    fn bounds(&self) -> Bounds {
        let (low, high) = self.hybrid.bounds();
        Bounds {
            low,
            high,
            hull: Vec::new(),
        }
    }

    fn up(&self) -> Up {
        Up::Y
    }

    fn draw(&mut self, camera: &Camera, runs: u32) -> Result<(), DrawError> {
        self.kept = None;
        check_samples(camera, self.style.aa_log2, MESH_SAMPLE_BYTES)?;
        let view = view_of(camera, self.hybrid.bounds())?;
        let options = self.style.options(&view);
        let ((mut drawn, level, [triangles, voxels]), times_ms) =
            timed(runs, || Ok(self.hybrid.draw(&view, &options)?))?;
        let coverage = std::mem::take(&mut drawn.coverage);
        self.kept = Some(KeptPicture {
            picture: picture_of_far(drawn),
            coverage,
            counters: vec![
                ("triangles", json!(triangles)),
                ("voxels", json!(voxels)),
                ("bytes", json!(level.bytes)),
            ],
            times_ms,
        });
        Ok(())
    }

    fn shown(&self) -> Result<Option<Shown<'_>>, DrawError> {
        let details = || vec![("engine", json!("hybrid"))];
        Ok(self.kept.as_ref().map(|kept| kept.shown(details())))
    }

    fn frames(&self, camera: &Camera) -> Result<Frames<'_>, DrawError> {
        let view = view_of(camera, self.hybrid.bounds())?;
        let options = self.style.options(&view);
        Ok(Box::new(move || {
            std::hint::black_box(self.hybrid.draw(&view, &options)?);
            Ok(())
        }))
    }
}
