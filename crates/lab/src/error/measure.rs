//! Methods on a scene: what is wrong with their pictures, and what they took.

use std::hint::black_box;
use std::sync::Arc;

use rayon::ThreadPoolBuilder;
use serde::{Serialize, Serializer};

use super::method::{Examined, Method, Refused, VertexLevel, over_levels};
use super::picture_error::{Judge, PictureError};
use super::reference::{Reference, Sampling, TRIANGLE_SAMPLES, cast, of_triangles};
use super::voxels::PixelStyle;
use crate::bench::{BenchError, Clock, Schedule, Subject, Summary};
use crate::measure::{CoverageError, Spread, count_elsewhere};
use shiftvox::frame::Frame;
use shiftvox::graph::Progress;
use shiftvox::picture::{Background, Picture, resolve};
use shiftvox::project::{Camera, Engine, FrameSetup, SetupOptions, Stats};
use shiftvox::rays::Rays;
use shiftvox_mesh::Surface;

/// What is measured, and how.
#[derive(Debug, Clone, Copy)]
pub struct ErrorPlan {
    /// Pixels across and down.
    pub size: (u32, u32),
    /// How often each method draws.
    pub schedule: Schedule,
    /// Strata of a reference's pixel along each axis, as a power of two.
    pub strata_log2: u32,
    /// How samples become colours.
    pub style: PixelStyle,
}

/// Seeds of the reference and of the second one, whose distance is the noise floor.
const SEEDS: [u64; 2] = [1, 2];

/// Most methods that draw in turn, and so have their buffers in memory at one time.
const MOST_IN_TURN: usize = 64;

/// What one method's picture of a scene came to.
#[derive(Debug, Clone, Serialize)]
pub struct Outcome {
    /// What samples see against exact rays through the same points, if the method has samples of
    /// voxels.
    pub samples: Option<SampleError>,
    /// Depths at pixels, against exact rays, finest voxels.
    pub depth_voxels: Option<Spread>,
    /// Distances of vertices from their exact projections, pixels.
    pub vertex_px: Option<Spread>,
    /// The same by octree level.
    pub vertex_levels: Vec<VertexLevel>,
    /// Against the reference.
    pub picture: PictureError,
    /// Wall time of a frame, one thread.
    pub wall: Summary,
    /// Processor time of a frame.
    pub thread: Option<Summary>,
    /// What it counted; the first is its work.
    #[serde(serialize_with = "as_map")]
    pub counters: Stats,
    /// Anything else.
    pub remark: Option<String>,
}

/// What samples see against exact rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct SampleError {
    /// By kind; `wrong_voxel` has coarser voxels in it too.
    #[serde(flatten)]
    pub coverage: CoverageError,
    /// Samples that show a voxel which neither is nor holds the right one.
    pub elsewhere: u64,
}

impl SampleError {
    /// Extra and missing, as a part of what is covered.
    #[must_use]
    pub fn wrong_share(&self) -> f64 {
        let wrong = self.coverage.extra + self.coverage.missing;
        wrong as f64 / self.coverage.covered.max(1) as f64
    }
}

/// A method on a scene.
#[derive(Debug, Clone, Serialize)]
pub struct MethodErrors {
    /// What the method is called.
    pub method: String,
    /// Its family.
    pub family: &'static str,
    /// Its settings.
    #[serde(serialize_with = "as_map")]
    pub settings: Vec<(&'static str, String)>,
    /// The word that plots colour it by.
    pub kind: String,
    /// What came of it, or why nothing did.
    #[serde(serialize_with = "outcome_or_reason")]
    pub outcome: Result<Outcome, Refused>,
}

/// All methods on a scene.
#[derive(Debug, Clone, Serialize)]
pub struct SceneErrors {
    /// The scene.
    pub scene: String,
    /// Its finest voxels.
    pub voxels: u64,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Samples of a pixel of the reference.
    pub reference_samples: u32,
    /// What a second reference of another seed is from the first.
    pub noise_floor: PictureError,
    /// The methods.
    pub rows: Vec<MethodErrors>,
    /// The reference.
    #[serde(skip)]
    pub reference: Arc<Reference>,
    /// The methods' pictures, in the order of rows; empty for those without.
    #[serde(skip)]
    pub pictures: Vec<Vec<[u8; 4]>>,
}

/// Names and values as an object.
pub(crate) fn as_map<S: Serializer, V: Serialize>(
    entries: &[(&'static str, V)],
    to: S,
) -> Result<S::Ok, S::Error> {
    to.collect_map(entries.iter().map(|(name, value)| (name, value)))
}

/// What came of a method, or why nothing did.
pub(crate) fn outcome_or_reason<S: Serializer, O: Serialize>(
    outcome: &Result<O, Refused>,
    to: S,
) -> Result<S::Ok, S::Error> {
    match outcome {
        Ok(outcome) => outcome.serialize(to),
        Err(Refused(reason)) => to.collect_map([("refused", reason)]),
    }
}

/// References, each cast once for a scene, a camera and a sampling.
#[derive(Default)]
pub struct References<'m> {
    cast: Vec<(String, Camera, Sampling, Arc<Reference>)>,
    /// What is true of a scene that is a mesh: its triangles, not its voxels.
    mesh: Option<&'m dyn Surface>,
}

impl<'m> References<'m> {
    /// References that are triangles at 256 samples a pixel, whatever a sampling
    /// says but for its seed.
    #[must_use]
    pub fn of_triangles(mesh: &'m dyn Surface) -> Self {
        Self {
            cast: Vec::new(),
            mesh: Some(mesh),
        }
    }

    /// Samples of a pixel.
    #[must_use]
    pub fn samples(&self, sampling: Sampling) -> u32 {
        match self.mesh {
            Some(_) => TRIANGLE_SAMPLES,
            None => 1 << (2 * sampling.strata_log2),
        }
    }

    /// The reference of a subject from a camera, from memory if it was cast before.
    ///
    /// # Errors
    /// When the camera cannot see.
    pub fn of(
        &mut self,
        subject: &Subject,
        camera: &Camera,
        sampling: Sampling,
        style: PixelStyle,
        progress: &dyn Progress,
    ) -> Result<Arc<Reference>, BenchError> {
        let same = |(scene, from, with, _): &&(String, Camera, Sampling, Arc<Reference>)| {
            (scene, from, with) == (&subject.name, camera, &sampling)
        };
        if let Some((.., known)) = self.cast.iter().find(same) {
            return Ok(Arc::clone(known));
        }
        let reference = match self.mesh {
            Some(mesh) => of_triangles(mesh, camera, style, sampling.seed, progress)?,
            None => cast(
                &subject.graph,
                &truth(subject, camera, 0)?,
                style.shading,
                Background::Color(style.background),
                sampling,
                progress,
            ),
        };
        let reference = Arc::new(reference);
        let entry = (
            subject.name.clone(),
            *camera,
            sampling,
            Arc::clone(&reference),
        );
        self.cast.push(entry);
        Ok(reference)
    }
}

/// The integers that exact rays start from: the default format's, whatever a
/// method has, so that a narrow format's view counts as its error.
fn truth(subject: &Subject, camera: &Camera, aa_log2: u32) -> Result<FrameSetup, BenchError> {
    let options = SetupOptions {
        aa_log2,
        lod_px: 0.0,
        ..SetupOptions::default()
    };
    let graph = &subject.graph;
    Ok(FrameSetup::new(
        camera,
        &graph.placement,
        graph.depth,
        &options,
    )?)
}

/// What exact rays see at the sample points of a picture.
struct Exact {
    aa_log2: u32,
    voxel: Vec<[i32; 4]>,
    picture: Picture,
}

impl Exact {
    fn new(
        subject: &Subject,
        camera: &Camera,
        aa_log2: u32,
        style: PixelStyle,
    ) -> Result<Self, BenchError> {
        let setup = truth(subject, camera, aa_log2)?;
        let mut frame = Frame::new(setup.width, setup.height, false);
        let failed = |reason: String| BenchError::Picture(reason);
        Rays.render(&subject.graph.view(), &setup, &mut frame)
            .map_err(|e| failed(e.to_string()))?;
        let background = Background::Color(style.background);
        let picture = resolve(&frame, &subject.graph, &setup, style.shading, background)
            .map_err(|e| failed(e.to_string()))?;
        Ok(Self {
            aa_log2,
            voxel: frame.voxel,
            picture,
        })
    }
}

/// Measures methods on a scene, from its camera.
///
/// Every method shows a picture, which is judged; then all that did draw in
/// turn, on one thread, and are timed.
///
/// # Errors
/// When the camera cannot see, or there is no thread. A method without a
/// picture is no error but a row with the reason.
pub fn measure(
    subject: &Subject,
    methods: &[Method<'_>],
    plan: &ErrorPlan,
    references: &mut References<'_>,
    progress: &dyn Progress,
) -> Result<SceneErrors, BenchError> {
    let camera = Camera {
        width: plan.size.0,
        height: plan.size.1,
        ..subject.camera
    };
    let sampling = |seed| Sampling {
        strata_log2: plan.strata_log2,
        seed,
    };
    let mut reference =
        |seed| references.of(subject, &camera, sampling(seed), plan.style, progress);
    let (reference, second) = (reference(SEEDS[0])?, reference(SEEDS[1])?);
    let judge = Judge::new(&reference);
    let mismatch = |e: crate::measure::SizeError| BenchError::Picture(e.to_string());
    let noise_floor = judge
        .judge(&second.rgba, &second.shares)
        .map_err(mismatch)?;

    let mut exact: Vec<Exact> = Vec::new();
    let mut shown: Vec<Result<Shown, Refused>> = Vec::new();
    progress.begin("judging pictures", methods.len() as u64);
    for method in methods {
        let drawn = method.show(&camera);
        let aa = |examined: &Examined| {
            examined
                .samples
                .as_ref()
                .map_or(0, |samples| samples.aa_log2)
        };
        if let Ok((_, examined)) = &drawn
            && !exact.iter().any(|exact| exact.aa_log2 == aa(examined))
        {
            exact.push(Exact::new(subject, &camera, aa(examined), plan.style)?);
        }
        shown.push(match drawn {
            Ok((rgba, examined)) => {
                let exact = exact.iter().find(|exact| exact.aa_log2 == aa(&examined));
                let judged = judged(&rgba, &examined, exact, &judge, subject).map_err(mismatch)?;
                Ok((rgba, examined, judged))
            }
            Err(refused) => Err(refused),
        });
        progress.advance(1);
    }
    progress.end();

    let taking_part: Vec<bool> = shown.iter().map(Result::is_ok).collect();
    let mut times = Vec::new();
    for (heat, taking_part) in methods
        .chunks(MOST_IN_TURN)
        .zip(taking_part.chunks(MOST_IN_TURN))
    {
        times.extend(race(heat, taking_part, &camera, plan.schedule, progress)?);
    }
    let mut rows = Vec::new();
    let mut pictures = Vec::new();
    for ((method, shown), (wall, thread)) in methods.iter().zip(shown).zip(times) {
        let outcome = shown.map(|(rgba, examined, judged)| {
            pictures.push(rgba);
            Outcome {
                samples: judged.samples,
                depth_voxels: judged.depth_voxels,
                vertex_px: over_levels(&examined.vertices),
                vertex_levels: examined.vertices,
                picture: judged.picture,
                wall,
                thread,
                counters: examined.counters,
                remark: examined.remark,
            }
        });
        if outcome.is_err() {
            pictures.push(Vec::new());
        }
        rows.push(MethodErrors {
            method: method.name.clone(),
            family: method.family,
            settings: method.settings.clone(),
            kind: method.kind.clone(),
            outcome,
        });
    }
    Ok(SceneErrors {
        scene: subject.name.clone(),
        voxels: subject.graph.voxels,
        width: camera.width,
        height: camera.height,
        reference_samples: references.samples(sampling(SEEDS[0])),
        noise_floor,
        rows,
        reference,
        pictures,
    })
}

/// A method's colours, and what is known of them.
type Shown = (Vec<[u8; 4]>, Examined, Judged);

struct Judged {
    samples: Option<SampleError>,
    depth_voxels: Option<Spread>,
    picture: PictureError,
}

fn judged(
    rgba: &[[u8; 4]],
    examined: &Examined,
    exact: Option<&Exact>,
    judge: &Judge<'_>,
    subject: &Subject,
) -> Result<Judged, crate::measure::SizeError> {
    let graph = &subject.graph;
    // Triangles and far voxels have none: they are elsewhere than the voxels of the graph.
    let samples = examined.samples.as_ref().zip(exact);
    let voxel = graph.placement.voxel_size;
    Ok(Judged {
        samples: samples.map(|(samples, exact)| SampleError {
            coverage: CoverageError::between(&samples.voxel, &exact.voxel),
            elsewhere: count_elsewhere(&samples.voxel, &exact.voxel, graph.depth),
        }),
        depth_voxels: samples
            .map(|(samples, exact)| Spread::of_depths(&samples.depth, &exact.picture.depth, voxel)),
        picture: judge.judge(rgba, &examined.shares)?,
    })
}

/// Times of frames drawn in turn, on one thread: wall, and processor time.
pub(crate) type Times = Vec<(Summary, Option<Summary>)>;

/// Lets methods draw in turn from a camera, those that take part.
pub(crate) fn race(
    methods: &[Method<'_>],
    taking_part: &[bool],
    camera: &Camera,
    schedule: Schedule,
    progress: &dyn Progress,
) -> Result<Times, BenchError> {
    let pool = ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.map_err(|e| BenchError::Threads {
        threads: 1,
        reason: e.to_string(),
    })?;
    let rounds = schedule.warmup + schedule.runs.max(1);
    let takes_part = methods.iter().zip(taking_part);
    let drawings: Vec<_> = takes_part
        .map(|(method, &takes_part)| takes_part.then(|| (method.drawing)()))
        .collect();
    let mut frames: Vec<_> = drawings
        .iter()
        .map(|drawing| drawing.as_ref()?.frames(camera).ok())
        .collect();
    let mut wall: Vec<Vec<f64>> = vec![Vec::new(); methods.len()];
    let mut thread: Vec<Vec<Option<f64>>> = vec![Vec::new(); methods.len()];
    progress.begin("measuring", u64::from(rounds));
    for round in 0..rounds {
        for (place, draw) in frames.iter_mut().enumerate() {
            let Some(draw) = draw else { continue };
            let elapsed = pool.install(|| {
                let clock = Clock::start();
                // It drew this frame before, so it does not fail now; if it did, there were no
                // time.
                let drawn = black_box(draw());
                let elapsed = clock.elapsed();
                drawn.map(|()| elapsed)
            });
            let Ok(elapsed) = elapsed else { continue };
            if round >= schedule.warmup {
                wall[place].push(elapsed.wall_ms);
                thread[place].push(elapsed.thread_ms);
            }
        }
        progress.advance(1);
    }
    progress.end();
    let of = |(wall, thread): (Vec<f64>, Vec<Option<f64>>)| {
        let thread: Option<Vec<f64>> = thread.into_iter().collect();
        (Summary::of(&wall), thread.map(|times| Summary::of(&times)))
    };
    Ok(wall.into_iter().zip(thread).map(of).collect())
}
