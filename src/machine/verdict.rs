//! The drawing rules: whether a record is drawn, dropped or subdivided
//! (`SPEC.md`, "Drawing rules").

use hwmodel::{Probe, Stage};

use super::blocks::Block;
use super::cage::CageCoordinate;
use super::planes::Silhouette;
use super::record::{Pose, Record};
use super::size;
use super::state::State;
use super::watch::Watch;
use crate::project::Coverage;

/// What is to be done with a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Draw it at the sample of its centre (`any`, `center`).
    DrawCentre,
    /// Draw it at every sample that its box overlaps (`any`).
    DrawBox,
    /// Draw it at every sample in its silhouette (the rules that draw outlines).
    DrawSolid,
    /// Nothing of it can be seen.
    Drop,
    /// Push its children.
    Subdivide,
}

impl<P: Probe, L: CageCoordinate, W: Watch> State<'_, P, L, W> {
    /// Applies the frame's drawing rule to a record, and level of detail, which
    /// may make it solid.
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
        let at_bound =
            record.cube.level >= self.constants.level_bound || any && self.is_least(record);
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
    /// the fit stops, and all samples that it overlaps are drawn. Without this
    /// test all parts of a solid along a bisector would be kept until both sides
    /// of it are full.
    ///
    /// Where what is hidden is not read: whether no undrawn sample's ray meets the record.
    pub(super) fn is_hidden(&mut self, record: &Record<L>) -> bool {
        if self.options.organisation.hidden_unread {
            return self.options.reject_filled && !self.sees(record);
        }
        self.options.reject_filled
            && record.place.quad.level < self.constants.levels
            && !self.crosses_near(record)
            && self.is_at_most_a_sample(record)
            && self.first_undrawn(record).is_none()
    }

    /// Whether the ray of a sample that is not drawn yet meets a record.
    fn sees(&mut self, record: &Record<L>) -> bool {
        let Pose::Clip(clip, planes) = &record.pose else {
            unreachable!("`FrameSetup::screen_depth` lets no record change under these rules");
        };
        self.dp.stage(Stage::Draw);
        let (dp, cube) = (&mut self.dp, &record.cube);
        let silhouette = Silhouette::new(dp, &self.constants, cube, planes, clip.w_min);
        dp.next_step(0);
        self.canvas.sees(dp, record.place.quad, silhouette).is_ok()
    }

    /// Whether a record lies across the near plane and spans so little depth
    /// that it is dropped.
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

    /// Whether a record is so small that rounded screen positions do not part
    /// its vertices.
    fn is_least(&mut self, record: &Record<L>) -> bool {
        match &record.pose {
            Pose::Clip(..) => false,
            Pose::Screen(screen) => {
                size::screen_at_most(&mut self.dp, screen, self.constants.least_size_screen)
            }
        }
    }

    /// `any`, the image-order paper's rule: a box within one sample is drawn there.
    fn verdict_any(&mut self, record: &mut Record<L>) -> Verdict {
        self.apply_level_of_detail(record);
        let one = record.place.quad.level == self.constants.levels && record.place.inside;
        if !one || self.crosses_near(record) {
            return Verdict::Subdivide;
        }
        // A box within one sample meets a level of detail of one sample or more.
        let coarse = self
            .constants
            .lod_limit
            .as_ref()
            .is_some_and(|limit| limit.value() >= self.constants.size_limit.value());
        if record.cube.solid || coarse {
            Verdict::DrawBox
        } else {
            Verdict::Subdivide
        }
    }

    /// `center`: a voxel no larger than a sample is drawn at the sample of its
    /// centre.
    fn verdict_center(&mut self, record: &mut Record<L>) -> Verdict {
        self.apply_level_of_detail(record);
        if record.cube.solid && !self.crosses_near(record) && self.is_at_most_a_sample(record) {
            Verdict::DrawCentre
        } else {
            Verdict::Subdivide
        }
    }

    /// `exact` and `alpha`: a leaf, or a node taken for one by level of detail,
    /// is drawn by its silhouette.
    fn verdict_exact(&mut self, record: &mut Record<L>) -> Verdict {
        self.apply_level_of_detail(record);
        if record.cube.solid {
            Verdict::DrawSolid
        } else {
            Verdict::Subdivide
        }
    }

    /// Level of detail: makes a node with children solid if it is small enough.
    #[inline(always)]
    pub(super) fn apply_level_of_detail(&mut self, record: &mut Record<L>) {
        if record.cube.solid {
            return;
        }
        let c = &self.constants;
        record.cube.solid = match &record.pose {
            Pose::Clip(clip, _) => c.lod_depth[record.cube.level as usize].is_some_and(|least| {
                let solid = self.dp.le(least, clip.w_min);
                self.dp
                    .tap(Block::DetailDepth, &(clip.w_min, least), &solid);
                solid
            }),
            Pose::Screen(screen) => size::screen_at_most(&mut self.dp, screen, c.lod_limit_screen),
        };
    }

    /// Whether a part of a record is before the near plane.
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
                let below = c.levels - record.place.quad.level;
                size::clip_at_most(&mut self.dp, clip, &c.size_limit, below)
            }
            Pose::Screen(screen) => size::screen_at_most(&mut self.dp, screen, c.size_limit_screen),
        }
    }
}
