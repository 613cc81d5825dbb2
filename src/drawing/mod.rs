//! One trait for everything that can be drawn: voxel graphs, far voxels, textured voxels, triangles, the hybrid. The
//! [result](Drawable::shown) has one form: colours, buffers, times and counters.

mod graph;

use std::borrow::Cow;
use std::ops::Range;
use std::time::Instant;

use serde_json::Value;

use crate::budget::{self, Shortage};
use crate::frame::{TooManySamples, count_samples};
use crate::picture::npy::Values;
use crate::picture::{Buffer, Picture, Pixels, ResolveError, Resolver, Rows};
use crate::project::{Bounds, Camera, CameraError, EngineError, SetupError, Up};

pub use crate::project::Canvas;
pub use graph::{DrawnFrame, GraphDrawing, GraphStyle};

pub trait Drawable {
    /// The box, and points that enclose the contents, for a fitted camera.
    fn bounds(&self) -> Bounds;

    fn up(&self) -> Up;

    /// Draws a frame `runs` times (0 counts as 1), each time completely, and keeps the last. After an error nothing is
    /// shown.
    fn draw(&mut self, camera: &Camera, runs: u32) -> Result<(), DrawError>;

    /// The last picture. Fails when its buffers cannot be made.
    fn shown(&self) -> Result<Option<Shown<'_>>, DrawError>;

    /// A function that draws the frame of a camera again and again, on its own engine, to measure times.
    fn frames(&self, camera: &Camera) -> Result<Frames<'_>, DrawError>;
}

pub type Frames<'d> = Box<dyn FnMut() -> Result<(), DrawError> + Send + 'd>;

pub type Figures = Vec<(&'static str, Value)>;

pub struct Shown<'d> {
    pub pixels: Cow<'d, Pixels>,
    pub buffers: Buffers<'d>,
    /// Pixels that show something at their middle sample.
    pub pixels_drawn: usize,
    /// The covered share of each pixel; empty if the method does not know it.
    pub coverage: &'d [f32],
    pub times_ms: &'d [f64],
    pub counters: Figures,
    pub details: Figures,
}

/// The buffers of a picture in memory, or of an engine's frame.
pub enum Buffers<'d> {
    Whole(&'d Picture),
    Resolved(Box<Resolver<'d>>),
}

impl Rows for Buffers<'_> {
    type Error = ResolveError;

    fn size(&self) -> (u32, u32) {
        match self {
            Self::Whole(picture) => picture.size(),
            Self::Resolved(resolver) => resolver.size(),
        }
    }

    fn rows(&self, buffer: Buffer, rows: Range<u32>) -> Result<Values, ResolveError> {
        match self {
            Self::Whole(picture) => picture.rows(buffer, rows).map_err(|never| match never {}),
            Self::Resolved(resolver) => resolver.rows(buffer, rows),
        }
    }
}

#[derive(Debug, thiserror::Error)]
pub enum DrawError {
    #[error(transparent)]
    TooLarge(#[from] TooManySamples),
    #[error(transparent)]
    Memory(#[from] Shortage),
    #[error(transparent)]
    Camera(#[from] CameraError),
    #[error(transparent)]
    Setup(#[from] SetupError),
    #[error(transparent)]
    Engine(#[from] EngineError),
    #[error(transparent)]
    Resolve(#[from] ResolveError),
    #[error(transparent)]
    Method(Box<dyn std::error::Error + Send + Sync>),
}

/// Checks that a picture fits in memory: `sample_bytes` per sample and `pixel_bytes` per pixel. `aa_log2`: logarithm of
/// the samples per pixel and axis. `held`: memory that will be freed or reused, bytes. Errors: [`DrawError::TooLarge`]
/// for more than 2^27 samples, [`DrawError::Memory`] for more memory than is free.
pub fn check_samples(
    camera: &Camera,
    aa_log2: u32,
    sample_bytes: u64,
    pixel_bytes: u64,
    held: u64,
) -> Result<(), DrawError> {
    let pixels = u64::from(camera.width) * u64::from(camera.height);
    let samples = count_samples(camera.width, camera.height, aa_log2)?;
    let needed = (samples * sample_bytes + pixels * pixel_bytes).saturating_sub(held);
    if needed > UNCHECKED_BYTES {
        budget::check("a picture of this size", needed)?;
    }
    Ok(())
}

/// Less memory is not checked, because the check takes longer than drawing a small picture.
const UNCHECKED_BYTES: u64 = 1 << 24;
pub const COLOR_BYTES: u64 = 3;
pub fn timed<T>(
    runs: u32,
    mut run: impl FnMut() -> Result<T, DrawError>,
) -> Result<(T, Vec<f64>), DrawError> {
    let mut times_ms = Vec::new();
    loop {
        let started = now();
        let result = run()?;
        times_ms.push(started.map_or(0.0, milliseconds_since));
        if times_ms.len() >= runs as usize {
            return Ok((result, times_ms));
        }
    }
}

/// WebAssembly has no clock of its own.
fn now() -> Option<Instant> {
    (!cfg!(target_family = "wasm")).then(Instant::now)
}

pub fn milliseconds_since(started: Instant) -> f64 {
    started.elapsed().as_secs_f64() * 1e3
}
