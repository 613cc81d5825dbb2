//! What becomes of a record: the drawing rules (`SPEC.md`, "Drawing rules").

use hwmodel::Probe;

use super::lattice::Lattice;
use super::record::{Pose, Record};
use super::size;
use super::taps::Block;
use super::walk::Walk;
use crate::project::Coverage;

/// What becomes of a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Draw at the sample of the centre.
    DrawCentre,
    /// Draw at every sample that the box overlaps.
    DrawBox,
    /// Draw every sample in the silhouette.
    DrawSolid,
    /// Nothing of it can be seen.
    Drop,
    /// Go on with its children.
    Subdivide,
}

impl<P: Probe, L: Lattice> Walk<'_, P, L> {
    /// What is to become of a record. May find it solid by level of detail.
    pub(super) fn verdict(&mut self, record: &mut Record<L>) -> Verdict {
        if self.constants.coverage == Coverage::Exact {
            return self.verdict_exact(record);
        }
        if self.is_sliver_at_near(record) {
            return Verdict::Drop;
        }
        let any = self.constants.coverage == Coverage::Any;
        let verdict = if any {
            self.verdict_any(record)
        } else {
            self.verdict_center(record)
        };
        let at_bound = record.level >= self.constants.level_bound || any && self.is_least(record);
        if verdict == Verdict::Subdivide && at_bound {
            self.counts.at_bound += 1;
            return match (any, self.crosses_near(record)) {
                (true, false) => Verdict::DrawBox,
                _ => Verdict::DrawCentre,
            };
        }
        verdict
    }

    /// Whether a record no larger than a sample lies across a bisector, where
    /// the fit stops, with all samples that it overlaps drawn. Without this
    /// test, all parts of a solid along a bisector would live until both
    /// sides of it are full.
    pub(super) fn is_hidden(&mut self, record: &Record<L>) -> bool {
        self.is_rejecting()
            && record.quad.level < self.constants.levels
            && !self.crosses_near(record)
            && self.is_at_most_a_sample(record)
            && self.first_open(record).is_none()
    }

    /// Whether a record lies across the near plane and hardly beyond it.
    fn is_sliver_at_near(&mut self, record: &Record<L>) -> bool {
        let Pose::Clip(clip, _) = &record.pose else {
            return false;
        };
        if !self.dp.lt(clip.w_min, self.constants.near) {
            return false;
        }
        let (w_min, w_max) = clip.w.span(&mut self.dp);
        let span = self.dp.sub(w_max, w_min);
        self.dp.lt(span, self.constants.near_crossing)
    }

    /// Whether screen positions cannot part a record's vertices any more.
    fn is_least(&mut self, record: &Record<L>) -> bool {
        match &record.pose {
            Pose::Clip(..) => false,
            Pose::Screen(screen) => {
                size::screen_at_most(&mut self.dp, screen, self.constants.least_size_screen)
            }
        }
    }

    /// The paper's rule: a box within one sample is drawn there.
    fn verdict_any(&mut self, record: &mut Record<L>) -> Verdict {
        self.take_for_solid(record);
        let one = record.quad.level == self.constants.levels && record.inside;
        if !one || self.crosses_near(record) {
            return Verdict::Subdivide;
        }
        // Within one sample, a level of detail of one sample or more is met.
        let coarse = self
            .constants
            .lod_limit
            .as_ref()
            .is_some_and(|limit| limit.value() >= self.constants.size_limit.value());
        if record.solid || coarse {
            Verdict::DrawBox
        } else {
            Verdict::Subdivide
        }
    }

    /// A voxel no larger than a sample is drawn at the sample of its centre.
    fn verdict_center(&mut self, record: &mut Record<L>) -> Verdict {
        self.take_for_solid(record);
        if record.solid && !self.crosses_near(record) && self.is_at_most_a_sample(record) {
            Verdict::DrawCentre
        } else {
            Verdict::Subdivide
        }
    }

    /// A solid, by nature or by level of detail, is drawn by its silhouette.
    fn verdict_exact(&mut self, record: &mut Record<L>) -> Verdict {
        self.take_for_solid(record);
        if record.solid {
            Verdict::DrawSolid
        } else {
            Verdict::Subdivide
        }
    }

    /// Level of detail: a node with children that is small enough is a solid.
    #[inline(always)]
    fn take_for_solid(&mut self, record: &mut Record<L>) {
        if record.solid {
            return;
        }
        let c = &self.constants;
        record.solid = match &record.pose {
            Pose::Clip(clip, _) => c
                .lod_depth
                .get(record.level as usize)
                .copied()
                .flatten()
                .is_some_and(|least| {
                    let solid = self.dp.le(least, clip.w_min);
                    self.dp
                        .tap(Block::DetailDepth, &(clip.w_min, least), &solid);
                    solid
                }),
            Pose::Screen(screen) => size::screen_at_most(&mut self.dp, screen, c.lod_limit_screen),
        };
    }

    fn crosses_near(&mut self, record: &Record<L>) -> bool {
        match &record.pose {
            Pose::Clip(clip, _) => self.dp.lt(clip.w_min, self.constants.near),
            Pose::Screen(_) => false,
        }
    }

    /// Whether a record is no larger than a sample, less twice the tolerance.
    #[inline(always)]
    fn is_at_most_a_sample(&mut self, record: &Record<L>) -> bool {
        let c = &self.constants;
        match &record.pose {
            Pose::Clip(clip, _) => {
                let below = c.levels - record.quad.level;
                size::clip_at_most(&mut self.dp, clip, &c.size_limit, below)
            }
            Pose::Screen(screen) => size::screen_at_most(&mut self.dp, screen, c.size_limit_screen),
        }
    }
}
