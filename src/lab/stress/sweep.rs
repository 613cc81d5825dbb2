//! The sweep: scenes x viewpoints x formats x rules, in parallel, the same in every run.

use std::collections::BTreeMap;

use rayon::prelude::*;
use serde::Serialize;

use super::case::Case;
use super::check::{Oracle, PATIENCE, check};
use super::outcome::{Check, End, Outcome};
use super::scene::StressScene;
use super::shrink::Shrinker;
use super::subject::{Product, Subject};
use super::vertex::Worst;
use super::viewpoint::{Viewpoint, viewpoints};
use crate::graph::{Graph, Progress};
use crate::project::{CageKind, Coverage, SetupOptions};
use crate::split_mix::SplitMix;

/// What is swept.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepPlan {
    /// Scenes.
    pub scenes: Vec<StressScene>,
    /// Word widths, bits.
    pub bits: Vec<u32>,
    /// Pictures' sides, pixels.
    pub pixels: Vec<u32>,
    /// Viewpoints of each scene that the seed chooses, beyond the standard ones.
    pub random_viewpoints: u32,
    /// Rules drawn for each scene, viewpoint and format; all of them where there are fewer.
    pub rules: usize,
    /// What chooses viewpoints and rules.
    pub seed: u64,
    /// Most records of a frame.
    pub most_records: u64,
    /// Cases drawn to shrink a failure.
    pub shrink_budget: u32,
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

/// Scenes of the standard sweep.
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
/// More of them.
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
    #[must_use]
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
            shrink_budget: if thorough { 20_000 } else { 1500 },
        }
    }

    /// Fractions of a width: chosen by the set-up, few, and half.
    fn fractions(bits: u32) -> [Option<u32>; 3] {
        [None, Some(bits / 4), Some(bits / 2)]
    }
}

/// Levels of detail, samples: `exact` must be the oracle's picture at all of
/// them, and has as many rules here as it has in them.
const EXACT_LODS: [f64; 4] = [0.0, 1.0, 0.3, 3.0];
/// Rules under which the picture is defined at every sample: the first ones.
const STRICT_RULES: usize = 2 * EXACT_LODS.len();

/// All rules, those that promise most first.
fn rules() -> Vec<SetupOptions> {
    let mut rules = Vec::new();
    for cage in [CageKind::Frame, CageKind::Corners] {
        rules.extend(EXACT_LODS.map(|lod_px| SetupOptions {
            cage,
            lod_px,
            ..SetupOptions::of(Coverage::Exact)
        }));
    }
    for coverage in [Coverage::Center, Coverage::Any] {
        for tolerance_px in TOLERANCES {
            for cage in [CageKind::Frame, CageKind::Corners] {
                for lod_px in [0.0, 1.0] {
                    rules.push(SetupOptions {
                        cage,
                        tolerance_px,
                        lod_px,
                        ..SetupOptions::of(coverage)
                    });
                }
            }
        }
    }
    rules
}

/// What outcomes are added up by.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Key {
    /// Place of the scene in the plan.
    pub scene: usize,
    /// Word width.
    pub bits: u32,
    /// Rule: 0 `exact`, 1 `center`, 2 `any`.
    pub coverage: usize,
    /// Place of the tolerance in [`TOLERANCES`].
    pub tolerance: usize,
}

/// Rules by [`Key::coverage`].
pub const COVERAGES: [Coverage; 3] = [Coverage::Exact, Coverage::Center, Coverage::Any];

/// Outcomes added up.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Tally {
    /// Cases.
    pub cases: u64,
    /// Those with a picture.
    pub drawn: u64,
    /// Those that an overflow ended, with its place.
    pub trapped: u64,
    /// Those that the set-up refused.
    pub refused: u64,
    /// Those given up after the most records: [`End::CutOff`].
    pub cut_off: u64,
    /// Those that did not keep what they must.
    pub failed: u64,
    /// Most records of a frame.
    pub most_records: u64,
    /// Samples inside closed surfaces.
    pub inside: u64,
    /// Holes among them.
    pub holes: u64,
    /// Samples that show what is hidden.
    pub order: u64,
    /// Samples that the oracle covers.
    pub covered: u64,
    /// Samples covered that should not be.
    pub extra: u64,
    /// Samples not covered that should be.
    pub missing: u64,
}

impl Tally {
    fn note(&mut self, outcome: &Outcome) {
        self.cases += 1;
        match outcome.end {
            End::Drawn => self.drawn += 1,
            End::Trapped(_) => self.trapped += 1,
            End::Refused(_) => self.refused += 1,
            End::CutOff => self.cut_off += 1,
        }
        self.failed += u64::from(!outcome.failures.is_empty());
        self.most_records = self.most_records.max(outcome.records);
        self.inside += outcome.inside;
        self.holes += outcome.holes;
        self.order += outcome.order;
        self.covered += outcome.coverage.covered;
        self.extra += outcome.coverage.extra;
        self.missing += outcome.coverage.missing;
    }

    /// Both together.
    pub fn merge(&mut self, other: &Self) {
        self.cases += other.cases;
        self.drawn += other.drawn;
        self.trapped += other.trapped;
        self.refused += other.refused;
        self.cut_off += other.cut_off;
        self.failed += other.failed;
        self.most_records = self.most_records.max(other.most_records);
        self.inside += other.inside;
        self.holes += other.holes;
        self.order += other.order;
        self.covered += other.covered;
        self.extra += other.extra;
        self.missing += other.missing;
    }
}

/// A case that did not keep what it must.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Failed {
    /// What it did not keep.
    pub check: Check,
    /// Where and how.
    pub detail: String,
    /// The case, for `--case`.
    pub case: String,
    /// A smaller one that fails too, where it was searched for.
    pub minimal: Option<String>,
    /// The smaller one's details.
    pub minimal_detail: Option<String>,
    /// A command that draws its picture, where `render` can.
    pub render: Option<String>,
}

/// What a sweep found.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Findings {
    /// Outcomes by scene, width and rule.
    pub tallies: BTreeMap<Key, Tally>,
    /// Worst vertices by [`super::Hold`] and word width.
    pub worst: BTreeMap<(usize, u32), Worst>,
    /// Outcomes by viewpoint.
    pub viewpoints: BTreeMap<&'static str, Tally>,
    /// Traps by place, records left out.
    pub traps: BTreeMap<String, u64>,
    /// Refusals by reason.
    pub refusals: BTreeMap<String, u64>,
    /// Failures by check.
    pub failures: BTreeMap<Check, u64>,
    /// Some of the failures, those that were shrunk first.
    pub failed: Vec<Failed>,
}

/// Failures that are reported in full, of each check in each job.
const TOLD: usize = 3;

impl Findings {
    /// All together.
    #[must_use]
    pub fn total(&self) -> Tally {
        let mut total = Tally::default();
        for tally in self.tallies.values() {
            total.merge(tally);
        }
        total
    }

    fn note(&mut self, key: Key, viewpoint: &'static str, case: &Case, outcome: &Outcome) {
        for (hold, worst) in outcome.worst.iter().enumerate() {
            if worst.vertices > 0 {
                self.worst.entry((hold, key.bits)).or_default().merge(worst);
            }
        }
        self.tallies.entry(key).or_default().note(outcome);
        self.viewpoints.entry(viewpoint).or_default().note(outcome);
        match &outcome.end {
            End::Drawn | End::CutOff => {}
            End::Trapped(trap) => {
                // Without the record, which is another in every case.
                let place = trap.split(", record").next().unwrap_or(trap);
                let place = place.split_once("overflowed in ").map_or(place, |p| p.1);
                let place = place.split(", octree").next().unwrap_or(place);
                let place = place.replace(" (stage", ", stage");
                *self.traps.entry(place).or_default() += 1;
            }
            End::Refused(reason) => *self.refusals.entry(reason.clone()).or_default() += 1,
        }
        for failure in &outcome.failures {
            let count = self.failures.entry(failure.check).or_default();
            *count += 1;
            if *count as usize <= TOLD {
                self.failed.push(Failed {
                    check: failure.check,
                    detail: failure.detail.clone(),
                    case: case.to_string(),
                    minimal: None,
                    minimal_detail: None,
                    render: None,
                });
            }
        }
    }

    fn merge(&mut self, other: Self) {
        for (key, worst) in other.worst {
            self.worst.entry(key).or_default().merge(&worst);
        }
        for (key, tally) in other.tallies {
            self.tallies.entry(key).or_default().merge(&tally);
        }
        for (name, tally) in other.viewpoints {
            self.viewpoints.entry(name).or_default().merge(&tally);
        }
        for (to, from) in [
            (&mut self.traps, other.traps),
            (&mut self.refusals, other.refusals),
        ] {
            for (place, count) in from {
                *to.entry(place).or_default() += count;
            }
        }
        for (check, count) in other.failures {
            *self.failures.entry(check).or_default() += count;
        }
        self.failed.extend(other.failed);
    }
}

/// A scene seen from a viewpoint.
struct Job<'p> {
    scene: usize,
    graph: &'p Graph,
    viewpoint: Viewpoint,
    salt: u64,
}

/// Runs a plan on the machine.
///
/// # Errors
/// In words, where a scene of the plan cannot be made.
pub fn sweep(plan: &SweepPlan, progress: &dyn Progress) -> Result<Findings, String> {
    sweep_of(&Product, plan, progress)
}

/// Runs a plan on any subject.
pub(crate) fn sweep_of(
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
            for viewpoint in views {
                jobs.push(Job {
                    scene,
                    graph,
                    viewpoint,
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
    shrink_failures(subject, plan, &mut findings, progress);
    Ok(findings)
}

fn run_job(subject: &dyn Subject, plan: &SweepPlan, job: &Job<'_>) -> Findings {
    let mut findings = Findings::default();
    let mut numbers = SplitMix::new(job.salt);
    let all = rules();
    let strict = STRICT_RULES;
    let mut oracle = Oracle::default();
    oracle.forget();
    for &bits in &plan.bits {
        for frac in SweepPlan::fractions(bits) {
            let mut chosen: Vec<usize> = if plan.rules >= all.len() {
                (0..all.len()).collect()
            } else {
                (0..plan.rules)
                    .map(|i| numbers.below(if i == 0 { strict } else { all.len() } as u64) as usize)
                    .collect()
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
                    camera: job.viewpoint.camera,
                    shift: job.viewpoint.shift,
                    options,
                };
                let outcome = check(subject, &case, job.graph, plan.most_records, &mut oracle);
                let key = Key {
                    scene: job.scene,
                    bits,
                    coverage: place_of(&COVERAGES, &options.coverage),
                    tolerance: place_of(&TOLERANCES, &options.tolerance_px),
                };
                findings.note(key, job.viewpoint.name, &case, &outcome);
            }
        }
    }
    findings
}

fn place_of<T: PartialEq>(all: &[T], one: &T) -> usize {
    all.iter().position(|other| other == one).unwrap_or(0)
}

/// Shrinks the first failure of each check.
fn shrink_failures(
    subject: &dyn Subject,
    plan: &SweepPlan,
    findings: &mut Findings,
    progress: &dyn Progress,
) {
    let checks: Vec<Check> = findings.failures.keys().copied().collect();
    for kind in checks {
        progress.begin("shrinking a failing case", 0);
        let first = findings.failed.iter_mut().find(|f| f.check == kind);
        if let Some(failed) = first
            && let Ok(case) = failed.case.parse::<Case>()
        {
            let mut shrinker = Shrinker::new(subject, kind, plan.most_records, plan.shrink_budget);
            let minimal = shrinker.shrink(&case);
            if let Ok(graph) = minimal.scene.graph() {
                let mut oracle = Oracle::default();
                let again = check(subject, &minimal, &graph, plan.most_records, &mut oracle);
                let failure = again.failures.into_iter().find(|f| f.check == kind);
                failed.minimal_detail = failure.map(|f| f.detail);
                failed.render = minimal.render_line(&graph);
            }
            failed.minimal = Some(minimal.to_string());
        }
        progress.end();
    }
    findings
        .failed
        .sort_by_key(|f| (f.minimal.is_none(), f.check));
}

/// Draws one case.
///
/// # Errors
/// In words, where its scene cannot be made.
pub fn run_case(case: &Case, most_records: u64) -> Result<Outcome, String> {
    let graph = case.scene.graph()?;
    Ok(check(
        &Product,
        case,
        &graph,
        most_records,
        &mut Oracle::default(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_standard_scenes_can_be_read_and_made() {
        let plan = SweepPlan::new(1, true);
        assert_eq!(plan.scenes.len(), SCENES.len() + MORE_SCENES.len());
        for scene in &SweepPlan::new(1, false).scenes {
            assert!(!scene.graph().unwrap().is_empty(), "{scene}");
        }
    }
}
