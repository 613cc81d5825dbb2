//! From a failing case to a small one that fails the same check.

use glam::DVec3;

use super::case::Case;
use super::check::{Oracle, check};
use super::outcome::Check;
use super::scene::StressScene;
use super::subject::Subject;
use shiftvox::project::CageKind;
use shiftvox::scene::generate::Spec;

/// Most voxels of a scene that is taken apart voxel by voxel.
const MOST_VOXELS: usize = 6000;

/// Looks for smaller and plainer cases that fail too.
pub(crate) struct Shrinker<'s> {
    subject: &'s dyn Subject,
    check: Check,
    most_records: u64,
    /// Cases that may still be drawn.
    left: u32,
}

impl<'s> Shrinker<'s> {
    /// For failures of one check; draws no more than `budget` cases.
    pub(crate) fn new(
        subject: &'s dyn Subject,
        check: Check,
        most_records: u64,
        budget: u32,
    ) -> Self {
        Self {
            subject,
            check,
            most_records,
            left: budget,
        }
    }

    fn fails(&mut self, case: &Case) -> bool {
        if self.left == 0 {
            return false;
        }
        self.left -= 1;
        let Ok(graph) = case.scene.graph() else {
            return false;
        };
        let mut oracle = Oracle::default();
        let outcome = check(self.subject, case, &graph, self.most_records, &mut oracle);
        outcome.fails(self.check)
    }

    /// The smallest case that was found, and it fails.
    pub(crate) fn shrink(&mut self, failing: &Case) -> Case {
        let mut best = failing.clone();
        loop {
            let before = best.clone();
            for plainer in plainer(&best) {
                if plainer != best && self.fails(&plainer) {
                    best = plainer;
                }
            }
            self.fewer_voxels(&mut best);
            if best == before || self.left == 0 {
                return best;
            }
        }
    }

    /// Leaves voxels out, first halves of the scene, at last one by one.
    fn fewer_voxels(&mut self, best: &mut Case) {
        // Holes are holes of a closed surface: a list of voxels need not be one.
        if self.check == Check::Holes {
            return;
        }
        if !matches!(best.scene, StressScene::Voxels { .. }) {
            let Some(listed) = best.scene.as_voxels(MOST_VOXELS) else {
                return;
            };
            let listed = Case {
                scene: listed,
                ..best.clone()
            };
            if !self.fails(&listed) {
                return;
            }
            *best = listed;
        }
        let StressScene::Voxels { depth, at } = best.scene.clone() else {
            return;
        };
        let mut kept = at;
        let mut chunk = kept.len().div_ceil(2);
        while chunk > 0 && self.left > 0 {
            let mut from = 0;
            while from < kept.len() && kept.len() > 1 {
                let mut fewer = kept.clone();
                fewer.drain(from..(from + chunk).min(kept.len()));
                let case = Case {
                    scene: StressScene::Voxels {
                        depth,
                        at: fewer.clone(),
                    },
                    ..best.clone()
                };
                if !fewer.is_empty() && self.fails(&case) {
                    kept = fewer;
                    *best = case;
                } else {
                    from += chunk;
                }
            }
            chunk /= 2;
        }
    }
}

/// Cases that are a little plainer.
fn plainer(case: &Case) -> Vec<Case> {
    let mut all = Vec::new();
    let mut push = |change: &dyn Fn(&mut Case)| {
        let mut plainer = case.clone();
        change(&mut plainer);
        all.push(plainer);
    };
    for part in [2, 4] {
        push(&|c| {
            c.camera.width = (c.camera.width * (part - 1) / part).max(1);
            c.camera.height = (c.camera.height * (part - 1) / part).max(1);
        });
    }
    push(&|c| {
        if let Some((scene, scale)) = coarser(&c.scene) {
            c.scene = scene;
            c.camera.eye *= scale;
            c.camera.target *= scale;
        }
    });
    push(&|c| c.shift = 0);
    push(&|c| c.options.lod_px = 0.0);
    push(&|c| c.options.tolerance_px = 0.0);
    push(&|c| c.options.cage = CageKind::Frame);
    push(&|c| c.options.frac = None);
    push(&|c| {
        (c.options.bits, c.options.frac) = (64, None);
    });
    push(&|c| c.camera.fov_degrees = 60.0);
    push(&|c| c.camera.up = DVec3::Z);
    for digits in [0, 1, 3] {
        let scale = libm::exp10(f64::from(digits));
        let rounded = |v: DVec3| (v * scale).round() / scale;
        push(&|c| c.camera.eye = rounded(c.camera.eye));
        push(&|c| c.camera.target = rounded(c.camera.target));
    }
    all
}

/// A scene of one level less, and what that makes of lengths.
fn coarser(scene: &StressScene) -> Option<(StressScene, f64)> {
    let scene = match scene {
        StressScene::Generated(spec) => {
            let depth = spec.settings().depth.checked_sub(1)?;
            let text = format!("gen:{},depth={depth}", spec.generator().name);
            StressScene::Generated(Spec::parse(&text).ok()?)
        }
        StressScene::Plane { depth, normal } => StressScene::Plane {
            depth: depth.checked_sub(1)?,
            normal: *normal,
        },
        StressScene::Solid { depth } => StressScene::Solid {
            depth: depth.checked_sub(1)?,
        },
        StressScene::Cyclic { depth, seed } => StressScene::Cyclic {
            depth: depth.checked_sub(1)?,
            seed: *seed,
        },
        StressScene::Voxels { .. } => return None,
    };
    Some((scene, 0.5))
}
