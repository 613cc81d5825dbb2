//! The record loop's state. Each step takes the parts that it reads or writes.

use crate::machine::stages::RecordStage;
use hwmodel::cycles::Organisation;
use hwmodel::{Datapath, Overflow, Probe};

use super::canvas::Canvas;
use super::constants::Constants;
use super::counters::Counts;
use super::fill::FillStore;
use super::record::Record;
use super::watch::Watch;
use crate::frame::{FillVectors, Frame};
use crate::graph::{GraphView, NodeLayout};
use crate::project::{FrameSetup, OCCLUSION_ORDER, Stats};

/// Settings of the machine that are not part of a frame set-up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MachineOptions {
    /// Treatment of a result that does not fit its word.
    pub overflow: Overflow,
    /// Whether records whose quadrants are all full are rejected; does not change the picture.
    pub reject_filled: bool,
    /// Children by octant, nearest first, for octant 000: [`OCCLUSION_ORDER`], except in tests.
    pub order: [u8; 8],
    /// Organisation of stack, nodes and tiles; does not change the picture.
    pub organisation: Organisation,
}

impl Default for MachineOptions {
    fn default() -> Self {
        Self {
            overflow: Overflow::Trap,
            reject_filled: true,
            order: OCCLUSION_ORDER,
            organisation: Organisation::default(),
        }
    }
}

pub(super) struct Job<'a> {
    pub(super) constants: Constants,
    pub(super) graph: &'a GraphView<'a>,
    pub(super) layout: NodeLayout,
    pub(super) order: [u8; 8],
    pub(super) organisation: Organisation,
}

pub(super) struct Traversal<L, W> {
    pub(super) stack: Vec<Record<L>>,
    pub(super) watch: W,
}

pub(super) struct State<'a, P: Probe, L, W> {
    pub(super) dp: Datapath<P>,
    pub(super) job: Job<'a>,
    pub(super) canvas: Canvas<'a>,
    pub(super) traversal: Traversal<L, W>,
}

impl<'a, P: Probe, L, W: Watch> State<'a, P, L, W> {
    /// The state before the first record. `fill` and `frame` have the set-up's size and are cleared.
    pub(super) fn new(
        options: MachineOptions,
        graph: &'a GraphView<'a>,
        setup: &FrameSetup,
        (fill, frame): (&'a mut FillVectors, &'a mut Frame),
        probe: P,
        watch: W,
    ) -> Self {
        let mut dp = Datapath::new(setup.format, options.overflow, probe);
        dp.stage(RecordStage::Push);
        let mut organisation = options.organisation;
        if !setup.options.coverage.draws_outlines() {
            organisation = organisation.without_outlines();
        }
        let job = Job {
            constants: Constants::load(&mut dp, setup),
            graph,
            layout: NodeLayout::new(graph, organisation.leaf_masks, organisation.bricks),
            order: options.order,
            organisation,
        };
        Self {
            dp,
            job,
            canvas: Canvas {
                fill: FillStore::new(fill, organisation, options.reject_filled),
                frame,
                counts: Counts::default(),
            },
            traversal: Traversal {
                stack: Vec::new(),
                watch,
            },
        }
    }

    /// Counts, probe and watch after the last record.
    pub(super) fn finish(mut self) -> (Stats, P, W) {
        self.canvas.counts.overflows = self.dp.overflows();
        let mut stats = self.canvas.counts.stats();
        let blends = self.job.constants.blend_eye.is_some();
        stats.retain(|&(name, _)| blends || name != "samples_blended");
        (stats, self.dp.into_probe(), self.traversal.watch)
    }
}
