//! Far voxels as something that can be drawn.

use serde_json::{Value, json};

use super::mesh_view::{light_of, picture_of_far, view_of};
use super::{KeptPicture, MESH_SAMPLE_BYTES, MethodError};
use crate::far::FarFile;
use crate::far::view::{FarCounts, FarViewer, Opacity, ViewOptions};
use crate::raster::RasterCamera;
use shiftvox::drawing::{
    COLOR_BYTES, DrawError, Drawable, Figures, Frames, Shown, check_samples, timed,
};
use shiftvox::picture::{Background, Shading};
use shiftvox::project::{Bounds, Camera, Up};

/// What far voxels are drawn with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FarStyle {
    /// Largest voxel, pixels; above 0.
    pub voxel_px: f64,
    /// Samples per pixel and axis, as a power of two.
    pub aa_log2: u32,
    /// What opacities are used for.
    pub opacity: Opacity,
    /// Light.
    pub shading: Shading,
    /// What is behind.
    pub background: Background,
}

impl FarStyle {
    /// As a viewer wants it.
    #[must_use]
    pub fn options(&self, view: &RasterCamera) -> ViewOptions {
        ViewOptions {
            voxel_px: self.voxel_px,
            samples_across: 1 << self.aa_log2,
            opacity: self.opacity,
            light: light_of(view, self.shading),
            background: self.background.color(),
            ..ViewOptions::default()
        }
    }
}

/// A file of far voxels that is drawn, once or from many cameras.
pub struct FarDrawing<'f> {
    file: &'f FarFile,
    viewer: FarViewer<'f>,
    style: FarStyle,
    kept: Option<KeptPicture>,
}

impl<'f> FarDrawing<'f> {
    /// Nothing is drawn yet.
    #[must_use]
    pub fn new(file: &'f FarFile, style: FarStyle) -> Self {
        Self {
            file,
            viewer: FarViewer::new(file),
            style,
            kept: None,
        }
    }
}

impl Drawable for FarDrawing<'_> {
    fn bounds(&self) -> Bounds {
        Bounds::of_mesh(&self.file.mesh_box())
    }

    fn up(&self) -> Up {
        Up::y_or_z(self.file.y_up())
    }

    fn draw(&mut self, camera: &Camera, runs: u32) -> Result<(), DrawError> {
        self.kept = None;
        check_samples(
            camera,
            self.style.aa_log2,
            MESH_SAMPLE_BYTES,
            COLOR_BYTES,
            0,
        )?;
        let view = view_of(camera, self.file.bounds())?;
        let options = self.style.options(&view);
        let ((picture, coverage, counts), times_ms) = timed(runs, || {
            let (mut drawn, counts) = self
                .viewer
                .draw(&view, &options)
                .map_err(MethodError::from)?;
            let coverage = std::mem::take(&mut drawn.coverage);
            Ok((picture_of_far(drawn), coverage, counts))
        })?;
        self.kept = Some(KeptPicture {
            picture,
            coverage,
            counters: counters(&counts),
            times_ms,
        });
        Ok(())
    }

    fn shown(&self) -> Result<Option<Shown<'_>>, DrawError> {
        let details = || {
            vec![
                ("engine", json!("far")),
                ("memory", json!(resident(self.file))),
            ]
        };
        Ok(self.kept.as_ref().map(|kept| kept.shown(details())))
    }

    fn frames(&self, camera: &Camera) -> Result<Frames<'_>, DrawError> {
        let view = view_of(camera, self.file.bounds())?;
        let options = self.style.options(&view);
        let mut viewer = FarViewer::new(self.file);
        Ok(Box::new(move || {
            std::hint::black_box(viewer.draw(&view, &options).map_err(MethodError::from)?);
            Ok(())
        }))
    }
}

/// What a budget of memory came to; `None` without one.
#[must_use]
pub fn resident(file: &FarFile) -> Option<Value> {
    let resident = file.resident()?;
    Some(json!({
        "bytes": resident.bytes,
        "most_bytes": resident.most_bytes,
        "nodes_released": resident.released,
    }))
}

fn counters(counts: &FarCounts) -> Figures {
    let counters = [
        ("nodes_visited", counts.visited),
        ("nodes_outside", counts.outside),
        ("voxel_nodes", counts.voxel_nodes),
        ("leaves", counts.leaves),
        ("nodes_hidden", counts.hidden),
        ("queries", counts.queries),
        ("opaque_voxels", counts.opaque_voxels),
        ("transparent_voxels", counts.transparent_voxels),
        ("triangles", counts.triangles),
        ("drawn_twice", counts.drawn_twice),
        ("bytes", counts.bytes),
    ];
    counters.map(|(name, count)| (name, count.into())).to_vec()
}
