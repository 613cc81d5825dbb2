//! The image-order paper's results in one go: Table I, the claim that time does not depend on the
//! object, and the claim about occlusion order.
//!
//! What does not depend on the computer (hashes of pictures, records, operations) is one list,
//! [`Evidence`]; times are another. The image-order paper's results and ours: `spec/lab.md`.

pub mod tables;

use hwmodel::Overflow;
use serde::Serialize;

use crate::bench::{
    BenchError, BenchPlan, Candidate, Family, Harness, Schedule, Subject, Timing, ablation, measure,
};
use crate::model::frame::count_operations;
use shiftvox::graph::Progress;
use shiftvox::picture::{self, Background, Shading, resolve};
use shiftvox::project::SetupOptions;

/// What is reproduced, and how.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    /// Sides of Table I's pictures, pixels.
    pub sides: Vec<u32>,
    /// Side of the pictures in which objects are compared, pixels.
    pub object_side: u32,
    /// Scenes that stand for the image-order paper's simple objects; the first is Table I's.
    pub simple: Vec<String>,
    /// Scenes that stand for its complex ones.
    pub complex: Vec<String>,
    /// Scenes of one kind and growing detail.
    pub growing: Vec<String>,
    /// How often each contender draws.
    pub schedule: Schedule,
}

impl Default for Plan {
    fn default() -> Self {
        let text = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        let terrain = |depth| format!("gen:terrain,depth={depth}");
        Self {
            sides: vec![64, 128, 256, 512, 1024],
            object_side: 512,
            simple: text(&["gen:sphere,depth=5", "gen:checker,depth=2"]),
            complex: text(&["bundled", "gen:menger,depth=5", "gen:truss,depth=8"]),
            growing: (6..=10).map(terrain).collect(),
            schedule: Schedule { warmup: 1, runs: 5 },
        }
    }
}

impl Plan {
    /// All scenes, each once, in order.
    #[must_use]
    pub fn scenes(&self) -> Vec<String> {
        let mut all: Vec<String> = Vec::new();
        for name in self.simple.iter().chain(&self.complex).chain(&self.growing) {
            if !all.contains(name) {
                all.push(name.clone());
            }
        }
        all
    }
}

/// Settings by name: the image-order paper's, and ours.
#[must_use]
pub fn settings() -> [(&'static str, SetupOptions); 2] {
    [
        ("paper", SetupOptions::paper()),
        ("default", SetupOptions::default()),
    ]
}

/// What a frame is on every computer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Evidence {
    /// The scene.
    pub scene: String,
    /// The settings' name.
    pub settings: String,
    /// Side of the picture, pixels.
    pub side: u32,
    /// Hash of the picture, shaded, on the standard background.
    pub hash: String,
    /// Pixels that show the object.
    pub covered: u64,
    /// Records that had their turn.
    pub records: u64,
    /// Operations of the machine, shifts and all.
    pub operations: u64,
    /// Finest voxels of the scene.
    pub voxels: u64,
    /// Nodes of the scene.
    pub nodes: u64,
}

/// Why something was not reproduced.
#[derive(Debug, thiserror::Error)]
pub enum ReproduceError {
    /// A measurement failed.
    #[error(transparent)]
    Bench(#[from] BenchError),
    /// A picture could not be made.
    #[error(transparent)]
    Resolve(#[from] picture::ResolveError),
    /// A frame could not be drawn.
    #[error("{scene}: {source}")]
    Engine {
        /// The scene.
        scene: String,
        /// The machine's error.
        source: shiftvox::project::EngineError,
    },
}

/// Draws one frame on the machine and counts.
fn count(
    subject: &Subject,
    side: u32,
    name: &str,
    options: &SetupOptions,
) -> Result<Evidence, ReproduceError> {
    let setup = subject.setup((side, side), options)?;
    let graph = &subject.graph;
    let counted = count_operations(&graph.view(), &setup, Overflow::Trap);
    let (frame, counter, _) = counted.map_err(|source| ReproduceError::Engine {
        scene: subject.name.clone(),
        source,
    })?;
    let picture = resolve(
        &frame,
        graph,
        &setup,
        Shading::Lambert,
        Background::default(),
    )?;
    Ok(Evidence {
        scene: subject.name.clone(),
        settings: name.to_owned(),
        side,
        hash: picture::hash(&picture),
        covered: frame.drawn() as u64,
        records: counter.records(),
        operations: counter.ops(),
        voxels: graph.voxels,
        nodes: graph.len() as u64,
    })
}

/// All that is the same on every machine: Table I's scene at every size, and
/// every scene at the size of the comparison, under both settings.
///
/// # Errors
/// When a frame cannot be set up or drawn.
pub fn evidence(
    plan: &Plan,
    subjects: &[Subject],
    progress: &dyn Progress,
) -> Result<Vec<Evidence>, ReproduceError> {
    let mut wanted: Vec<(&Subject, u32)> = Vec::new();
    if let Some(first) = subjects.first() {
        wanted.extend(plan.sides.iter().map(|&side| (first, side)));
    }
    for subject in subjects {
        let one = (subject, plan.object_side);
        let is_there = |(s, side): &(&Subject, u32)| s.name == one.0.name && *side == one.1;
        if !wanted.iter().any(is_there) {
            wanted.push(one);
        }
    }
    progress.begin("counting", 2 * wanted.len() as u64);
    let mut all = Vec::new();
    for (subject, side) in wanted {
        for (name, options) in settings() {
            all.push(count(subject, side, name, &options)?);
            progress.advance(1);
        }
    }
    progress.end();
    Ok(all)
}

/// Times of one kind of setting.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Timed {
    /// The settings' name.
    pub settings: &'static str,
    /// Times.
    pub timing: Timing,
}

/// Which engines are timed: under the image-order paper's settings the machine alone.
#[derive(Debug, Clone, Copy)]
pub struct Engines<'e> {
    /// The machine.
    pub machine: &'e Candidate,
    /// The fast engine.
    pub fast: &'e Candidate,
    /// The exact ray caster.
    pub reference: &'e Candidate,
    /// The machine with occlusion order off, and with rejection off.
    pub family: &'e Family,
    /// The machine with occlusion order off.
    pub order_alone: &'e Family,
}

/// Times of subjects at sizes.
///
/// # Errors
/// When a frame cannot be set up or drawn.
pub fn times(
    subjects: &[Subject],
    sides: &[u32],
    engines: &Engines<'_>,
    harness: &mut Harness<'_>,
) -> Result<Vec<Timed>, ReproduceError> {
    let sizes: Vec<(u32, u32)> = sides.iter().map(|&side| (side, side)).collect();
    let mut all = Vec::new();
    for (settings, options) in settings() {
        let candidates = match settings {
            "paper" => vec![*engines.machine],
            _ => vec![*engines.machine, *engines.fast],
        };
        let plan = BenchPlan {
            sizes: &sizes,
            threads: &[1],
            options,
            candidates: &candidates,
            reference: None,
        };
        let timings = measure(subjects, &plan, harness)?;
        all.extend(timings.into_iter().map(|timing| Timed { settings, timing }));
    }
    Ok(all)
}

/// The machine with and without occlusion order, and without the rejection
/// that the order allows, on some subjects, under both settings.
///
/// Without rejection the image-order paper's loop takes a solid apart along every bisector
/// down to the level bound, exponentially in its levels: it is impractical to wait for
/// that, so under the image-order paper's settings there is no such row.
///
/// # Errors
/// When a frame cannot be set up or drawn.
pub fn order(
    subjects: &[&Subject],
    side: u32,
    engines: &Engines<'_>,
    harness: &mut Harness<'_>,
) -> Result<Vec<(&'static str, ablation::AblationRow)>, ReproduceError> {
    let mut rows = Vec::new();
    for subject in subjects {
        for (name, options) in settings() {
            let family = match name {
                "paper" => engines.order_alone,
                _ => engines.family,
            };
            let found = ablation::run(
                subject,
                (side, side),
                &options,
                std::slice::from_ref(family),
                engines.reference,
                harness,
            )?;
            rows.extend(found.into_iter().map(|row| (name, row)));
        }
    }
    Ok(rows)
}
