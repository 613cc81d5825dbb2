//! The sweep over scenes, viewpoints, formats and rules, in parallel. It is the same in every run.

use rayon::prelude::*;

use super::case::Case;
use super::check::{Oracle, PATIENCE, check};
use super::findings::{Findings, Key};
use super::outcome::Outcome;
use super::scene::StressScene;
use super::subject::{Product, Subject};
use super::viewpoint::viewpoints;
use shiftvox::graph::{Graph, Progress};
use shiftvox::project::{CageKind, Camera, Coverage, SetupOptions};
use shiftvox::split_mix::SplitMix;

#[derive(Debug, Clone, PartialEq)]
pub struct SweepPlan {
    pub scenes: Vec<StressScene>,
    pub bits: Vec<u32>,
    pub pixels: Vec<u32>,
    pub random_viewpoints: u32,
    /// Random rules for each scene, viewpoint and format, at most all of them.
    pub rules: usize,
    pub seed: u64,
    pub most_records: u64,
}

/// Tolerances, samples, of `any` and `center`; `exact` has the first alone.
pub const TOLERANCES: [f64; 6] = [
    0.0,
    1.0 / 256.0,
    1.0 / 64.0,
    1.0 / 16.0,
    1.0 / 8.0,
    f64::INFINITY,
];

const SCENES: [&str; 13] = [
    "gen:sphere,depth=4",
    "gen:shell,depth=5",
    "plane:6,0,0,1",
    "plane:6,0,1,1",
    "plane:6,3,5,7",
    "solid:5",
    "gen:truss,depth=5",
    "gen:wires,depth=5",
    "gen:checker,depth=3",
    "gen:random,depth=4",
    "cyclic:6,1",
    "cyclic:9,5",
    "gen:sierpinski,depth=30",
];
const MORE_SCENES: [&str; 9] = [
    "gen:sphere,depth=7",
    "gen:shell,depth=8",
    "plane:8,1,7,31",
    "plane:8,1,1,1",
    "solid:30",
    "gen:menger,depth=4",
    "gen:terrain,depth=7",
    "gen:maze,depth=6",
    "cyclic:30,9",
];

impl SweepPlan {
    /// The standard sweep, about two minutes of two processors, or hours.
    pub fn new(seed: u64, thorough: bool) -> Self {
        let more: &[&str] = if thorough { &MORE_SCENES } else { &[] };
        let scenes = SCENES.iter().chain(more);
        Self {
            // The tests read them all.
            scenes: scenes.filter_map(|text| text.parse().ok()).collect(),
            bits: if thorough {
                (16..=64).collect()
            } else {
                vec![16, 18, 20, 24, 28, 32, 40, 48, 56, 64]
            },
            pixels: if thorough { vec![48, 160] } else { vec![40] },
            random_viewpoints: if thorough { 16 } else { 2 },
            rules: if thorough { 40 } else { 2 },
            seed,
            most_records: if thorough { PATIENCE } else { 500_000 },
        }
    }

    /// Fractions of a width: chosen by the set-up, few, and half.
    fn fractions(bits: u32) -> [Option<u32>; 3] {
        [None, Some(bits / 4), Some(bits / 2)]
    }
}

/// Levels of detail, samples, at which `exact` must be the oracle's picture.
const EXACT_LODS: [f64; 4] = [0.0, 1.0, 0.3, 3.0];
/// The first rules define the picture at every sample.
const STRICT_RULES: usize = 2 * EXACT_LODS.len();

fn rules() -> Vec<SetupOptions> {
    let mut rules = Vec::new();
    for coverage in Coverage::UNBLENDED {
        let (tolerances, lods) = match coverage.draws_outlines() {
            true => (1, EXACT_LODS.len()),
            false => (TOLERANCES.len(), 2),
        };
        for &tolerance_px in &TOLERANCES[..tolerances] {
            for cage in CageKind::ALL.into_iter().rev() {
                rules.extend(EXACT_LODS[..lods].iter().map(|&lod_px| SetupOptions {
                    cage,
                    tolerance_px,
                    lod_px,
                    ..SetupOptions::of(coverage)
                }));
            }
        }
    }
    rules
}

struct Job<'p> {
    scene: usize,
    graph: &'p Graph,
    camera: Camera,
    shift: i64,
    salt: u64,
}

/// Runs a plan on the machine.
pub fn sweep(plan: &SweepPlan, progress: &dyn Progress) -> Result<Findings, String> {
    sweep_of(&Product, plan, progress)
}

pub(super) fn sweep_of(
    subject: &dyn Subject,
    plan: &SweepPlan,
    progress: &dyn Progress,
) -> Result<Findings, String> {
    let graphs: Vec<Graph> = plan
        .scenes
        .iter()
        .map(|scene| scene.graph().map_err(|e| format!("{scene}: {e}")))
        .collect::<Result<_, _>>()?;
    let mut jobs = Vec::new();
    for (scene, graph) in graphs.iter().enumerate() {
        for &pixels in &plan.pixels {
            let mut numbers = SplitMix::new(plan.seed ^ (scene as u64) << 32);
            let views = viewpoints(graph.depth, pixels, plan.random_viewpoints, &mut numbers);
            for (camera, shift) in views {
                jobs.push(Job {
                    scene,
                    graph,
                    camera,
                    shift,
                    salt: numbers.bits(),
                });
            }
        }
    }
    progress.begin("stress", jobs.len() as u64);
    let found: Vec<Findings> = jobs
        .par_iter()
        .map(|job| {
            let found = run_job(subject, plan, job);
            progress.advance(1);
            found
        })
        .collect();
    progress.end();
    let mut findings = Findings::default();
    for found in found {
        findings.merge(found);
    }
    findings.failed.sort_by_key(|failed| failed.check);
    Ok(findings)
}

fn run_job(subject: &dyn Subject, plan: &SweepPlan, job: &Job<'_>) -> Findings {
    let mut findings = Findings::default();
    let mut numbers = SplitMix::new(job.salt);
    let all = rules();
    let mut oracle = Oracle::default();
    for &bits in &plan.bits {
        for frac in SweepPlan::fractions(bits) {
            // At least one rule is strict.
            let below = |i: usize| if i == 0 { STRICT_RULES } else { all.len() };
            let mut chosen: Vec<usize> = match plan.rules >= all.len() {
                true => (0..all.len()).collect(),
                false => (0..plan.rules)
                    .map(|i| numbers.below(below(i) as u64) as usize)
                    .collect(),
            };
            chosen.sort_unstable();
            chosen.dedup();
            for rule in chosen {
                let options = SetupOptions {
                    bits,
                    frac,
                    ..all[rule]
                };
                let case = Case {
                    scene: plan.scenes[job.scene].clone(),
                    camera: job.camera,
                    shift: job.shift,
                    options,
                };
                let outcome = check(subject, &case, job.graph, plan.most_records, &mut oracle);
                let key = Key {
                    scene: job.scene,
                    bits,
                    coverage: place_of(&Coverage::UNBLENDED, &options.coverage),
                    tolerance: place_of(&TOLERANCES, &options.tolerance_px),
                };
                findings.note(key, &case, &outcome);
            }
        }
    }
    findings
}

fn place_of<T: PartialEq>(all: &[T], one: &T) -> usize {
    all.iter().position(|other| other == one).unwrap_or(0)
}

/// Draws one case.
pub fn run_case(case: &Case, most_records: u64) -> Result<Outcome, String> {
    let graph = case.scene.graph()?;
    let mut oracle = Oracle::default();
    Ok(check(&Product, case, &graph, most_records, &mut oracle))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_standard_scenes_can_be_made() {
        let plan = SweepPlan::new(1, true);
        assert_eq!(plan.scenes.len(), SCENES.len() + MORE_SCENES.len());
        let mut scenes = SweepPlan::new(1, false).scenes.into_iter();
        assert!(scenes.all(|scene| !scene.graph().unwrap().is_empty()));
    }
}
