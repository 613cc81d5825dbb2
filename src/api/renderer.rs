//! The renderer of the public API.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use hwmodel::Overflow;
use hwmodel::count::Counter;
use hwmodel::cycles::{Hardware, NoObserver, SimulationError};

use super::camera::View;
use super::kept::{Kept, Key};
use super::picture::Buffers;
use super::{Error, Picture, Scene};
use crate::drawing::{Canvas, DrawError, DrawnFrame, GraphDrawing, GraphStyle, check_samples};
use crate::fast::{Fast, FastOptions};
use crate::frame::Frame;
use crate::graph::GraphView;
use crate::machine::{Machine, MachineOptions, Simulated};
use crate::picture::{Background, Buffer, ResolveError, Rows, Shading, hash_rows, lights};
use crate::project::{
    self, CageKind, Coverage, Engine, EngineError, FrameSetup, Rendered, SetupOptions, Stats, Stop,
};
use crate::rays::Rays;

/// The engine that draws. Under [`Coverage::Exact`] all of them draw the same picture, bit for bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum EngineKind {
    /// The default: on all threads, with AVX2 if available.
    #[default]
    Fast,
    /// The image-order paper's loop, in counted words that cannot multiply: the reference of the hardware.
    Machine,
    /// One exact ray per sample, in wide integers: the oracle, which shares no arithmetic with the others. It draws
    /// [`Coverage::Exact`] only, and has no cage, tolerance or overflow.
    Rays,
}

/// Draws scenes. Each setting has a default for ordinary pictures. Threads, engine and frame are kept for the next
/// picture, until [`Renderer::forget`] or the end of the renderer.
///
/// ```
/// use shiftvox::{Camera, EngineKind, Renderer, Scene};
///
/// let scene = Scene::generate("menger,depth=2")?;
/// let camera = Camera::fit(&scene);
/// let fast = Renderer::new().render(&scene, &camera, 64, 64)?;
/// let oracle = Renderer::new().engine(EngineKind::Rays).render(&scene, &camera, 64, 64)?;
/// assert_eq!(fast.rgba(), oracle.rgba());
/// # Ok::<(), shiftvox::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Renderer {
    engine: Option<EngineKind>,
    coverage: Coverage,
    level_of_detail: Option<f64>,
    tolerance: Option<f64>,
    cage: Option<CageKind>,
    samples: u32,
    bits: u32,
    frac: Option<u32>,
    overflow: Option<Overflow>,
    shading: Shading,
    background: Background,
    threads: usize,
    counts_operations: bool,
    buffers: Vec<Buffer>,
    is_hashed: bool,
    stop: Stop,
    kept: Kept,
}

impl Default for Renderer {
    fn default() -> Self {
        Self::new()
    }
}

impl Renderer {
    /// The fast engine, exact coverage, one sample per pixel, shaded, on all threads.
    #[must_use]
    pub fn new() -> Self {
        let options = SetupOptions::default();
        Self {
            engine: None,
            coverage: options.coverage,
            level_of_detail: None,
            tolerance: None,
            cage: None,
            samples: 1,
            bits: options.bits,
            frac: options.frac,
            overflow: None,
            shading: Shading::default(),
            background: Background::default(),
            threads: 0,
            counts_operations: false,
            buffers: Vec::new(),
            is_hashed: false,
            stop: Stop::default(),
            kept: Kept::default(),
        }
    }

    setters! {
        /// The engine that draws.
        engine(engine: EngineKind) engine = Some(engine);
        /// The rule by which voxels cover samples. [`Coverage::Alpha`] is for voxels with opacities: those of meshes
        /// opened with opacities by the crate `shiftvox-mesh`, and of `.vxg` files made from such meshes.
        coverage(coverage: Coverage) coverage = coverage;
        /// The size, pixels, up to which nodes are drawn as one voxel. 0: only leaves. By default half a pixel with
        /// exact coverage, otherwise a pixel.
        level_of_detail(pixels: f64) level_of_detail = Some(pixels);
        /// Samples per pixel along each axis: 1, 2 or 4.
        samples(along_each_axis: u32) samples = along_each_axis;
        /// The deviation, samples, at which a record may change from clip space to screen space: 0 never, infinity
        /// always. Rules other than [`Coverage::Any`] and [`Coverage::Center`] allow only 0.
        tolerance(samples: f64) tolerance = Some(samples);
        /// Representation of a record's vertices. Changes the counters, but not the picture.
        cage(cage: CageKind) cage = Some(cage);
    }

    /// Width of a machine word, 16 to 64 bits, and its fraction bits (`None`: as many as the frame has room for).
    #[must_use]
    pub fn word(mut self, bits: u32, fraction_bits: Option<u32>) -> Self {
        self.bits = bits;
        self.frac = fraction_bits;
        self
    }

    /// The rules of the image-order paper: eight corners per record, screen space at once, [`Coverage::Any`].
    #[must_use]
    pub fn paper(self) -> Self {
        let paper = SetupOptions::paper();
        self.coverage(paper.coverage)
            .cage(paper.cage)
            .tolerance(paper.tolerance_px)
    }

    setters! {
        /// Treatment of a result that does not fit its word.
        overflow(overflow: Overflow) overflow = Some(overflow);
        /// Dependence of a voxel's colour on its orientation.
        shading(shading: Shading) shading = shading;
        /// The picture behind the object.
        background(background: Background) background = background;
        /// Threads that draw, up to 1024. 0: as many as available. Does not change the picture.
        threads(threads: usize) threads = threads;
    }

    /// Counts the operations of the machine, for [`Picture::operations`]. Selects [`EngineKind::Machine`]; another
    /// engine, selected later, is an error.
    #[must_use]
    pub fn count_operations(mut self) -> Self {
        self.engine = Some(EngineKind::Machine);
        self.counts_operations = true;
        self
    }

    /// Buffers in addition to the colours; none by default. Bytes per pixel: 4 for [`Buffer::Depth`], [`Buffer::Node`]
    /// and [`Buffer::Records`], 12 for [`Buffer::Normal`], 16 for [`Buffer::Voxel`].
    ///
    /// ```
    /// # use shiftvox::{Buffer, Camera, Renderer, Scene};
    /// # let scene = Scene::generate("menger,depth=2")?;
    /// let renderer = Renderer::new().buffers([Buffer::Depth]);
    /// let picture = renderer.render(&scene, &Camera::fit(&scene), 64, 64)?;
    /// assert!(picture.depth()?.iter().any(|depth| depth.is_finite()));
    /// assert!(picture.normals().is_err()); // not requested
    /// # Ok::<(), shiftvox::Error>(())
    /// ```
    #[must_use]
    pub fn buffers(mut self, buffers: impl IntoIterator<Item = Buffer>) -> Self {
        self.buffers = buffers.into_iter().collect();
        self
    }

    setters! {
        /// Whether pictures have a [hash](Picture::hash); no by default. It covers all buffers, so each is computed
        /// once.
        hashed(is_hashed: bool) is_hashed = is_hashed;
    }

    /// Lets another thread stop drawings: they fail with [`EngineError::Stopped`], usually within milliseconds.
    #[must_use]
    pub fn stopped_by(mut self, stop: &Stop) -> Self {
        self.stop = stop.clone();
        // Engines that are kept know another one.
        self.kept = Kept::default();
        self
    }

    /// Draws a picture of `width` x `height` pixels.
    ///
    /// Several threads may draw with one renderer at the same time.
    ///
    /// # Errors
    /// [`Error::Setup`] if camera and settings make no frame (such as a side of 0, or of more than 32,768 pixels),
    /// [`Error::Setting`] for an invalid setting, [`Error::Memory`] if the picture does not fit in memory,
    /// [`Error::Engine`] if a word overflows or the drawing is stopped, [`Error::Threads`] if the system provides no threads.
    pub fn render(
        &self,
        scene: &Scene,
        camera: &impl View,
        width: u32,
        height: u32,
    ) -> Result<Picture, Error> {
        let operations = self.counts_operations.then(Arc::default);
        let buffer_bytes = |buffer: &Buffer| 4 * buffer.entries() as u64;
        let bytes = 4 + self.buffers.iter().map(buffer_bytes).sum::<u64>();
        let camera = camera.of_size(width, height)?;
        let finish = |drawing: &mut GraphDrawing<'_>, drawn: &mut DrawnFrame| {
            drawing.resolve(drawn, |resolver| {
                let all = 0..resolver.size().1;
                let buffers = self.buffers.iter();
                let buffers =
                    buffers.map(|&buffer| Ok((buffer, resolver.rows(buffer, all.clone())?)));
                Ok(Buffers {
                    rgba: resolver.colors(all.clone())?,
                    others: buffers.collect::<Result<_, ResolveError>>()?,
                    hash: self.is_hashed.then(|| hash_rows(resolver)).transpose()?,
                })
            })
        };
        let (drawn, buffers) = self.draw(scene, &camera, bytes, operations.as_ref(), finish)?;
        let counted = |operations: Arc<Mutex<Counter>>| std::mem::take(&mut *lock(&operations));
        Ok(Picture {
            width,
            height,
            buffers,
            counters: drawn.stats,
            operations: operations.map(counted),
        })
    }

    /// Draws a picture into the caller's pixels, row by row from the top left: red, green, blue (sRGB) and alpha, as in
    /// [`Picture::rgba`]. Returns the counters, as [`Picture::counters`].
    ///
    /// ```
    /// # use shiftvox::{Camera, Renderer, Scene};
    /// # let scene = Scene::generate("menger,depth=2")?;
    /// let mut pixels = vec![[0; 4]; 64 * 48];
    /// Renderer::new().render_into(&scene, &Camera::fit(&scene), 64, 48, &mut pixels)?;
    /// # Ok::<(), shiftvox::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Renderer::render`], and [`Error::Setting`] if there are not `width * height` pixels, or if buffers, a hash
    /// or operations were requested, which only a [`Picture`] has.
    pub fn render_into(
        &self,
        scene: &Scene,
        camera: &impl View,
        width: u32,
        height: u32,
        pixels: &mut [[u8; 4]],
    ) -> Result<Stats, Error> {
        let wanted = u64::from(width) * u64::from(height);
        if pixels.len() as u64 != wanted {
            let reason = format!(
                "{} pixels are no picture of {width} x {height}",
                pixels.len()
            );
            return Err(Error::Setting(reason));
        }
        if !self.buffers.is_empty() || self.is_hashed || self.counts_operations {
            let reason = "buffers, hashes and operations are of `render`, not of `render_into`";
            return Err(Error::Setting(reason.to_owned()));
        }
        let camera = camera.of_size(width, height)?;
        let finish = |drawing: &mut GraphDrawing<'_>, drawn: &mut DrawnFrame| {
            drawing.resolve(drawn, |resolver| resolver.write_colors(0..height, pixels))
        };
        let (drawn, ()) = self.draw(scene, &camera, 0, None, finish)?;
        Ok(drawn.stats)
    }

    /// Draws a frame on an idle job, and makes something from it. `pixel_bytes`: memory that `finish` needs per pixel.
    fn draw<T: Send>(
        &self,
        scene: &Scene,
        camera: &project::Camera,
        pixel_bytes: u64,
        operations: Option<&Arc<Mutex<Counter>>>,
        finish: impl FnOnce(&mut GraphDrawing<'_>, &mut DrawnFrame) -> Result<T, DrawError> + Send,
    ) -> Result<(DrawnFrame, T), Error> {
        self.check_engine()?;
        let style = GraphStyle {
            options: self.options()?,
            shading: self.shading,
            background: self.background,
            buffers: self.buffers.clone(),
            is_hashed: self.is_hashed,
        };
        let mut job = self.kept.take(self.key())?;
        let kept = job.canvas.take();
        let draw = || {
            let engine = || self.make_engine(operations);
            // An engine that counts operations is new for each picture.
            let canvas = kept.filter(|_| operations.is_none());
            let canvas = canvas.unwrap_or_else(|| Canvas::new(engine()));
            let mut drawing = GraphDrawing::on(canvas, scene.graph(), scene.up(), style, engine);
            drawing.expect_pixel_bytes(pixel_bytes);
            let made = drawing.draw_frame(camera).and_then(|mut drawn| {
                let made = finish(&mut drawing, &mut drawn)?;
                Ok((drawn, made))
            });
            (made, drawing.into_canvas())
        };
        let (made, canvas) = match &job.pool {
            Some(pool) => pool.install(draw),
            None => draw(),
        };
        job.canvas = Some(canvas);
        self.kept.idle().push(job);
        Ok(made?)
    }

    /// Frees the memory that is kept for the next picture: that of the largest pictures drawn at the same time.
    pub fn forget(&self) {
        self.kept.idle().clear();
    }

    fn kind(&self) -> EngineKind {
        self.engine.unwrap_or_default()
    }

    fn key(&self) -> Key {
        Key {
            engine: self.kind(),
            overflow: self.overflow.unwrap_or_default(),
            threads: self.threads,
        }
    }

    fn make_engine(&self, operations: Option<&Arc<Mutex<Counter>>>) -> Box<dyn Engine + Send> {
        match (self.kind(), operations) {
            (EngineKind::Machine, Some(operations)) => Box::new(Counting {
                machine: self.machine(),
                operations: Arc::clone(operations),
            }),
            (EngineKind::Machine, None) => Box::new(self.machine()),
            (EngineKind::Rays, _) => Box::new(Rays::stopped_by(&self.stop)),
            (EngineKind::Fast, _) => {
                let options = FastOptions {
                    threads: self.threads,
                    ..FastOptions::default()
                };
                let fast = Fast::new(options, Box::new(self.machine()));
                Box::new(fast.stopped_by(&self.stop))
            }
        }
    }

    fn machine(&self) -> Machine {
        Machine::new(MachineOptions {
            overflow: self.overflow.unwrap_or_default(),
            ..MachineOptions::default()
        })
        .stopped_by(&self.stop)
    }

    /// Rejects settings that the engine does not have.
    fn check_engine(&self) -> Result<(), Error> {
        let of_machine = self.cage.is_some() || self.overflow.is_some() || self.tolerance.is_some();
        let reason = match self.kind() {
            EngineKind::Rays if self.coverage != Coverage::Exact => {
                "the rays draw exact coverage only"
            }
            EngineKind::Rays if of_machine => {
                "the rays have no cage, no overflow and no tolerance: leave these settings out"
            }
            EngineKind::Fast | EngineKind::Rays if self.counts_operations => {
                "only the machine counts operations, not the engine that was given"
            }
            _ => return Ok(()),
        };
        Err(Error::Setting(reason.to_owned()))
    }

    /// Draws on simulated hardware. Returns cycles, their causes, and the machine's counters.
    ///
    /// # Errors
    /// As [`Renderer::render`], [`Error::Setting`] for an engine other than the machine, and [`Error::Simulate`] if the
    /// hardware's description is invalid or its stack overflows.
    pub fn simulate(
        &self,
        scene: &Scene,
        camera: &impl View,
        width: u32,
        height: u32,
        hardware: &Hardware,
    ) -> Result<Simulated, Error> {
        if !matches!(self.engine, None | Some(EngineKind::Machine)) {
            let reason = "the machine is simulated, not the engine that was given";
            return Err(Error::Setting(reason.to_owned()));
        }
        let graph = scene.graph();
        let options = self.options()?;
        let camera = camera.of_size(width, height)?;
        check_samples(&camera, options.aa_log2, FRAME_BYTES, 0, 0)?;
        let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, &options)?;
        let light = lights(graph, &setup, self.shading).map_err(Error::Memory)?;
        let view = graph.lit(&light);
        let mut frame = Frame::nodes_only(0, 0);
        self.machine()
            .simulate(&view, &setup, &mut frame, hardware, &mut NoObserver)
            .map_err(|e| match e {
                SimulationError::Workload(EngineError::Memory(short)) => Error::Memory(short),
                other => Error::Simulate(other.into()),
            })
    }

    fn options(&self) -> Result<SetupOptions, Error> {
        let aa_log2 = match self.samples {
            1 => 0,
            2 => 1,
            4 => 2,
            other => {
                return Err(Error::Setting(format!(
                    "a pixel has 1, 2 or 4 samples along each axis, not {other}"
                )));
            }
        };
        let defaults = SetupOptions::of(self.coverage);
        Ok(SetupOptions {
            bits: self.bits,
            frac: self.frac,
            cage: self.cage.unwrap_or(defaults.cage),
            tolerance_px: self.tolerance.unwrap_or(defaults.tolerance_px),
            lod_px: self.level_of_detail.unwrap_or(defaults.lod_px),
            aa_log2,
            ..defaults
        })
    }
}

/// Bytes per sample with its voxel and blending.
const FRAME_BYTES: u64 = 36;

/// The machine with a probe that counts its operations.
struct Counting {
    machine: Machine,
    operations: Arc<Mutex<Counter>>,
}

fn lock(operations: &Mutex<Counter>) -> MutexGuard<'_, Counter> {
    operations.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Engine for Counting {
    fn render(&mut self, graph: &GraphView<'_>, setup: &FrameSetup, frame: &mut Frame) -> Rendered {
        let (stats, counter) = self.machine.count(graph, setup, frame)?;
        *lock(&self.operations) = counter;
        Ok(stats)
    }
}
