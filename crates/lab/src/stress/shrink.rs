//! From a failing case to a small one that fails the same check.

use glam::DVec3;

use super::case::Case;
use super::check::{Oracle, check};
use super::outcome::Check;
use super::scene::StressScene;
use super::subject::Subject;
use shiftvox::project::CageKind;
use shiftvox::scene::generate::Spec;

const MOST_VOXELS: usize = 6000;

pub(super) struct Shrinker<'s> {
    pub(super) subject: &'s dyn Subject,
    pub(super) check: Check,
    pub(super) most_records: u64,
    pub(super) left: u32,
}

impl Shrinker<'_> {
    fn take(&mut self, best: &mut Case, case: Case) -> bool {
        if self.left == 0 || case == *best {
            return false;
        }
        self.left -= 1;
        let Ok(graph) = case.scene.graph() else {
            return false;
        };
        let mut oracle = Oracle::default();
        let outcome = check(self.subject, &case, &graph, self.most_records, &mut oracle);
        let fails = outcome.fails(self.check);
        if fails {
            *best = case;
        }
        fails
    }

    pub(super) fn shrink(&mut self, failing: &Case) -> Case {
        let mut best = failing.clone();
        loop {
            let before = best.clone();
            for plainer in plainer(&best) {
                self.take(&mut best, plainer);
            }
            // Holes are holes of a closed surface: a list of voxels need not be one.
            if self.check != Check::Holes {
                self.fewer_voxels(&mut best);
            }
            if best == before || self.left == 0 {
                return best;
            }
        }
    }

    fn fewer_voxels(&mut self, best: &mut Case) {
        if let Some(scene) = best.scene.as_voxels(MOST_VOXELS) {
            let listed = Case {
                scene,
                ..best.clone()
            };
            self.take(best, listed);
        }
        let StressScene::Voxels { depth, at } = best.scene.clone() else {
            return;
        };
        let mut kept = at;
        let mut chunk = kept.len().div_ceil(2);
        while chunk > 0 && self.left > 0 {
            let mut from = 0;
            while from < kept.len() && kept.len() > 1 {
                let mut at = kept.clone();
                at.drain(from..(from + chunk).min(kept.len()));
                let fewer = Case {
                    scene: StressScene::Voxels {
                        depth,
                        at: at.clone(),
                    },
                    ..best.clone()
                };
                if !at.is_empty() && self.take(best, fewer) {
                    kept = at;
                } else {
                    from += chunk;
                }
            }
            chunk /= 2;
        }
    }
}

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
        if let Some(scene) = coarser(&c.scene) {
            c.scene = scene;
            c.camera.eye *= 0.5;
            c.camera.target *= 0.5;
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

/// A scene of one level less, half as large.
fn coarser(scene: &StressScene) -> Option<StressScene> {
    let mut scene = scene.clone();
    match &mut scene {
        StressScene::Generated(spec) => {
            let depth = spec.settings().depth.checked_sub(1)?;
            let text = format!("gen:{},depth={depth}", spec.generator().name);
            *spec = Spec::parse(&text).ok()?;
        }
        StressScene::Plane { depth, .. }
        | StressScene::Solid { depth }
        | StressScene::Cyclic { depth, .. } => *depth = depth.checked_sub(1)?,
        StressScene::Voxels { .. } => return None,
    }
    Some(scene)
}
