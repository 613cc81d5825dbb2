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

use crate::raster::{NO_TRIANGLE, RasterCamera, RasterError, RasterPicture, SamplesError};
use mesh_view::view_of;

pub use far::{FarDrawing, FarMethod, FarStyle, resident};
pub use textured::{TexturedDrawing, TexturedMethod, TexturedStyle};
pub use triangles::{TrianglesDrawing, TrianglesMethod, TrianglesStyle};

/// Why a method of meshes did not draw a frame: the contents of [`DrawError::Method`].
#[derive(Debug, thiserror::Error)]
pub enum MethodError {
    #[error(transparent)]
    Far(#[from] crate::far::view::ViewError),
    #[error(transparent)]
    Textured(#[from] crate::textured::view::ViewError),
    #[error(transparent)]
    Raster(#[from] RasterError),
    #[error(transparent)]
    Samples(#[from] SamplesError),
}

impl From<MethodError> for DrawError {
    fn from(error: MethodError) -> Self {
        Self::Method(Box::new(error))
    }
}

/// Least memory of a sample, bytes: colour, depth, and the triangle or node that is seen.
const MESH_SAMPLE_BYTES: u64 = 8;

pub struct Drawn {
    picture: Picture,
    coverage: Vec<f32>,
    counters: Figures,
}

impl Drawn {
    /// A picture without normals and voxels. A node is -1 where nothing is seen.
    fn new(
        (width, height): (u32, u32),
        rgba: Vec<[u8; 4]>,
        depth: Vec<f32>,
        node: Vec<i32>,
        coverage: Vec<f32>,
        counters: Figures,
    ) -> Self {
        let picture = Picture {
            width,
            height,
            normal: vec![[0.0; 3]; rgba.len()],
            voxel: vec![[0, 0, 0, -1]; rgba.len()],
            rgba,
            depth,
            node,
            records: None,
        };
        Self {
            picture,
            coverage,
            counters,
        }
    }

    fn of_triangles(drawn: RasterPicture, counters: Figures) -> Self {
        let node = |&triangle: &u32| if triangle == NO_TRIANGLE { -1 } else { 0 };
        let nodes = drawn.triangle.iter().map(node).collect();
        let (size, coverage) = ((drawn.width, drawn.height), drawn.coverage);
        Self::new(size, drawn.rgba, drawn.depth, nodes, coverage, counters)
    }
}

pub trait Method: Clone + Send {
    fn mesh_box(&self) -> MeshBox;

    /// Samples per pixel and axis, as a power of two, that take memory at the same time.
    fn aa_log2(&self) -> u32;

    fn draw(&mut self, view: &RasterCamera) -> Result<Drawn, MethodError>;

    fn details(&self) -> Figures;
}

/// A drawing by a method, from one or several cameras.
pub struct MethodDrawing<M> {
    method: M,
    kept: Option<(Drawn, Vec<f64>)>,
}

impl<M: Method> MethodDrawing<M> {
    fn of(method: M) -> Self {
        Self { method, kept: None }
    }

    fn view(&self, camera: &Camera) -> Result<RasterCamera, DrawError> {
        let MeshBox { low, high, .. } = self.method.mesh_box();
        Ok(view_of(camera, (low.into(), high.into()))?)
    }
}

impl<M: Method> Drawable for MethodDrawing<M> {
    fn bounds(&self) -> Bounds {
        Bounds::of_mesh(&self.method.mesh_box())
    }

    fn up(&self) -> Up {
        Up::y_or_z(self.method.mesh_box().y_up)
    }

    fn draw(&mut self, camera: &Camera, runs: u32) -> Result<(), DrawError> {
        self.kept = None;
        let aa_log2 = self.method.aa_log2();
        check_samples(camera, aa_log2, MESH_SAMPLE_BYTES, COLOR_BYTES, 0)?;
        let view = self.view(camera)?;
        let (mut drawn, times) = timed(runs, || Ok(self.method.draw(&view)?))?;
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
            details: self.method.details(),
        }))
    }

    fn frames(&self, camera: &Camera) -> Result<Frames<'_>, DrawError> {
        let view = self.view(camera)?;
        let mut method = self.method.clone();
        Ok(Box::new(move || {
            std::hint::black_box(method.draw(&view)?);
            Ok(())
        }))
    }
}
