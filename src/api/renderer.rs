//! How a picture is drawn.

use hwmodel::Overflow;
use hwmodel::count::Counter;
use hwmodel::cycles::{Hardware, NoObserver};
use rayon::ThreadPoolBuilder;

use super::{Camera, Error, Picture, Scene};
use crate::fast::{Fast, FastOptions};
use crate::frame::{Frame, count_samples};
use crate::graph::GraphView;
use crate::machine::{Machine, MachineOptions, Simulated};
use crate::picture::{Background, Shading, lights, resolve};
use crate::project::{CageKind, Coverage, Engine, FrameSetup, SetupOptions};
use crate::rays::Rays;

/// Most threads that a picture may ask for, as on the command line.
const MOST_THREADS: usize = 1024;

/// Which engine draws. Under [`Coverage::Exact`] all of them draw the same picture, bit for bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum EngineKind {
    /// The default: on all threads, with AVX2 where the processor has it.
    #[default]
    Fast,
    /// The image-order paper's loop, in counted words that cannot multiply: the reference of the hardware.
    Machine,
    /// One exact ray a sample, in wide integers: the oracle, which shares no code with the others. Always draws the
    /// exact picture, whatever cage and tolerance say; it refuses [`Coverage::Alpha`], since it blends nothing.
    Rays,
}

/// Draws scenes. Settings are given one after the other; each has a default that is right for a picture.
///
/// ```
/// use shiftvox::{Camera, EngineKind, Renderer, Scene};
///
/// let scene = Scene::generate("menger,depth=2")?;
/// let camera = Camera::fit(&scene);
/// let fast = Renderer::new().render(&scene, &camera, 64, 64)?;
/// let oracle = Renderer::new().engine(EngineKind::Rays).render(&scene, &camera, 64, 64)?;
/// assert_eq!(fast.hash(), oracle.hash());
/// # Ok::<(), shiftvox::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Renderer {
    engine: EngineKind,
    coverage: Coverage,
    level_of_detail: Option<f64>,
    tolerance: Option<f64>,
    cage: CageKind,
    samples: u32,
    bits: u32,
    frac: Option<u32>,
    overflow: Overflow,
    shading: Shading,
    background: Background,
    threads: usize,
    counts_operations: bool,
}

impl Default for Renderer {
    fn default() -> Self {
        Self::new()
    }
}

impl Renderer {
    /// The fast engine, exact coverage, one sample a pixel, shaded, on all threads.
    #[must_use]
    pub fn new() -> Self {
        let options = SetupOptions::default();
        Self {
            engine: EngineKind::default(),
            coverage: options.coverage,
            level_of_detail: None,
            tolerance: None,
            cage: options.cage,
            samples: 1,
            bits: options.bits,
            frac: options.frac,
            overflow: Overflow::Trap,
            shading: Shading::default(),
            background: Background::default(),
            threads: 0,
            counts_operations: false,
        }
    }

    /// Which engine draws.
    #[must_use]
    pub fn engine(mut self, engine: EngineKind) -> Self {
        self.engine = engine;
        self
    }

    /// Which samples a voxel covers. [`Coverage::Alpha`] is for voxels with opacities: those of meshes
    /// opened with [`SceneOptions::opacities`](crate::SceneOptions), and of `.vxg` files made of such meshes.
    #[must_use]
    pub fn coverage(mut self, coverage: Coverage) -> Self {
        self.coverage = coverage;
        self
    }

    /// The size, pixels, up to which nodes are drawn as one voxel; 0: only leaves. By default half a pixel with
    /// exact coverage, else a pixel.
    #[must_use]
    pub fn level_of_detail(mut self, pixels: f64) -> Self {
        self.level_of_detail = Some(pixels);
        self
    }

    /// Samples of a pixel along each axis: 1, 2 or 4.
    #[must_use]
    pub fn samples(mut self, along_each_axis: u32) -> Self {
        self.samples = along_each_axis;
        self
    }

    /// The deviation, samples, at which a record may change from clip space to screen space; 0 never, infinity at
    /// once. Of [`Coverage::Any`] and [`Coverage::Center`]; the other rules take 0.
    #[must_use]
    pub fn tolerance(mut self, samples: f64) -> Self {
        self.tolerance = Some(samples);
        self
    }

    /// How a record holds its vertices. Changes what is counted, never the picture.
    #[must_use]
    pub fn cage(mut self, cage: CageKind) -> Self {
        self.cage = cage;
        self
    }

    /// Width of a machine word, 16 to 64 bits, and its fraction bits (`None`: as many as the frame has room
    /// for).
    #[must_use]
    pub fn word(mut self, bits: u32, fraction_bits: Option<u32>) -> Self {
        self.bits = bits;
        self.frac = fraction_bits;
        self
    }

    /// What a result becomes that does not fit its word.
    #[must_use]
    pub fn overflow(mut self, overflow: Overflow) -> Self {
        self.overflow = overflow;
        self
    }

    /// The rules of the image-order paper: eight corners a record, screen space at once, [`Coverage::Any`].
    #[must_use]
    pub fn paper(self) -> Self {
        let paper = SetupOptions::paper();
        self.coverage(paper.coverage)
            .cage(paper.cage)
            .tolerance(paper.tolerance_px)
    }

    /// How a voxel's colour depends on where it looks.
    #[must_use]
    pub fn shading(mut self, shading: Shading) -> Self {
        self.shading = shading;
        self
    }

    /// What is behind the object.
    #[must_use]
    pub fn background(mut self, background: Background) -> Self {
        self.background = background;
        self
    }

    /// Threads that draw, up to 1024; 0: as many as there are. Never changes the picture.
    #[must_use]
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = threads;
        self
    }

    /// Counts the operations of the machine, for [`Picture::operations`]. Draws with [`EngineKind::Machine`]; another
    /// engine, given later, counts none and is refused.
    #[must_use]
    pub fn count_operations(mut self) -> Self {
        self.engine = EngineKind::Machine;
        self.counts_operations = true;
        self
    }

    /// Draws a picture of `width` x `height` pixels.
    ///
    /// # Errors
    /// [`Error::Setup`] where camera and settings make no frame (such as a side of 0, or of more than 32,768 pixels),
    /// [`Error::Setting`] for samples other than 1, 2 and 4, for more than 2^27 samples in all, for a zoom of 0 or
    /// less, for more than 1024 threads and for what camera or engine do not have, [`Error::Engine`] where a word
    /// overflows, [`Error::Threads`] where the system gives no threads.
    pub fn render(
        &self,
        scene: &Scene,
        camera: &Camera,
        width: u32,
        height: u32,
    ) -> Result<Picture, Error> {
        let draw = || self.render_here(scene, camera, width, height);
        match self.threads {
            0 => draw(),
            // Refused before any is made.
            threads if threads > MOST_THREADS => Err(Error::Setting(format!(
                "threads: 0 to {MOST_THREADS}, not {threads}"
            ))),
            threads => {
                let pool = ThreadPoolBuilder::new().num_threads(threads).build();
                pool.map_err(|e| Error::Threads(e.into()))?.install(draw)
            }
        }
    }

    /// [`Renderer::render`] on the threads of the current pool.
    fn render_here(
        &self,
        scene: &Scene,
        camera: &Camera,
        width: u32,
        height: u32,
    ) -> Result<Picture, Error> {
        self.check_engine()?;
        let setup = self.set_up(scene, camera, width, height)?;
        let light = lights(scene.graph(), &setup, self.shading);
        let view = lit(scene, &light);
        let mut frame = Frame::new(setup.width, setup.height, false);
        let mut operations = None;
        let counters = match self.engine {
            EngineKind::Machine if self.counts_operations => {
                let (stats, counter) =
                    self.machine()
                        .render_probed(&view, &setup, &mut frame, Counter::new())?;
                operations = Some(counter);
                stats
            }
            EngineKind::Machine => self.machine().render(&view, &setup, &mut frame)?,
            EngineKind::Rays => Rays.render(&view, &setup, &mut frame)?,
            EngineKind::Fast => {
                let options = FastOptions {
                    threads: self.threads,
                    ..FastOptions::default()
                };
                Fast::new(options, Box::new(self.machine())).render(&view, &setup, &mut frame)?
            }
        };
        let buffers = resolve(&frame, scene.graph(), &setup, self.shading, self.background);
        let buffers = buffers.map_err(|e| Error::Resolve(e.into()))?;
        Ok(Picture::new(buffers, counters, operations))
    }

    /// Whether the engine can do what is asked of it.
    fn check_engine(&self) -> Result<(), Error> {
        let reason = match self.engine {
            EngineKind::Rays if self.coverage == Coverage::Alpha => {
                "the rays blend nothing: they draw no alpha coverage"
            }
            EngineKind::Fast | EngineKind::Rays if self.counts_operations => {
                "the machine alone counts operations, not the engine that was given"
            }
            _ => return Ok(()),
        };
        Err(Error::Setting(reason.to_owned()))
    }

    /// Draws on a simulated hardware: its cycles, what they were spent on, and the machine's counters. Always the
    /// machine, whatever [`Renderer::engine`] says.
    ///
    /// # Errors
    /// As [`Renderer::render`], and [`Error::Simulate`] where the hardware's description is not sound or its
    /// stack overflows.
    pub fn simulate(
        &self,
        scene: &Scene,
        camera: &Camera,
        width: u32,
        height: u32,
        hardware: &Hardware,
    ) -> Result<Simulated, Error> {
        let setup = self.set_up(scene, camera, width, height)?;
        let light = lights(scene.graph(), &setup, self.shading);
        let mut frame = Frame::new(setup.width, setup.height, false);
        let (mut machine, view) = (self.machine(), lit(scene, &light));
        machine
            .simulate(&view, &setup, &mut frame, hardware, &mut NoObserver)
            .map_err(|e| Error::Simulate(e.into()))
    }

    fn machine(&self) -> Machine {
        Machine::new(MachineOptions {
            overflow: self.overflow,
            ..MachineOptions::default()
        })
    }

    /// The integers of a frame: what [`Engine`] draws from, for programs that draw frame after frame.
    ///
    /// # Errors
    /// [`Error::Setup`] and [`Error::Setting`], as [`Renderer::render`].
    pub fn set_up(
        &self,
        scene: &Scene,
        camera: &Camera,
        width: u32,
        height: u32,
    ) -> Result<FrameSetup, Error> {
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
        camera.check()?;
        count_samples(width, height, aa_log2).map_err(|e| Error::Setting(e.to_string()))?;
        let defaults = SetupOptions::of(self.coverage);
        let options = SetupOptions {
            bits: self.bits,
            frac: self.frac,
            cage: self.cage,
            tolerance_px: self.tolerance.unwrap_or(defaults.tolerance_px),
            lod_px: self.level_of_detail.unwrap_or(defaults.lod_px),
            aa_log2,
            ..defaults
        };
        let graph = scene.graph();
        let camera = camera.of_size(width, height);
        Ok(FrameSetup::new(
            &camera,
            &graph.placement,
            graph.depth,
            &options,
        )?)
    }
}

/// A scene's shape with the light of its nodes, for rules that blend.
fn lit<'s>(scene: &'s Scene, light: &'s [[u16; 3]]) -> GraphView<'s> {
    GraphView {
        light,
        ..scene.view()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(renderer: &Renderer, camera: &Camera, scene: &Scene) -> String {
        match renderer.render(scene, camera, 8, 8) {
            Err(Error::Setting(reason)) => reason,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn what_an_engine_does_not_have_is_refused() {
        let scene = Scene::generate("menger,depth=1").expect("a scene");
        let camera = Camera::fit(&scene);
        let rays = Renderer::new().engine(EngineKind::Rays);
        let reason = refusal(&rays.clone().coverage(Coverage::Alpha), &camera, &scene);
        assert!(reason.contains("alpha"), "{reason}");
        assert!(rays.render(&scene, &camera, 8, 8).is_ok());
        let counting = Renderer::new().count_operations();
        for engine in [EngineKind::Fast, EngineKind::Rays] {
            let reason = refusal(&counting.clone().engine(engine), &camera, &scene);
            assert!(reason.contains("operations"), "{reason}");
        }
        let counted = counting.engine(EngineKind::Machine);
        assert!(counted.render(&scene, &camera, 8, 8).is_ok());
    }

    #[test]
    fn what_a_camera_does_not_have_is_refused() {
        let scene = Scene::generate("menger,depth=1").expect("a scene");
        let placed = Camera::look_at([9.0, 9.0, 9.0], [1.0, 1.0, 1.0]);
        let fitted = Camera::fit(&scene);
        let renderer = Renderer::new();
        for camera in [
            placed.clone().azimuth(1.0),
            placed.clone().elevation(1.0),
            placed.clone().zoom(1.0),
            placed.clone().for_turning(),
            fitted.clone().up([0.0, 1.0, 0.0]),
            fitted.clone().zoom(0.0),
        ] {
            assert!(!refusal(&renderer, &camera, &scene).is_empty());
        }
        for camera in [
            placed.up([0.0, 1.0, 0.0]),
            fitted.azimuth(1.0).for_turning(),
        ] {
            assert!(renderer.render(&scene, &camera, 8, 8).is_ok());
        }
        let samples = renderer.samples(3);
        assert!(refusal(&samples, &Camera::fit(&scene), &scene).contains("1, 2 or 4"));
        let threads = Renderer::new().threads(MOST_THREADS + 1);
        assert!(refusal(&threads, &Camera::fit(&scene), &scene).contains("0 to 1024"));
    }
}
