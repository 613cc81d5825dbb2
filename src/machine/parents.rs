//! The record loop with parents on its stack: another organisation of the same steps.
//!
//! ```text
//! the current record is the object's
//! loop:
//!     of the current record's children that are left, nearest first:
//!         make the child, search for its quadtree node; if it cannot be seen: the next
//!         if it is drawn: draw it; the next
//!         else store the current record, if it has children left, on the stack;
//!              the child is the current record
//!     when none is left: take the current record from the stack; end when that is empty
//! ```
//!
//! The stack holds subdivided records with remaining children, whole or as path entries (`path.rs`): never more than the
//! octree has levels. Children are computed again when their parent returns.
//!
//! *Tiles*: the object is drawn once per tile of the picture, with everything outside full from the start.

use crate::machine::stages::RecordStage;
use hwmodel::cycles::StackHolds;
use hwmodel::{Datapath, Memory, Probe, Word};

use super::blocks::Port;
use super::cage::CageCoordinate;
use super::children::{centre_and_order, child_cube};
use super::decide::decide;
use super::fill::FillStore;
use super::limit::Limit;
use super::path::{self, PathEntry};
use super::record::{Child, Pose, Record};
use super::record_loop::check_trap;
use super::state::{Job, State};
use super::watch::{Event, Watch};
use crate::frame::QuadNode;
use crate::frame::quadtree::FULL;
use crate::project::EngineError;

#[derive(Clone, Copy)]
pub(super) struct Parent<L: CageCoordinate> {
    pub(super) record: Record<L>,
    /// Remaining children, one bit per place in the order, nearest first.
    left: u8,
    expanded: Option<Expanded<L>>,
    is_stored: bool,
}

#[expect(
    clippy::large_enum_variant,
    reason = "a stack holds one kind or the other; boxes would be slower"
)]
#[derive(Clone, Copy)]
pub(super) enum Stored<L: CageCoordinate> {
    Whole(Parent<L>),
    Path(PathEntry),
}

#[derive(Clone, Copy)]
struct Expanded<L: CageCoordinate> {
    centre: [Word; 3],
    order: [u8; 8],
    /// X, Y, W in clip space; x and y in screen space.
    seeds: [L::Seed; 3],
}

impl<L: CageCoordinate> Parent<L> {
    fn new(record: Record<L>) -> Self {
        Self {
            record,
            left: u8::MAX,
            expanded: None,
            is_stored: false,
        }
    }

    pub(super) fn is_done(&self) -> bool {
        self.left == 0
    }

    fn entry(&self) -> PathEntry {
        let Record { cube, place, .. } = &self.record;
        PathEntry {
            node: cube.node,
            level: cube.level,
            quad_level: place.quad.level,
            inside: place.inside,
            left: self.left,
        }
    }

    fn is_new(&self) -> bool {
        self.left == u8::MAX
    }
}

impl<P: Probe, L: CageCoordinate, W: Watch> State<'_, P, L, W> {
    /// As [`State::draw_object`], tile by tile.
    pub(super) fn draw_by_tiles(&mut self, limit: &mut Limit) -> Result<bool, EngineError> {
        for tile in self.tiles() {
            let mut view = TileView::new(tile);
            view.swap(&mut self.canvas.fill);
            let is_done = self.draw_tile(tile, limit)?;
            view.swap(&mut self.canvas.fill);
            if !is_done {
                return Ok(false);
            }
        }
        Ok(true)
    }

    pub(super) fn tiles(&self) -> Vec<QuadNode> {
        let level = self.tile_levels();
        let side = 1u32 << level;
        let tiles = (0..side).flat_map(|y| (0..side).map(move |x| QuadNode { level, x, y }));
        tiles
            .filter(|&tile| self.canvas.fill.peek(tile) != FULL)
            .collect()
    }

    /// Levels of the image quadtree above the tiles; a tile is at least a sample.
    pub(super) fn tile_levels(&self) -> u32 {
        let wanted = self.job.organisation.tile_levels;
        wanted.min(self.job.constants.levels)
    }

    fn draw_tile(&mut self, tile: QuadNode, limit: &mut Limit) -> Result<bool, EngineError> {
        if self.job.organisation.stack == StackHolds::Children {
            return self.draw_object(tile, limit);
        }
        let mut stack = Vec::new();
        let mut current = self.object(tile);
        check_trap(&self.dp)?;
        let mut last = None;
        loop {
            let mut parent = match current.take().map(Stored::Whole).or_else(|| stack.pop()) {
                None => break,
                Some(Stored::Whole(parent)) => parent,
                Some(Stored::Path(entry)) => {
                    match self.take_back(&entry, last.as_ref(), stack.len() as u64) {
                        Some(parent) => parent,
                        None => continue,
                    }
                }
            };
            if limit.is_reached(self.canvas.counts.records)? {
                return Ok(false);
            }
            let child = self.parent_turn(&mut parent, stack.len() as u64);
            check_trap(&self.dp)?;
            last = Some(parent.record);
            current = match child {
                Some(child) => {
                    if !parent.is_done() {
                        stack.push(self.store(parent, stack.len() as u64));
                    }
                    Some(child)
                }
                None => (!parent.is_done()).then_some(parent),
            };
        }
        Ok(true)
    }

    /// The object in a tile, if it must be subdivided.
    pub(super) fn object(&mut self, tile: QuadNode) -> Option<Parent<L>> {
        self.push_object(tile);
        self.work_on_new()
    }

    pub(super) fn store(&mut self, mut parent: Parent<L>, address: u64) -> Stored<L> {
        let (dp, counts) = (&mut self.dp, &mut self.canvas.counts);
        dp.resume(parent.record.cube.level);
        dp.stage(RecordStage::Push);
        dp.write(Memory::Stack, address);
        counts.deepest_stack = counts.deepest_stack.max(address + 1);
        parent.expanded = None;
        parent.is_stored = true;
        let entry = parent.entry();
        Port::Push.tap(dp, address, &entry);
        match self.job.organisation.stack {
            StackHolds::Path => Stored::Path(entry),
            StackHolds::Children | StackHolds::Parents => Stored::Whole(parent),
        }
    }

    /// Restores a parent from its path entry and the previous record. `None`: its quadtree node is full.
    pub(super) fn take_back(
        &mut self,
        entry: &PathEntry,
        from: Option<&Record<L>>,
        address: u64,
    ) -> Option<Parent<L>> {
        let Some(from) = from else {
            unreachable!("an entry of the stack was left for a child");
        };
        let (dp, fill) = (&mut self.dp, &self.canvas.fill);
        fill.begin_turn();
        dp.resume(entry.level);
        dp.stage(RecordStage::Pop);
        dp.read(Memory::Stack, address);
        Port::Pop.tap(dp, address, entry);
        if fill.is_full(dp, from.place.quad.ancestor(entry.quad_level)) {
            self.canvas.counts.already_full += 1;
            return None;
        }
        dp.stage(RecordStage::Pop);
        let record = path::back(dp, &self.job.constants, entry, from);
        if P::TAPS {
            show_restored(dp, record);
        }
        Some(Parent {
            left: entry.left,
            ..Parent::new(record)
        })
    }

    /// Continues with a parent's children until one is visible: drawn, or returned if it must be subdivided.
    pub(super) fn parent_turn(
        &mut self,
        parent: &mut Parent<L>,
        address: u64,
    ) -> Option<Parent<L>> {
        let (dp, job, canvas) = (&mut self.dp, &self.job, &mut self.canvas);
        canvas.fill.begin_turn();
        dp.resume(parent.record.cube.level);
        let expanded = match parent.expanded {
            Some(expanded) => expanded,
            None => {
                if std::mem::take(&mut parent.is_stored) {
                    dp.stage(RecordStage::Pop);
                    dp.read(Memory::Stack, address);
                    Port::Pop.tap(dp, address, &parent.entry());
                    if canvas.fill.is_full(dp, parent.record.place.quad) {
                        canvas.counts.already_full += 1;
                        parent.left = 0;
                        return None;
                    }
                }
                canvas.counts.subdivided += u64::from(parent.is_new());
                *parent.expanded.insert(expand(dp, job, &parent.record))
            }
        };
        let record = &parent.record;
        while parent.left != 0 {
            let place = parent.left.trailing_zeros() as usize & 7;
            parent.left &= parent.left - 1;
            let octant = expanded.order[place];
            let counts = &mut canvas.counts;
            let (cube, centre) = (&record.cube, &expanded.centre);
            let Some(cube) = child_cube(dp, job, counts, cube, octant, centre) else {
                continue;
            };
            let from = record.place;
            let child = Child { cube, from };
            let mut grow = |seed| {
                dp.beside(RecordStage::VertexPool, |dp| {
                    L::grow(dp, seed, octant as usize)
                })
            };
            let is_seen = match &record.pose {
                Pose::Clip(_, planes) => {
                    let cage = expanded.seeds.each_ref().map(grow);
                    self.traversal
                        .push_clip_child(dp, job, canvas, child, cage, (planes, octant))
                }
                Pose::Screen(_) => {
                    let [x, y, _] = &expanded.seeds;
                    let cage = [x, y].map(&mut grow);
                    self.traversal.push_screen(dp, job, canvas, child, || cage)
                }
            };
            if is_seen {
                return self.work_on_new();
            }
        }
        None
    }

    fn work_on_new(&mut self) -> Option<Parent<L>> {
        let mut record = self.traversal.stack.pop()?;
        let (dp, counts) = (&mut self.dp, &mut self.canvas.counts);
        dp.begin_record(counts.records, record.cube.level);
        counts.records += 1;
        Port::Made.tap(dp, u64::from(false), &record);
        self.traversal
            .watch
            .see(Event::<L>::Turn(record.place.quad));
        let needs_children = decide(dp, &self.job, &mut self.canvas, &mut record);
        needs_children.then(|| Parent::new(record))
    }
}

/// Without the numbers that its turn does not need: node and least depth.
fn show_restored<P: Probe, L: CageCoordinate>(dp: &mut Datapath<P>, mut record: Record<L>) {
    record.cube.node = 0;
    if let Pose::Clip(clip, _) = &mut record.pose {
        clip.w_min = Word::ZERO;
    }
    Port::Made.tap(dp, u64::from(true), &record);
}

fn expand<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    job: &Job<'_>,
    record: &Record<L>,
) -> Expanded<L> {
    let (centre, order) = centre_and_order(dp, job, &record.cube);
    let seeds = dp.beside(RecordStage::VertexPool, |dp| match &record.pose {
        Pose::Clip(clip, _) => [&clip.x, &clip.y, &clip.w].map(|cage| cage.seed(dp)),
        Pose::Screen(screen) => {
            let [x, y] = [&screen.x, &screen.y].map(|cage| cage.seed(dp));
            [x, y, y]
        }
    });
    Expanded {
        centre,
        order,
        seeds,
    }
}

/// A tile's view of the fill vectors above it: everything outside its path is full.
#[derive(Debug, Clone)]
pub(super) struct TileView {
    tile: QuadNode,
    /// Vectors of the nodes above, from the root; while the view is in use, the replaced ones.
    above: Vec<u8>,
}

impl TileView {
    pub(super) fn new(tile: QuadNode) -> Self {
        let vector = |level: u32| {
            let child = tile.ancestor(level + 1);
            FULL & !(1 << child.in_parent())
        };
        Self {
            tile,
            above: (0..tile.level).map(vector).collect(),
        }
    }

    pub(super) fn swap(&mut self, fill: &mut FillStore<'_>) {
        for (level, own) in (0..self.tile.level).zip(&mut self.above) {
            *own = fill.replace(self.tile.ancestor(level), *own);
        }
    }
}
