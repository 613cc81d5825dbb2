//! The record loop.

use hwmodel::{Datapath, Memory, Probe, Short, Stage, Word};

use super::MachineOptions;
use super::constants::Constants;
use super::draw::Canvas;
use super::fit::{self, Place};
use super::lattice::Lattice;
use super::open;
use super::planes::{Cube, Silhouette};
use super::record::{Clip, Planes, Pose, Record};
use super::size;
use super::taps::Block;
use super::to_screen;
use super::verdict::Verdict;
use crate::frame::quadtree::FULL;
use crate::frame::{FillVectors, Frame, QuadNode};
use crate::graph::GraphView;
use crate::project::{Coverage, EngineError, FrameSetup, Stats};

/// Draws a frame with cages of lattice `L`; `None` where records are left
/// after the turns of `most_records`.
pub(super) fn run<P: Probe, L: Lattice>(
    options: &MachineOptions,
    graph: &GraphView<'_>,
    setup: &FrameSetup,
    fill: &mut FillVectors,
    frame: &mut Frame,
    probe: P,
    most_records: u64,
) -> Result<Option<(Stats, P)>, EngineError> {
    let mut walk = Walk::<P, L>::new(options, graph, setup, fill, frame, probe);
    walk.push_object();
    while !walk.stack.is_empty() {
        if walk.counts.records >= most_records {
            return Ok(None);
        }
        walk.turn();
        if let Some(trap) = walk.dp.trap() {
            return Err(trap.into());
        }
    }
    if let Some(trap) = walk.dp.trap() {
        return Err(trap.into());
    }
    Ok(Some(walk.finish()))
}

/// What a frame came to.
#[derive(Debug, Default)]
pub(super) struct Counts {
    records: u64,
    pub(super) subdivided: u64,
    already_full: u64,
    hidden: u64,
    pub(super) absent_children: u64,
    behind_eye: u64,
    rejected: u64,
    changed_to_screen: u64,
    pub(super) at_bound: u64,
    solids: u64,
    deepest_stack: u64,
}

impl Counts {
    fn stats(&self, canvas: &Canvas<'_>, overflows: u64) -> Stats {
        vec![
            ("records", self.records),
            ("subdivided", self.subdivided),
            ("already_full", self.already_full),
            ("hidden_across_bisectors", self.hidden),
            ("absent_children", self.absent_children),
            ("behind_eye", self.behind_eye),
            ("rejected_by_quadtree", self.rejected),
            ("changed_to_screen", self.changed_to_screen),
            ("at_level_bound", self.at_bound),
            ("solids_drawn", self.solids),
            ("samples_drawn", canvas.drawn),
            ("samples_already_drawn", canvas.occluded),
            ("deepest_stack", self.deepest_stack),
            ("overflows", overflows),
        ]
    }
}

pub(super) struct Walk<'a, P: Probe, L> {
    pub(super) dp: Datapath<P>,
    pub(super) constants: Constants,
    pub(super) options: &'a MachineOptions,
    pub(super) graph: &'a GraphView<'a>,
    pub(super) canvas: Canvas<'a>,
    pub(super) stack: Vec<Record<L>>,
    pub(super) counts: Counts,
}

impl<'a, P: Probe, L: Lattice> Walk<'a, P, L> {
    /// A walk of a frame, with nothing on its stack.
    pub(super) fn new(
        options: &'a MachineOptions,
        graph: &'a GraphView<'a>,
        setup: &FrameSetup,
        fill: &'a mut FillVectors,
        frame: &'a mut Frame,
        probe: P,
    ) -> Self {
        let mut dp = Datapath::new(setup.format, options.overflow, probe);
        dp.stage(Stage::Push);
        let constants = Constants::load(&mut dp, setup);
        let heat = frame.records.is_some().then(|| vec![0; fill.nodes()]);
        Self {
            dp,
            constants,
            options,
            graph,
            canvas: Canvas::new(fill, frame, heat),
            stack: Vec::new(),
            counts: Counts::default(),
        }
    }

    /// After the last turn: what it came to.
    pub(super) fn finish(self) -> (Stats, P) {
        let overflows = self.dp.overflows();
        let mut stats = self.counts.stats(&self.canvas, overflows);
        if self.constants.blend_eye.is_some() {
            stats.push(("samples_blended", self.canvas.blended));
        }
        self.canvas.finish();
        (stats, self.dp.into_probe())
    }
}

impl<P: Probe, L: Lattice> Walk<'_, P, L> {
    /// Makes the record of the whole object and pushes it.
    pub(super) fn push_object(&mut self) {
        let c = &self.constants;
        let dp = &mut self.dp;
        let mut lattice =
            |coordinate: usize| L::from_frame(dp, c.origin[coordinate], c.edges[coordinate]);
        let (x, y, w) = (lattice(0), lattice(1), lattice(2));
        let (w_min, w_max) = w.span(dp);
        let side = dp.load(1i64 << (c.depth + c.sub_levels));
        let record = Record {
            min: [Word::ZERO; 3],
            max: [side; 3],
            node: self.graph.root,
            level: 0,
            voxel_level: 0,
            solid: false,
            quad: QuadNode::ROOT,
            inside: false,
            pose: Pose::Clip(
                Clip { x, y, w, w_min },
                Planes {
                    edge: c.edge_planes,
                    axis_c: c.axis_c,
                },
            ),
        };
        self.push_if_seen(record, w_max);
    }

    /// Whether full quadrants reject records.
    pub(super) fn is_rejecting(&self) -> bool {
        self.options.reject_filled
    }

    /// Whether a box whose greatest depth is `w_max` lies behind the eye.
    fn is_behind(&mut self, w_max: Word) -> bool {
        if self.constants.coverage == Coverage::Exact {
            !self.dp.is_positive(w_max)
        } else {
            self.dp.lt(w_max, self.constants.near)
        }
    }

    /// Pushes a clip-space record, if it is before the eye and there is an
    /// unfilled quadtree node for it. `w_max` is its greatest depth.
    pub(super) fn push_if_seen(&mut self, mut record: Record<L>, w_max: Word) {
        self.dp.stage(Stage::ChildBox);
        if self.is_behind(w_max) {
            self.counts.behind_eye += 1;
            return;
        }
        let place = record.place();
        let Pose::Clip(clip, planes) = &mut record.pose else {
            return;
        };
        let fill = self.canvas.seen_by_fit(self.options.reject_filled);
        let found = fit::clip(&mut self.dp, &self.constants, &fill, &place, clip, planes);
        self.push_at(record, found);
    }

    #[inline(always)]
    pub(super) fn push_at(&mut self, record: Record<L>, found: Option<Place>) {
        let Some(Place { quad, inside }) = found else {
            self.counts.rejected += 1;
            return;
        };
        self.dp.stage(Stage::Push);
        self.dp.write(Memory::Stack, self.stack.len() as u64);
        self.stack.push(Record {
            quad,
            inside,
            ..record
        });
        self.counts.deepest_stack = self.counts.deepest_stack.max(self.stack.len() as u64);
    }

    /// The turn of the record on top of the stack, which leaves it.
    pub(super) fn turn(&mut self) {
        // Out of the walk, so that a record is looked at where it lies: most
        // leave nothing, and only a parent is copied.
        let mut stack = std::mem::take(&mut self.stack);
        let last = stack.len().saturating_sub(1) as u64;
        let is_parent = stack
            .last_mut()
            .is_some_and(|record| self.is_parent(record, last));
        if !is_parent {
            stack.pop();
            self.stack = stack;
        } else if let Some(parent) = stack.pop() {
            self.stack = stack;
            self.subdivide(&parent);
        }
    }

    /// All of a record's turn but its subdivision, and whether that follows.
    /// `address`: the record's, on the stack.
    #[inline(always)]
    fn is_parent(&mut self, record: &mut Record<L>, address: u64) -> bool {
        self.dp.begin_record(self.counts.records, record.level);
        self.counts.records += 1;
        self.canvas.warm(record.quad);
        self.dp.stage(Stage::Pop);
        self.dp.read(Memory::Stack, address);

        self.dp.stage(Stage::Filled);
        if self.options.reject_filled {
            let address = record.quad.address();
            self.dp.read(Memory::FillVector, address as u64);
            let vector = self.canvas.fill.vector(record.quad);
            let full = self.dp.and_bits(4, vector, FULL) == FULL;
            self.dp
                .tap(Block::Filled, &Short::unsigned(vector, 4), &full);
            if full {
                self.counts.already_full += 1;
                return false;
            }
        }

        if let Pose::Clip(clip, _) = &record.pose {
            let place = record.place();
            if to_screen::may_change(&mut self.dp, &self.constants, record.level, &place, clip) {
                self.counts.changed_to_screen += 1;
                let screen = to_screen::change(&mut self.dp, &self.constants, &place, clip);
                record.pose = Pose::Screen(screen);
            }
        }

        self.dp.stage(Stage::OnePixel);
        if !record.solid {
            self.dp.read(Memory::Node, u64::from(record.node));
            record.solid =
                record.level >= self.constants.depth || self.graph.mask(record.node) == 0;
        }
        match self.verdict(record) {
            Verdict::DrawCentre => self.draw_centre(record),
            Verdict::DrawBox => self.draw_box(record),
            Verdict::DrawSolid => self.draw_solid(record),
            Verdict::Drop => {}
            Verdict::Subdivide if self.is_hidden(record) => self.counts.hidden += 1,
            Verdict::Subdivide => return true,
        }
        false
    }

    /// Draws a record at every sample that its box overlaps.
    fn draw_box(&mut self, record: &Record<L>) {
        let seen = self.seen(record);
        while let Some(sample) = self.first_open(record) {
            self.canvas.draw(&mut self.dp, sample, record.node, seen);
        }
    }

    /// The first sample of a record's box that is not drawn yet.
    #[inline]
    pub(super) fn first_open(&mut self, record: &Record<L>) -> Option<QuadNode> {
        let fill = self.canvas.seen_by_fit(true);
        let (dp, constants, quad) = (&mut self.dp, &self.constants, record.quad);
        match &record.pose {
            Pose::Clip(clip, _) => open::first(dp, constants, &fill, quad, *clip),
            Pose::Screen(screen) => open::first_in_place(dp, constants, &fill, quad, screen.spans),
        }
    }

    /// Draws a record at the sample that holds its centre, if that is in the
    /// picture and before the near plane.
    fn draw_centre(&mut self, record: &Record<L>) {
        self.dp.stage(Stage::Draw);
        let sample = match &record.pose {
            Pose::Clip(clip, _) => {
                let w = clip.w.centre(&mut self.dp);
                self.dp.tap(Block::CageCentre, &clip.w, &w);
                if self.dp.lt(w, self.constants.near) {
                    return;
                }
                size::clip_sample(&mut self.dp, &self.constants, record, clip, w)
            }
            Pose::Screen(screen) => {
                size::screen_sample(&mut self.dp, &self.constants, record, screen)
            }
        };
        if let Some(sample) = sample {
            let seen = self.seen(record);
            self.canvas.draw(&mut self.dp, sample, record.node, seen);
        }
    }

    /// Draws a solid by its silhouette. Only rules that draw single samples
    /// keep vertices in screen space.
    fn draw_solid(&mut self, record: &Record<L>) {
        let Pose::Clip(clip, planes) = &record.pose else {
            return;
        };
        self.counts.solids += 1;
        self.dp.stage(Stage::Draw);
        if !self.take_up_ink(record) {
            return;
        }
        let seen = self.seen(record);
        let cube = Cube {
            planes,
            level: record.level,
            min: record.min,
            max: record.max,
            before_eye: self.dp.is_positive(clip.w_min),
        };
        let outline = Silhouette::new(&mut self.dp, &self.constants, &cube);
        self.canvas
            .draw_outline(&mut self.dp, record.quad, outline, record.node, seen);
    }

    /// The voxel that a record stands for: lowest corner in finest voxels, level.
    fn seen(&self, record: &Record<L>) -> [i32; 4] {
        let side_log2 = self.constants.depth - record.voxel_level;
        let corner = record.min.map(|min| {
            let voxel = min.to_host() >> self.constants.sub_levels;
            (voxel >> side_log2 << side_log2) as i32
        });
        [corner[0], corner[1], corner[2], record.voxel_level as i32]
    }
}
