//! The renderer of the public API.

use hwmodel::Overflow;
use hwmodel::count::Counter;
use hwmodel::cycles::{Hardware, NoObserver};
use rayon::ThreadPoolBuilder;

use super::camera::View;
use super::{Error, Picture, Scene};
use crate::drawing::{GraphDrawing, GraphStyle, check_samples};
use crate::fast::{Fast, FastOptions};
use crate::frame::Frame;
use crate::graph::GraphView;
use crate::machine::{Machine, MachineOptions, Simulated};
use crate::picture::{Background, Buffer, Rows, Shading, hash_rows, lights};
use crate::project::{self, CageKind, Coverage, Engine, FrameSetup, SetupOptions};
use crate::rays::Rays;

const MOST_THREADS: usize = 1024;
/// Bytes per sample with its voxel and blending.
const FRAME_BYTES: u64 = 36;

/// The engine that draws. Under [`Coverage::Exact`] all of them draw the same picture, bit for bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum EngineKind {
    /// The default: on all threads, with AVX2 if available.
    #[default]
    Fast,
    /// The image-order paper's loop, in counted words that cannot multiply: the reference of the hardware.
    Machine,
    /// One exact ray per sample, in wide integers: the oracle, which shares no code with the others. It draws
    /// [`Coverage::Exact`] only, and has no cage, tolerance or overflow.
    Rays,
}

/// Draws scenes. Each setting has a default for ordinary pictures.
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
#[derive(Debug, Clone, Default)]
pub struct Renderer {
    engine: Option<EngineKind>,
    coverage: Coverage,
    level_of_detail: Option<f64>,
    tolerance: Option<f64>,
    cage: Option<CageKind>,
    samples: Option<u32>,
    bits: Option<u32>,
    frac: Option<u32>,
    overflow: Option<Overflow>,
    shading: Shading,
    background: Background,
    threads: usize,
    counts_operations: bool,
    buffers: Vec<Buffer>,
    is_hashed: bool,
}

impl Renderer {
    /// The fast engine, exact coverage, one sample per pixel, shaded, on all threads.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    setters! {
        /// The engine that draws.
        engine(engine: EngineKind) engine = Some(engine);
        /// The rule by which voxels cover samples. [`Coverage::Alpha`] is for voxels with opacities, which meshes give
        /// (crate `shiftvox-mesh`).
        coverage(coverage: Coverage) coverage = coverage;
        /// The size, pixels, up to which nodes are drawn as one voxel. 0: only leaves. By default half a pixel with
        /// exact coverage, otherwise a pixel.
        level_of_detail(pixels: f64) level_of_detail = Some(pixels);
        /// Samples per pixel along each axis: 1, 2 or 4.
        samples(along_each_axis: u32) samples = Some(along_each_axis);
        /// The deviation, samples, at which a record may change from clip space to screen space: 0 never, infinity
        /// always. Rules other than [`Coverage::Any`] and [`Coverage::Center`] allow only 0.
        tolerance(samples: f64) tolerance = Some(samples);
        /// Representation of a record's vertices. Changes the counters, but not the picture.
        cage(cage: CageKind) cage = Some(cage);
        /// Treatment of a result that does not fit its word.
        overflow(overflow: Overflow) overflow = Some(overflow);
        /// Dependence of a voxel's colour on its orientation.
        shading(shading: Shading) shading = shading;
        /// The picture behind the object.
        background(background: Background) background = background;
        /// Threads that draw, up to 1024. 0: as many as available. Does not change the picture.
        threads(threads: usize) threads = threads;
        /// Whether pictures have a [hash](Picture::hash), which is over all buffers; no by default.
        hashed(is_hashed: bool) is_hashed = is_hashed;
    }

    /// Width of a machine word, 16 to 64 bits, and its fraction bits (`None`: as many as the frame has room for).
    #[must_use]
    pub fn word(mut self, bits: u32, fraction_bits: Option<u32>) -> Self {
        self.bits = Some(bits);
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

    /// Counts the operations of the machine, for [`Picture::operations`]. Selects [`EngineKind::Machine`]; another
    /// engine, selected later, is an error.
    #[must_use]
    pub fn count_operations(mut self) -> Self {
        self.engine = Some(EngineKind::Machine);
        self.counts_operations = true;
        self
    }

    /// Buffers in addition to the colours; none by default.
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

    /// Draws a picture of `width` x `height` pixels.
    ///
    /// # Errors
    /// [`Error::Setup`] if camera and settings make no frame, [`Error::Setting`] for an invalid setting, [`Error::Memory`] if the picture does not fit in memory,
    /// [`Error::Engine`] if a word overflows, [`Error::Threads`] if the system provides no threads.
    pub fn render(
        &self,
        scene: &Scene,
        camera: &impl View,
        width: u32,
        height: u32,
    ) -> Result<Picture, Error> {
        self.check_engine()?;
        let camera = camera.of_size(width, height)?;
        match self.threads {
            0 => self.draw(scene, &camera),
            1..=MOST_THREADS => {
                let pool = ThreadPoolBuilder::new().num_threads(self.threads).build();
                let pool = pool.map_err(|e| Error::Threads(e.into()))?;
                pool.install(|| self.draw(scene, &camera))
            }
            more => {
                let reason = format!("threads: 0 to {MOST_THREADS}, not {more}");
                Err(Error::Setting(reason))
            }
        }
    }

    fn draw(&self, scene: &Scene, camera: &project::Camera) -> Result<Picture, Error> {
        let style = GraphStyle {
            options: self.options()?,
            shading: self.shading,
            background: self.background,
            buffers: self.buffers.clone(),
            is_hashed: self.is_hashed,
        };
        let engine = || self.make_engine();
        let mut drawing = GraphDrawing::new(scene.graph(), scene.up(), style, engine);
        let entries = self.buffers.iter().map(|buffer| buffer.entries() as u64);
        drawing.expect_pixel_bytes(4 + 4 * entries.sum::<u64>());
        let mut drawn = drawing.draw_frame(camera)?;
        let (rgba, others, hash) = drawing.resolve(&mut drawn, |resolver| {
            let all = 0..camera.height;
            let numbers = |&buffer: &Buffer| {
                let values = resolver.rows(buffer, all.clone());
                values.map(|values| (buffer, values))
            };
            let others = self.buffers.iter().map(numbers);
            let others = others.collect::<Result<_, _>>()?;
            let hash = self.is_hashed.then(|| hash_rows(resolver)).transpose()?;
            Ok((resolver.colors(all)?, others, hash))
        })?;
        let operations = match self.counts_operations {
            true => Some(self.count(scene, camera)?),
            false => None,
        };
        Ok(Picture {
            width: camera.width,
            height: camera.height,
            rgba,
            others,
            hash,
            counters: drawn.stats,
            operations,
        })
    }

    fn make_engine(&self) -> Box<dyn Engine + Send> {
        match self.engine.unwrap_or_default() {
            EngineKind::Machine => Box::new(self.machine()),
            EngineKind::Rays => Box::new(Rays),
            EngineKind::Fast => {
                let options = FastOptions::default();
                Box::new(Fast::new(options, Box::new(self.machine())))
            }
        }
    }

    fn machine(&self) -> Machine {
        Machine::new(MachineOptions {
            overflow: self.overflow.unwrap_or_default(),
            ..MachineOptions::default()
        })
    }

    /// Rejects settings that the engine does not have.
    fn check_engine(&self) -> Result<(), Error> {
        let of_machine = self.cage.is_some() || self.overflow.is_some() || self.tolerance.is_some();
        let reason = match self.engine.unwrap_or_default() {
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
        let camera = camera.of_size(width, height)?;
        self.on_machine(scene, &camera, |machine, graph, setup, frame| {
            let simulated = machine.simulate(graph, setup, frame, hardware, &mut NoObserver);
            simulated.map_err(|e| Error::Simulate(e.into()))
        })
    }

    fn count(&self, scene: &Scene, camera: &project::Camera) -> Result<Counter, Error> {
        self.on_machine(scene, camera, |machine, graph, setup, frame| {
            let (_, counter) = machine.render_probed(graph, setup, frame, Counter::new())?;
            Ok(counter)
        })
    }

    fn on_machine<T>(
        &self,
        scene: &Scene,
        camera: &project::Camera,
        draw: impl FnOnce(&mut Machine, &GraphView<'_>, &FrameSetup, &mut Frame) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let (graph, options) = (scene.graph(), self.options()?);
        check_samples(camera, options.aa_log2, FRAME_BYTES, 0, 0)?;
        let setup = FrameSetup::new(camera, &graph.placement, graph.depth, &options)?;
        let light = lights(graph, &setup, self.shading);
        let view = GraphView {
            light: &light,
            ..graph.view()
        };
        let mut frame = Frame::new(setup.width, setup.height, false);
        draw(&mut self.machine(), &view, &setup, &mut frame)
    }

    fn options(&self) -> Result<SetupOptions, Error> {
        let samples = self.samples.unwrap_or(1);
        if ![1, 2, 4].contains(&samples) {
            let reason = format!("a pixel has 1, 2 or 4 samples along each axis, not {samples}");
            return Err(Error::Setting(reason));
        }
        let defaults = SetupOptions::of(self.coverage);
        Ok(SetupOptions {
            bits: self.bits.unwrap_or(defaults.bits),
            frac: self.frac,
            cage: self.cage.unwrap_or(defaults.cage),
            tolerance_px: self.tolerance.unwrap_or(defaults.tolerance_px),
            lod_px: self.level_of_detail.unwrap_or(defaults.lod_px),
            aa_log2: samples.ilog2(),
            ..defaults
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::Camera;
    use super::*;

    fn sponge() -> Scene {
        Scene::generate("menger,depth=2").expect("a scene")
    }

    fn refusal(renderer: &Renderer, camera: &impl View) -> String {
        match renderer.render(&sponge(), camera, 8, 8) {
            Err(Error::Setting(reason)) => reason,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn settings_that_an_engine_does_not_have_are_rejected() {
        let (scene, camera) = (sponge(), Camera::fit(&sponge()));
        let rays = Renderer::new().engine(EngineKind::Rays);
        assert!(rays.render(&scene, &camera, 8, 8).is_ok());
        for (renderer, word) in [
            (rays.clone().coverage(Coverage::Alpha), "exact"),
            (rays.clone().coverage(Coverage::Any), "exact"),
            (rays.clone().cage(CageKind::Corners), "cage"),
            (rays.clone().overflow(Overflow::Wrap), "overflow"),
            (rays.clone().tolerance(1.0), "tolerance"),
            (Renderer::new().samples(3), "1, 2 or 4"),
            (Renderer::new().threads(MOST_THREADS + 1), "0 to 1024"),
            (Renderer::new().threads(usize::MAX), "0 to 1024"),
        ] {
            let reason = refusal(&renderer, &camera);
            assert!(reason.contains(word), "{reason}");
        }
        let counting = Renderer::new().count_operations();
        for engine in [EngineKind::Fast, EngineKind::Rays] {
            let reason = refusal(&counting.clone().engine(engine), &camera);
            assert!(reason.contains("operations"), "{reason}");
        }
        let counted = counting.engine(EngineKind::Machine);
        assert!(counted.render(&scene, &camera, 8, 8).is_ok());
        let hardware = Hardware::preset("light").expect("a preset");
        let simulated = |renderer: Renderer| renderer.simulate(&scene, &camera, 8, 8, &hardware);
        assert!(matches!(simulated(rays), Err(Error::Setting(_))));
        assert!(simulated(Renderer::new()).is_ok());
    }

    #[test]
    fn a_zoom_is_above_zero() {
        let fitted = Camera::fit(&sponge());
        for zoom in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(refusal(&Renderer::new(), &fitted.clone().zoom(zoom)).contains("zoom"));
        }
    }

    #[test]
    fn a_picture_that_is_too_large_is_an_error() {
        let (scene, camera) = (sponge(), Camera::fit(&sponge()));
        let renderer = Renderer::new();
        let drawn = renderer.render(&scene, &camera, 1 << 15, (1 << 12) + 1);
        assert!(matches!(drawn, Err(Error::Setting(_))), "{drawn:?}");
        let drawn = renderer.render(&scene, &camera, u32::MAX, u32::MAX);
        assert!(matches!(drawn, Err(Error::Setting(_))), "{drawn:?}");
    }
}
