//! Draws a case and compares it with the oracle, the specification and the bounds.

use super::case::Case;
use super::outcome::{Check, End, Outcome};
use super::subject::Subject;
use super::vertex::{self, Vertices};
use crate::bounds::{Bounds, Widths};
use crate::measure::CoverageError;
use shiftvox::fast::{Fast, FastOptions};
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::Machine;
use shiftvox::project::{Coverage, Engine, EngineError, FrameSetup, SetupError, stat};
use shiftvox::rays::Rays;

/// Largest tolerance, samples, at which a hole is a failure.
pub(super) const STRICT_TOLERANCE: f64 = 1.0 / 64.0;
/// Every rule must have ended after so many records.
pub const PATIENCE: u64 = 200_000_000;
const VOXELS_LOOKED_AT: usize = 6;
/// Levels below finest voxels to which vertices are followed.
const LEVELS_BELOW: u32 = 3;

#[derive(Default)]
pub(super) struct Oracle {
    last: Option<(FrameSetup, Frame)>,
}

fn cast(graph: &Graph, setup: &FrameSetup) -> Frame {
    let mut frame = Frame::new(setup.width, setup.height, false);
    // The oracle has no error to give.
    let _ = Rays::default().render(&graph.view(), setup, &mut frame);
    frame
}

impl Oracle {
    fn picture(&mut self, graph: &Graph, setup: &FrameSetup) -> Frame {
        let view = |of: &FrameSetup| (of.origin_clip, of.edge_clip, of.sub_levels);
        let size = |of: &FrameSetup| (of.width, of.height, of.levels);
        if let Some((last, frame)) = &self.last
            && (view(last), size(last)) == (view(setup), size(setup))
        {
            return frame.clone();
        }
        let frame = cast(graph, &setup.without_detail());
        self.last = Some((setup.clone(), frame.clone()));
        frame
    }
}

pub(super) fn check(
    subject: &dyn Subject,
    case: &Case,
    graph: &Graph,
    most_records: u64,
    oracle: &mut Oracle,
) -> Outcome {
    let setup = match case.setup(graph) {
        Ok(setup) => setup,
        Err(error) => {
            let kind = match error {
                SetupError::Collapsed { .. } => "the view collapses",
                SetupError::OutOfRange => "out of 64-bit range",
                SetupError::Depth(_) => "too deep",
                _ => "not a view",
            };
            return Outcome::new(End::Refused(kind.to_owned()), 0);
        }
    };
    let mut frame = Frame::new(setup.width, setup.height, false);
    let drawn = subject.draw(&graph.view(), &setup, &mut frame, most_records);
    let stats = match drawn {
        Ok(Some(stats)) => stats,
        Ok(None) => {
            let mut outcome = Outcome::new(End::CutOff, most_records);
            if case.options.coverage == Coverage::Exact || most_records >= PATIENCE {
                let left = format!("records are left after {most_records}");
                outcome.fail(Check::Ends, left);
            }
            return outcome;
        }
        Err(
            refused @ (EngineError::Memory(_) | EngineError::Records(_) | EngineError::Stopped),
        ) => {
            return Outcome::new(End::Refused(refused.to_string()), 0);
        }
        Err(EngineError::Trap(trap)) => {
            let mut outcome = Outcome::new(End::Trapped(trap.to_string()), 0);
            if setup.has_headroom {
                outcome.fail(Check::Headroom, trap.to_string());
            }
            return outcome;
        }
    };
    let mut outcome = Outcome::new(End::Drawn, stat(&stats, "records"));
    let right = oracle.picture(graph, &setup);
    outcome.coverage = CoverageError::between(&frame.voxel, &right.voxel);
    let seen = CheckedFrame {
        setup: &setup,
        frame: &frame,
        right: &right,
        is_at_bound: stat(&stats, "at_level_bound") > 0,
    };
    if seen.is_exact() {
        let defined = setup.lod_limit.is_some().then(|| cast(graph, &setup));
        seen.check_exact(defined.as_ref().unwrap_or(&right), &mut outcome);
    }
    seen.check_place(&mut outcome);
    seen.check_order(&mut outcome);
    if case.scene.is_closed() {
        seen.check_holes(&mut outcome);
    }
    check_vertices(subject, case, graph, &seen, &mut outcome);
    check_engines(graph, &seen, &mut outcome);
    outcome
}

struct CheckedFrame<'s> {
    setup: &'s FrameSetup,
    frame: &'s Frame,
    right: &'s Frame,
    /// Whether records met the level bound: words too narrow for the view.
    is_at_bound: bool,
}

type Voxel = [i32; 4];

impl CheckedFrame<'_> {
    fn is_exact(&self) -> bool {
        self.setup.options.coverage == Coverage::Exact
    }

    fn tolerance(&self) -> f64 {
        self.setup.options.tolerance_px
    }

    fn at(&self, sample: usize) -> (usize, usize) {
        let width = self.frame.width as usize;
        (sample % width, sample / width)
    }

    /// The oracle's voxels at a sample and the eight about it, if all are covered.
    fn around(&self, sample: usize) -> Option<[Voxel; 9]> {
        let (width, height) = (self.frame.width as usize, self.frame.height as usize);
        let (x, y) = self.at(sample);
        if x == 0 || y == 0 || x + 1 == width || y + 1 == height {
            return None;
        }
        let all: [Voxel; 9] =
            std::array::from_fn(|i| self.right.voxel[(y + i / 3 - 1) * width + x + i % 3 - 1]);
        let near = |v: &Voxel| {
            // Only `exact` draws what is nearer than the near plane.
            self.is_exact() || self.depths(v).0 >= i128::from(self.setup.near)
        };
        all.iter().all(|v| v[3] >= 0 && near(v)).then_some(all)
    }

    fn corners(&self, voxel: &Voxel) -> ([i64; 3], [i64; 3]) {
        let side = 1i64 << (self.setup.depth - (voxel[3] as u32).min(self.setup.depth));
        let low = [0, 1, 2].map(|k| i64::from(voxel[k]));
        (low, low.map(|c| c + side))
    }

    fn vertices(&self, voxel: &Voxel) -> [[i128; 3]; 8] {
        let (low, high) = self.corners(voxel);
        std::array::from_fn(|v| {
            std::array::from_fn(|c| {
                (0..3).fold(i128::from(self.setup.origin_clip[c]), |sum, k| {
                    let u = if v >> (2 - k) & 1 != 0 {
                        high[k]
                    } else {
                        low[k]
                    };
                    sum + i128::from(u) * i128::from(self.setup.edge_clip[k][c])
                })
            })
        })
    }

    fn depths(&self, voxel: &Voxel) -> (i128, i128) {
        let w = self.vertices(voxel).map(|p| p[2]);
        let least = w.iter().copied().min().unwrap_or(0);
        (least, w.iter().copied().max().unwrap_or(0))
    }

    /// Whether every line of sight that meets both meets `front` first: of
    /// all planes between the two, the eye is on the side of `front`.
    fn hides(&self, front: &Voxel, behind: &Voxel) -> bool {
        let (low_a, high_a) = self.corners(front);
        let (low_b, high_b) = self.corners(behind);
        let sub = self.setup.sub_levels;
        let mut parted = false;
        for k in 0..3 {
            // The eye between rounded down and up: it must be clearly on a side.
            let (floor, ceil) = (self.setup.eye_floor[k], self.setup.eye_ceil[k]);
            if high_a[k] <= low_b[k] {
                if ceil > low_b[k] << sub {
                    return false;
                }
                parted = true;
            } else if high_b[k] <= low_a[k] {
                if floor < high_b[k] << sub {
                    return false;
                }
                parted = true;
            }
        }
        parted
    }

    fn fail_at(
        &self,
        outcome: &mut Outcome,
        check: Check,
        samples: &[usize],
        detail: impl Fn(usize) -> String,
    ) {
        if let Some(&first) = samples.first() {
            let (count, place) = (samples.len(), self.at(first));
            let detail = detail(first);
            outcome.fail(
                check,
                format!("{count} samples, the first at {place:?}: {detail}"),
            );
        }
    }

    /// Of a frame under `exact`: it is the one that is `defined`, and has all
    /// samples that are covered without level of detail.
    fn check_exact(&self, defined: &Frame, outcome: &mut Outcome) {
        let (frame, right) = (self.frame, self.right);
        let all = 0..frame.voxel.len();
        let differs = |&at: &usize| {
            frame.voxel[at] != defined.voxel[at] || frame.node[at] != defined.node[at]
        };
        let differing: Vec<usize> = all.clone().filter(differs).collect();
        self.fail_at(outcome, Check::Exact, &differing, |at| {
            format!("{:?}, should be {:?}", frame.voxel[at], defined.voxel[at])
        });
        let is_missing = |&at: &usize| right.voxel[at][3] >= 0 && frame.voxel[at][3] < 0;
        let missing: Vec<usize> = all.filter(is_missing).collect();
        self.fail_at(outcome, Check::Missing, &missing, |_| "missing".to_owned());
    }

    /// A voxel that is seen lies before the eye, and not wholly to one side
    /// of its sample by more than a sample and the tolerance.
    fn check_place(&self, outcome: &mut Outcome) {
        let tolerance = self.tolerance();
        if !tolerance.is_finite() {
            return;
        }
        let margin = 1 + libm::ceil(tolerance) as i128;
        let near = if self.is_exact() {
            1
        } else {
            i128::from(self.setup.near)
        };
        for (sample, voxel) in self.frame.voxel.iter().enumerate() {
            if voxel[3] < 0 {
                continue;
            }
            let (x, y) = self.at(sample);
            let vertices = self.vertices(voxel);
            let before = vertices.iter().any(|p| p[2] >= near);
            let beside = [x, y].into_iter().enumerate().any(|(c, at)| {
                let (low, high) = (at as i128 - margin, at as i128 + 1 + margin);
                // Margins are made of whole units, at most one too wide.
                let position = |p: &[i128; 3], units: i128| (p[c] + units) << self.setup.levels;
                let left = |p: &[i128; 3]| position(p, 1) < low * p[2];
                let right = |p: &[i128; 3]| position(p, -1) > high * p[2];
                vertices.iter().all(left) || vertices.iter().all(right)
            });
            if !before || beside {
                let what = if before {
                    "beside it"
                } else {
                    "behind the eye"
                };
                outcome.fail(
                    Check::Place,
                    format!("sample ({x}, {y}) shows {voxel:?}, which is {what}"),
                );
                return;
            }
        }
    }

    /// A sample whose voxel hides what is shown: under `exact` any, else in the middle of a voxel,
    /// where no seam is.
    fn check_order(&self, outcome: &mut Outcome) {
        if !self.tolerance().is_finite() {
            return;
        }
        let is_wrong = |&sample: &usize| {
            let (shown, right) = (&self.frame.voxel[sample], &self.right.voxel[sample]);
            if shown[3] < 0 || right[3] < 0 || shown == right || !self.hides(right, shown) {
                return false;
            }
            let around = || self.around(sample);
            let is_middle = || around().is_some_and(|all| all.iter().all(|v| v == right));
            self.is_exact() || (!self.is_at_bound && is_middle())
        };
        let wrong: Vec<usize> = (0..self.frame.voxel.len()).filter(is_wrong).collect();
        outcome.order = wrong.len() as u64;
        self.fail_at(outcome, Check::Order, &wrong, |at| {
            let (shown, right) = (self.frame.voxel[at], self.right.voxel[at]);
            format!("{shown:?} is seen, {right:?} hides it")
        });
    }

    fn check_holes(&self, outcome: &mut Outcome) {
        let mut holes = Vec::new();
        for sample in 0..self.frame.voxel.len() {
            let Some(around) = self.around(sample) else {
                continue;
            };
            outcome.inside += 1;
            let shown = &self.frame.voxel[sample];
            if shown[3] < 0 || around.iter().all(|front| self.hides(front, shown)) {
                holes.push(sample);
            }
        }
        outcome.holes = holes.len() as u64;
        // The paper's rules subdivide a voxel down to the level bound. A record that meets the bound shows that words are
        // too narrow for the view. Its holes, and those at infinite tolerance, are allowed.
        let is_promised =
            self.is_exact() || self.tolerance() <= STRICT_TOLERANCE && !self.is_at_bound;
        if is_promised {
            let inside = outcome.inside;
            self.fail_at(outcome, Check::Holes, &holes, |_| {
                format!("of {inside} inside a closed surface")
            });
        }
    }
}

fn path(setup: &FrameSetup, voxel: &Voxel, salt: usize) -> Vec<u8> {
    let octant = |bit: u32| (0..3).fold(0u8, |octant, k| octant << 1 | (voxel[k] >> bit & 1) as u8);
    let mut path: Vec<u8> = (0..setup.depth).rev().map(octant).collect();
    let below = setup.sub_levels.min(LEVELS_BELOW) as usize;
    path.extend((0..below).map(|at| (salt * 5 + at * 3 + 1) as u8 & 7));
    path
}

fn check_vertices(
    subject: &dyn Subject,
    case: &Case,
    graph: &Graph,
    seen: &CheckedFrame<'_>,
    outcome: &mut Outcome,
) {
    let setup = seen.setup;
    let widths = Widths {
        clip_frac: setup.clip_frac,
        screen_frac: setup.format.frac(),
        aa_log2: setup.options.aa_log2,
    };
    // The bounds are those of an eye (`spec/bounds.md`).
    if case.camera.ortho.is_some() {
        return;
    }
    let Ok(bounds) = Bounds::new(&case.world_camera(), &case.placement(graph), widths) else {
        return;
    };
    let shown: Vec<&Voxel> = seen.right.voxel.iter().filter(|v| v[3] >= 0).collect();
    let step = (shown.len() / VOXELS_LOOKED_AT).max(1);
    let mut found = Vertices::default();
    for (salt, voxel) in shown.into_iter().step_by(step).enumerate() {
        let way = path(setup, voxel, salt);
        vertex::check_path(subject, setup, &bounds, &way, &mut found);
    }
    outcome.worst = found.worst;
    if let Some(detail) = found.differs {
        outcome.fail(Check::Specification, detail);
    }
    if let Some(detail) = found.beyond {
        outcome.fail(Check::Bound, detail);
    }
}

fn check_engines(graph: &Graph, seen: &CheckedFrame<'_>, outcome: &mut Outcome) {
    // The machine draws views that the fast engine does not.
    if !seen.is_exact() || !seen.setup.has_headroom {
        return;
    }
    let options = FastOptions {
        threads: 1,
        ..FastOptions::default()
    };
    let mut fast = Fast::new(options, Box::new(Machine::default()));
    let mut frame = Frame::new(seen.setup.width, seen.setup.height, false);
    match fast.render(&graph.view(), seen.setup, &mut frame) {
        Ok(_) if frame == *seen.frame => {}
        Ok(_) => {
            let differing = crate::measure::count_differing(&frame.voxel, &seen.frame.voxel);
            outcome.fail(Check::Engines, format!("{differing} samples differ"));
        }
        Err(error) => outcome.fail(Check::Engines, error.to_string()),
    }
}
