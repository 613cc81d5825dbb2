//! The state of the record loop. What is done with it is in `push.rs`, `undrawn.rs`, `verdict.rs`,
//! `decide.rs`, `children.rs`, `record_loop.rs` and `parents.rs`.

use hwmodel::{Datapath, Probe, Stage};

use super::cage::CageCoordinate;
use super::canvas::Canvas;
use super::constants::Constants;
use super::fill::FillStore;
use super::options::MachineOptions;
use super::record::Record;
use super::watch::Watch;
use crate::frame::{FillVectors, Frame};
use crate::graph::{GraphView, NodeLayout};
use crate::project::{FrameSetup, Stats};

/// Counts of a frame, by the names in [`State::finish`].
#[derive(Debug, Default)]
pub(super) struct RecordCounts {
    pub(super) records: u64,
    pub(super) subdivided: u64,
    pub(super) already_full: u64,
    pub(super) hidden: u64,
    pub(super) absent_children: u64,
    pub(super) behind_eye: u64,
    pub(super) rejected: u64,
    pub(super) changed_to_screen: u64,
    pub(super) at_bound: u64,
    pub(super) solids: u64,
    pub(super) deepest_stack: u64,
}

/// All that the record loop works on, in cages of type `L`.
pub(super) struct State<'a, P: Probe, L, W> {
    pub(super) dp: Datapath<P>,
    pub(super) constants: Constants,
    pub(super) options: MachineOptions,
    pub(super) graph: &'a GraphView<'a>,
    /// Where its nodes are read.
    pub(super) layout: NodeLayout,
    pub(super) canvas: Canvas<'a>,
    pub(super) stack: Vec<Record<L>>,
    pub(super) counts: RecordCounts,
    pub(super) watch: W,
}

impl<'a, P: Probe, L: CageCoordinate, W: Watch> State<'a, P, L, W> {
    /// The state of a frame before the first record: the stack is empty. `fill`
    /// and `frame` have the set-up's size and are cleared.
    pub(super) fn new(
        mut options: MachineOptions,
        graph: &'a GraphView<'a>,
        setup: &FrameSetup,
        (fill, frame): (&'a mut FillVectors, &'a mut Frame),
        probe: P,
        watch: W,
    ) -> Self {
        let mut dp = Datapath::new(setup.format, options.overflow, probe);
        dp.stage(Stage::Push);
        if !setup.options.coverage.draws_outlines() {
            options.organisation = options.organisation.without_outlines();
        }
        let organisation = options.organisation;
        let layout = NodeLayout::new(graph, organisation.leaf_masks, organisation.bricks);
        let fill = FillStore::new(fill, organisation.joined_fill, organisation.tile_levels);
        let constants = Constants::load(&mut dp, setup);
        Self {
            dp,
            constants,
            options,
            graph,
            layout,
            canvas: Canvas::new(fill, frame),
            stack: Vec::new(),
            counts: RecordCounts::default(),
            watch,
        }
    }

    /// The counts of a frame after its last record, and what watched it.
    pub(super) fn finish(self) -> (Stats, P, W) {
        let counts = &self.counts;
        let mut stats = vec![
            ("records", counts.records),
            ("subdivided", counts.subdivided),
            ("already_full", counts.already_full),
            ("hidden_across_bisectors", counts.hidden),
            ("absent_children", counts.absent_children),
            ("behind_eye", counts.behind_eye),
            ("rejected_by_quadtree", counts.rejected),
            ("changed_to_screen", counts.changed_to_screen),
            ("at_level_bound", counts.at_bound),
            ("solids_drawn", counts.solids),
            ("samples_drawn", self.canvas.drawn),
            ("samples_already_drawn", self.canvas.occluded),
            ("deepest_stack", counts.deepest_stack),
            ("overflows", self.dp.overflows()),
        ];
        if self.constants.blend_eye.is_some() {
            stats.push(("samples_blended", self.canvas.blended));
        }
        (stats, self.dp.into_probe(), self.watch)
    }
}
