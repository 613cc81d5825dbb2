//! The machine as a workload of the cycle model. The children of a turn go to the scheduler instead of a stack.

use hwmodel::cycles::{
    self, Child, CycleReport, Hardware, ImageNode, Observer, StackHolds, TurnLog,
};
use serde::Serialize;

use crate::frame::quadtree::FULL;
use crate::frame::{Frame, QuadNode};
use crate::graph::GraphView;
use crate::machine::cage::{CageCoordinate, with_cage};
use crate::machine::engine::Machine;
use crate::machine::parents::{Parent, Stored, TileView};
use crate::machine::path::PathEntry;
use crate::machine::record::Record;
use crate::machine::record_loop::check_trap;
use crate::machine::stages::check_hardware;
use crate::machine::state::MachineOptions;
use crate::machine::state::State;
use crate::machine::watch::{Event, Watch};
use crate::project::{EngineError, FrameSetup, Stats, most_records};

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Simulated {
    pub cycles: CycleReport,
    /// Without the stack's depth; at last the most tiles in progress at once, each with fill vectors on the chip.
    pub counts: Stats,
}

pub type SimulateError = cycles::SimulationError<EngineError>;

impl Machine {
    /// Draws a frame on simulated hardware, in its organisation, except `frame.records`.
    ///
    /// Under [`Independence::None`](cycles::Independence) and `Image` the machine does exactly the serial work. Under
    /// `Classes` and `Both` the picture is the same if no two children of one class draw the same sample, as under the
    /// exact rule. Fails as [`cycles::simulate`] does, and when a word overflows under the trap policy.
    pub fn simulate(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
        hardware: &Hardware,
        observer: &mut dyn Observer,
    ) -> Result<Simulated, SimulateError> {
        check_hardware(hardware).map_err(SimulateError::Hardware)?;
        with_cage!(setup, L => self.simulate_as::<L>((graph, setup), frame, hardware, observer))
    }

    fn simulate_as<L: CageCoordinate>(
        &mut self,
        (graph, setup): (&GraphView<'_>, &FrameSetup),
        frame: &mut Frame,
        hardware: &Hardware,
        observer: &mut dyn Observer,
    ) -> Result<Simulated, SimulateError> {
        let options = MachineOptions {
            organisation: hardware.organisation,
            ..self.options
        };
        let canvas = (self.emptied(setup, frame)?, &mut *frame);
        let ranks = Ranks(Vec::new());
        let log = TurnLog::new(hardware);
        let state = State::<_, L, _>::new(options, graph, setup, canvas, log, ranks);
        let handed_out = match hardware.hands_out_tiles() {
            true => state.tiles(),
            false => Vec::new(),
        };
        let mut steps = Steps {
            state,
            handed_out,
            waiting: Vec::new(),
            free: Vec::new(),
            tiles: vec![Tile::new(QuadNode::ROOT)],
            open: 0,
            most_open: 0,
            shown: 0,
            most_records: most_records(setup),
        };
        let cycles = cycles::simulate(hardware, &mut steps, observer)?;
        let most_open = steps.most_open;
        let (mut counts, _, _) = steps.state.finish();
        counts.retain(|(name, _)| *name != "deepest_stack");
        counts.push(("most_open_tiles", most_open));
        Ok(Simulated { cycles, counts })
    }
}

/// Places of pushed children in the occlusion order.
struct Ranks(Vec<u8>);

impl Watch for Ranks {
    fn see<L: CageCoordinate>(&mut self, event: Event<'_, L>) {
        if let Event::Pushed(rank) = event {
            self.0.push(rank);
        }
    }
}

#[derive(Clone, Copy)]
enum Work<L: CageCoordinate> {
    Tiles(QuadNode),
    /// A record, where children lie on the stack.
    Record(Record<L>),
    Parent(Parent<L>),
    /// A parent's path entry on the stack, and the parent's quadtree node.
    Path(PathEntry, QuadNode),
}

/// A tile, and the walk that draws it.
struct Tile<L> {
    view: TileView,
    last: Option<Record<L>>,
    /// Number of waiting work items.
    waiting: u32,
}

impl<L> Tile<L> {
    fn new(quad: QuadNode) -> Self {
        Self {
            view: TileView::new(quad),
            last: None,
            waiting: 0,
        }
    }
}

struct Steps<'a, L: CageCoordinate> {
    state: State<'a, TurnLog, L, Ranks>,
    /// Work by the scheduler's number, with its tile.
    waiting: Vec<(Work<L>, usize)>,
    /// Unused numbers of work.
    free: Vec<u32>,
    handed_out: Vec<QuadNode>,
    tiles: Vec<Tile<L>>,
    /// Tiles in progress, now and at most.
    open: u64,
    most_open: u64,
    /// The tile whose view is in place.
    shown: usize,
    most_records: u64,
}

/// Of a stored parent and of its child, of different classes.
const FIRST_PLACE: u8 = 0;
const LAST_PLACE: u8 = 7;

impl<L: CageCoordinate> Steps<'_, L> {
    fn hand_over(&mut self, work: Work<L>, place: u8, children: &mut Vec<Child>) {
        let quad = match &work {
            Work::Tiles(quad) => *quad,
            Work::Record(record) => record.place.quad,
            Work::Parent(parent) => parent.record.place.quad,
            Work::Path(_, quad) => *quad,
        };
        let image_node = ImageNode {
            level: quad.level,
            x: quad.x,
            y: quad.y,
        };
        if !matches!(work, Work::Tiles(_)) {
            let tile = &mut self.tiles[self.shown];
            tile.waiting += 1;
            self.open += u64::from(tile.waiting == 1);
            self.most_open = self.most_open.max(self.open);
        }
        let entry = (work, self.shown);
        let item = if let Some(at) = self.free.pop() {
            self.waiting[at as usize] = entry;
            at
        } else {
            self.waiting.push(entry);
            (self.waiting.len() - 1) as u32
        };
        children.push(Child {
            item,
            place,
            image_node,
        });
    }

    /// The last pushed (nearest) first.
    fn hand_over_records(&mut self, children: &mut Vec<Child>) {
        while let Some(record) = self.state.traversal.stack.pop() {
            let Some(place) = self.state.traversal.watch.0.pop() else {
                unreachable!("every record on the stack was pushed as a child");
            };
            self.hand_over(Work::Record(record), place, children);
        }
    }

    fn switch_to(&mut self, tile: usize) {
        if tile != self.shown {
            let fill = &mut self.state.canvas.fill;
            self.tiles[self.shown].view.swap(fill);
            self.tiles[tile].view.swap(fill);
            self.shown = tile;
        }
    }

    /// Begins a tile, or its quadrants later.
    fn begin_tiles(&mut self, quad: QuadNode, children: &mut Vec<Child>) {
        if self.state.canvas.fill.peek(quad) == FULL && quad.level > 0 {
            // It lies outside the picture.
            return;
        }
        if quad.level < self.state.tile_levels() {
            for quadrant in 0..4 {
                self.hand_over(Work::Tiles(quad.quadrant(quadrant)), FIRST_PLACE, children);
            }
            return;
        }
        self.tiles.push(Tile::new(quad));
        self.switch_to(self.tiles.len() - 1);
        match self.state.job.organisation.stack {
            StackHolds::Children => {
                self.state.push_object(quad);
                if !self.state.traversal.stack.is_empty() {
                    // The object has no siblings: any rank is correct.
                    self.state.traversal.watch.0.push(FIRST_PLACE);
                }
                self.hand_over_records(children);
            }
            StackHolds::Parents | StackHolds::Path => {
                if let Some(object) = self.state.object(quad) {
                    self.hand_over(Work::Parent(object), FIRST_PLACE, children);
                }
            }
        }
    }

    fn parent_turn(&mut self, mut parent: Parent<L>, children: &mut Vec<Child>) {
        // The scheduler has its own stacks; addresses only distinguish reads.
        let address = u64::from(parent.record.cube.level);
        let child = self.state.parent_turn(&mut parent, address);
        self.tiles[self.shown].last = Some(parent.record);
        let Some(child) = child else {
            if !parent.is_done() {
                self.hand_over(Work::Parent(parent), LAST_PLACE, children);
            }
            return;
        };
        self.hand_over(Work::Parent(child), FIRST_PLACE, children);
        if !parent.is_done() {
            let quad = parent.record.place.quad;
            let work = match self.state.store(parent, address) {
                Stored::Whole(parent) => Work::Parent(parent),
                Stored::Path(entry) => Work::Path(entry, quad),
            };
            self.hand_over(work, LAST_PLACE, children);
        }
    }

    fn path_turn(&mut self, entry: &PathEntry, children: &mut Vec<Child>) {
        let from = self.tiles[self.shown].last.as_ref();
        let address = u64::from(entry.level);
        if let Some(parent) = self.state.take_back(entry, from, address) {
            self.parent_turn(parent, children);
        }
    }

    fn trap(&self) -> Result<(), EngineError> {
        if self.state.canvas.counts.records > self.most_records {
            return Err(EngineError::Records(self.most_records));
        }
        check_trap(&self.state.dp)
    }
}

impl<L: CageCoordinate> cycles::Workload for Steps<'_, L> {
    type Error = EngineError;

    fn start(&mut self, children: &mut Vec<Child>) -> Result<(), EngineError> {
        self.begin_tiles(QuadNode::ROOT, children);
        self.trap()
    }

    fn tiles(&self) -> u32 {
        self.handed_out.len() as u32
    }

    fn begin_tile(&mut self, tile: u32, children: &mut Vec<Child>) -> Result<(), EngineError> {
        self.begin_tiles(self.handed_out[tile as usize], children);
        self.trap()
    }

    fn turn(&mut self, item: u32, children: &mut Vec<Child>) -> Result<(), EngineError> {
        let (work, tile) = self.waiting[item as usize];
        self.free.push(item);
        self.switch_to(tile);
        match work {
            Work::Tiles(quad) => self.begin_tiles(quad, children),
            Work::Record(record) => {
                self.state.traversal.stack.push(record);
                self.state.turn();
                self.hand_over_records(children);
            }
            Work::Parent(parent) => self.parent_turn(parent, children),
            Work::Path(entry, _) => self.path_turn(&entry, children),
        }
        if !matches!(work, Work::Tiles(_)) {
            let tile = &mut self.tiles[tile];
            tile.waiting -= 1;
            self.open -= u64::from(tile.waiting == 0);
        }
        self.trap()
    }

    fn log(&mut self) -> &mut TurnLog {
        self.state.dp.probe_mut()
    }
}
