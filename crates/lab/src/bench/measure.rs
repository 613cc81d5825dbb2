//! Scenes, sizes, engines and thread counts become contenders and times.

use serde::{Serialize, Serializer};

use super::candidate::Candidate;
use super::harness::{BenchError, Contender, Drawer, Harness, Measured};
use super::statistics::Summary;
use crate::measure::CoverageError;
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::project::{Camera, FrameSetup, SetupOptions, Stats};

/// A scene and from where it is seen.
#[derive(Debug)]
pub struct Subject {
    /// What tables call it.
    pub name: String,
    /// The scene.
    pub graph: Graph,
    /// The camera; its size in pixels is replaced.
    pub camera: Camera,
}

impl Subject {
    /// The frame of a size.
    ///
    /// # Errors
    /// When it cannot be set up.
    pub fn setup(
        &self,
        size: (u32, u32),
        options: &SetupOptions,
    ) -> Result<FrameSetup, BenchError> {
        let camera = Camera {
            width: size.0,
            height: size.1,
            ..self.camera
        };
        let graph = &self.graph;
        let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, options)?;
        Ok(setup)
    }
}

/// What is measured of some scenes.
#[derive(Debug, Clone, Copy)]
pub struct BenchPlan<'p> {
    /// Sizes of the picture, pixels across and down.
    pub sizes: &'p [(u32, u32)],
    /// Thread counts, each 1 or more. Engines that use one thread are measured once, on one.
    pub threads: &'p [usize],
    /// What frames are drawn with.
    pub options: SetupOptions,
    /// The engines that draw.
    pub candidates: &'p [Candidate],
    /// The engine whose picture is the reference; `None`: coverage is not compared.
    pub reference: Option<&'p Candidate>,
}

/// What one engine took for one frame.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Timing {
    /// The scene.
    pub scene: String,
    /// Its finest voxels.
    pub voxels: u64,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// The engine.
    pub engine: &'static str,
    /// Threads that it had.
    pub threads: usize,
    /// Wall time of a frame.
    pub wall: Summary,
    /// Processor time of a frame, on one thread.
    pub thread: Option<Summary>,
    /// How much the engine had to do.
    pub work: Option<u64>,
    /// What that counts.
    pub work_unit: &'static str,
    /// All that it counted of one frame.
    #[serde(serialize_with = "as_map")]
    pub counters: Stats,
    /// How far its picture is from the reference.
    pub coverage: Option<CoverageError>,
}

impl Timing {
    /// Pixels of the picture.
    #[must_use]
    pub fn pixels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// The size in words: `512x512`.
    #[must_use]
    pub fn size(&self) -> String {
        format!("{}x{}", self.width, self.height)
    }

    /// The median that disturbs least: processor time where there is one, else wall time;
    /// milliseconds.
    #[must_use]
    pub fn best_median_ms(&self) -> f64 {
        self.thread.unwrap_or(self.wall).median_ms
    }
}

pub(super) fn as_map<S: Serializer>(counters: &Stats, to: S) -> Result<S::Ok, S::Error> {
    to.collect_map(counters.iter().copied())
}

/// A counter by its name.
pub(super) fn counter(counters: &Stats, name: &str) -> Option<u64> {
    let found = counters.iter().find(|(found, _)| *found == name);
    found.map(|&(_, count)| count)
}

/// Measures all candidates on all subjects in one race.
///
/// In the order of subjects, sizes, candidates and threads.
///
/// # Errors
/// When a frame cannot be set up or drawn, or there are no threads.
pub fn measure(
    subjects: &[Subject],
    plan: &BenchPlan<'_>,
    harness: &mut Harness<'_>,
) -> Result<Vec<Timing>, BenchError> {
    let mut contenders = Vec::new();
    let mut timings = Vec::new();
    // What each contender's picture should be, as places in the list of references.
    let mut references: Vec<Vec<[i32; 4]>> = Vec::new();
    let mut reference_of = Vec::new();
    for subject in subjects {
        for &size in plan.sizes {
            let setup = subject.setup(size, &plan.options)?;
            if let Some(reference) = plan.reference {
                references.push(picture_of(reference, &subject.graph, &setup)?);
            }
            for candidate in plan.candidates {
                let threads = if candidate.parallel {
                    plan.threads
                } else {
                    &[1]
                };
                for &threads in threads {
                    reference_of.push(references.len().saturating_sub(1));
                    timings.push(blank(subject, size, candidate, threads));
                    contenders.push(Contender {
                        name: format!("{}, {}", subject.name, candidate.name),
                        graph: &subject.graph,
                        setup: setup.clone(),
                        threads,
                        drawer: Drawer::Engine((candidate.make)(threads)),
                        attributes: Vec::new(),
                    });
                }
            }
        }
    }
    let mut coverage = vec![None; contenders.len()];
    let measured = harness.race(&mut contenders, &mut |place, frame| {
        if let Some(right) = references.get(reference_of[place]) {
            coverage[place] = Some(CoverageError::between(&frame.voxel, right));
        }
    })?;
    for ((timing, measured), coverage) in timings.iter_mut().zip(measured).zip(coverage) {
        fill_in(timing, measured, coverage);
    }
    Ok(timings)
}

fn blank(subject: &Subject, size: (u32, u32), candidate: &Candidate, threads: usize) -> Timing {
    Timing {
        scene: subject.name.clone(),
        voxels: subject.graph.voxels,
        width: size.0,
        height: size.1,
        engine: candidate.name,
        threads,
        wall: Summary::default(),
        thread: None,
        work: None,
        work_unit: candidate.work,
        counters: Stats::new(),
        coverage: None,
    }
}

fn fill_in(timing: &mut Timing, measured: Measured, coverage: Option<CoverageError>) {
    timing.wall = measured.wall;
    timing.thread = measured.thread;
    timing.work = counter(&measured.counters, timing.work_unit);
    timing.counters = measured.counters;
    timing.coverage = coverage;
}

/// The voxels that a candidate sees, at the set-up's level of detail, drawn on
/// all threads: what pictures are held against.
///
/// # Errors
/// When it does not finish.
pub(super) fn picture_of(
    candidate: &Candidate,
    graph: &Graph,
    setup: &FrameSetup,
) -> Result<Vec<[i32; 4]>, BenchError> {
    let mut frame = Frame::new(setup.width, setup.height, false);
    let mut engine = (candidate.make)(rayon::current_num_threads());
    let drawn = engine.render(&graph.view(), setup, &mut frame);
    drawn.map_err(|source| BenchError::Engine {
        who: candidate.name.to_owned(),
        source,
    })?;
    Ok(frame.voxel)
}
