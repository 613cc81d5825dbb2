//! Methods of meshes as [`Drawable`]: far voxels, textured voxels, triangles.

mod far;
pub mod mesh_view;
mod textured;
mod triangles;

use std::borrow::Cow;

use shiftvox::drawing::{
    Buffers, COLOR_BYTES, DrawError, Drawable, Figures, Frames, Shown, check_samples, timed,
};
use shiftvox::graph::MeshBox;
use shiftvox::picture::{Picture, Pixels};
use shiftvox::project::{Bounds, Camera, Up};

use crate::raster::{RasterCamera, RasterPicture};
use crate::view_error::ViewError;
use mesh_view::view_of;

pub use far::{FarStyle, of_far};
pub use textured::{TexturedStyle, of_textured};
pub use triangles::{TrianglesStyle, of_triangles};

/// Least memory of a sample, bytes: colour, depth, and the triangle or node that is seen.
const MESH_SAMPLE_BYTES: u64 = 8;

struct Drawn {
    picture: Picture,
    coverage: Vec<f32>,
    counters: Figures,
    details: Figures,
}

impl Drawn {
    /// A picture without normals and voxels. `node` gives -1 for [`NOTHING`](crate::raster::NOTHING).
    fn new(
        drawn: RasterPicture,
        node: fn(u32) -> i32,
        counters: Figures,
        details: Figures,
    ) -> Self {
        let picture = Picture {
            width: drawn.width,
            height: drawn.height,
            normal: vec![[0.0; 3]; drawn.rgba.len()],
            voxel: vec![[0, 0, 0, -1]; drawn.rgba.len()],
            rgba: drawn.rgba,
            depth: drawn.depth,
            node: drawn.seen.into_iter().map(node).collect(),
            records: None,
        };
        Self {
            picture,
            coverage: drawn.coverage,
            counters,
            details,
        }
    }
}

type Draw<'m> = Box<dyn Fn(&RasterCamera) -> Result<Drawn, ViewError> + Send + Sync + 'm>;

/// A drawing by a method of meshes, from one or several cameras.
pub struct MeshDrawing<'m> {
    mesh_box: MeshBox,
    /// Samples per pixel and axis, as a power of two, that take memory at the same time.
    aa_log2: u32,
    draw: Draw<'m>,
    kept: Option<(Drawn, Vec<f64>)>,
}

impl<'m> MeshDrawing<'m> {
    fn new(mesh_box: MeshBox, aa_log2: u32, draw: Draw<'m>) -> Self {
        Self {
            mesh_box,
            aa_log2,
            draw,
            kept: None,
        }
    }

    fn view(&self, camera: &Camera) -> Result<RasterCamera, DrawError> {
        let MeshBox { low, high, .. } = self.mesh_box;
        Ok(view_of(camera, (low.into(), high.into()))?)
    }
}

impl Drawable for MeshDrawing<'_> {
    fn bounds(&self) -> Bounds {
        Bounds::of_mesh(&self.mesh_box)
    }

    fn up(&self) -> Up {
        Up::y_or_z(self.mesh_box.y_up)
    }

    fn draw(&mut self, camera: &Camera, runs: u32) -> Result<(), DrawError> {
        self.kept = None;
        check_samples(camera, self.aa_log2, MESH_SAMPLE_BYTES, COLOR_BYTES, 0)?;
        let view = self.view(camera)?;
        let (mut drawn, times) = timed(runs, || Ok((self.draw)(&view)?))?;
        if camera.ortho.is_some() {
            // The distant eye's depths become the camera's.
            let behind = (camera.eye - view.eye).dot(view.forward);
            for depth in &mut drawn.picture.depth {
                *depth = (f64::from(*depth) - behind) as f32;
            }
        }
        self.kept = Some((drawn, times));
        Ok(())
    }

    fn shown(&self) -> Result<Option<Shown<'_>>, DrawError> {
        let Some((drawn, times_ms)) = &self.kept else {
            return Ok(None);
        };
        let Picture { width, height, .. } = drawn.picture;
        let pixels = Pixels::new(width, height, drawn.picture.rgba.clone());
        Ok(Some(Shown {
            pixels: Cow::Owned(pixels),
            buffers: Buffers::Whole(&drawn.picture),
            pixels_drawn: drawn.picture.drawn(),
            coverage: &drawn.coverage,
            times_ms,
            counters: drawn.counters.clone(),
            details: drawn.details.clone(),
        }))
    }

    fn frames(&self, camera: &Camera) -> Result<Frames<'_>, DrawError> {
        let view = self.view(camera)?;
        Ok(Box::new(move || {
            std::hint::black_box((self.draw)(&view)?);
            Ok(())
        }))
    }
}
