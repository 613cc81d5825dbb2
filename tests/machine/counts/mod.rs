//! How much the machine does for a record: known answers, counted while it
//! draws.
//!
//! A probe of this test's own keeps the events of each record apart. The algorithm fixes the cost of a subdivided
//! record. `c` is the number of children that exist, `t` the number of quadtree nodes against whose bisectors a child's
//! box is tested (one per descent, and one at the end):
//!
//! | stage | corners (the image-order paper) | frame |
//! |---|---|---|
//! | centre | 3 adds, 3 shifts | the same |
//! | octant and order | 3 compares, 8 logic of 3 bits | the same |
//! | vertex pool, a coordinate | 19 adds, 19 shifts | 3 halvings (an add and a shift each), 7 adds |
//! | child box, a child | 6 selects | the same |
//! | child box, a child and coordinate | 14 min/max (7 + 7) | 6 min/max (3 + 3), 6 adds |
//! | quadtree fit, screen space | 4 `t` compares, `t` logic of 4 bits | the same |
//!
//! Coordinates are two in screen space (x, y) and three in clip space (X, Y, W). In clip space the child box finds the
//! span of W alone, and compares it once with the near plane. The spans of X and Y follow in the fit, relative to each
//! bisector. Every test of the fit then takes, a coordinate:
//!
//! | | corners | frame |
//! |---|---|---|
//! | doubled less the width | 8 shifts, 8 subtractions | 4 shifts, 4 subtractions |
//! | span | 14 min/max | 6 min/max, 6 adds |
//! | side | 2 compares | the same |
//!
//! If the child lies in the left (upper) half, its coordinates are doubled once more, by 8 shifts (4 for frames).
//!
//! All of that is under the image-order paper's drawing rule (`Coverage::Any`), for boxes inside the picture. A box
//! that leaves it is also compared with the picture's four edges. The exact rule also moves silhouette planes. A screen
//! position is divided for once, bit by bit, in a stage of its own; nothing is ever multiplied.

mod divides;
mod records;
mod sums;

use std::collections::BTreeMap;

use crate::common::*;
use hwmodel::count::Counter;
use hwmodel::memory::{MemoryProbe, Widths};
use hwmodel::{Memory, NoProbe, OpClass, Probe, Stage, StageLevel};
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::{Machine, MachineOptions};
use shiftvox::project::{CageKind, Camera, Coverage, FrameSetup, SetupOptions};

/// One event: an operation and its width, or an access to a memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Event {
    Op(OpClass, u32),
    Read(Memory, u64),
    Write(Memory),
}

/// The turn of one record.
#[derive(Debug, Default)]
struct Turn {
    level: u32,
    events: Vec<(Stage, Event)>,
}

/// Keeps the events of each record apart.
#[derive(Debug, Default)]
struct ByRecord {
    /// Events before the first record: the object's own fit.
    before: Turn,
    turns: Vec<Turn>,
}

impl ByRecord {
    fn note(&mut self, stage: Stage, event: Event) {
        let turn = self.turns.last_mut().unwrap_or(&mut self.before);
        turn.events.push((stage, event));
    }
}

impl Probe for ByRecord {
    fn op(&mut self, class: OpClass, bits: u32, place: StageLevel, times: u32) {
        if let Some(turn) = self.turns.last() {
            assert_eq!(place.level, turn.level);
        }
        for _ in 0..times {
            self.note(place.stage, Event::Op(class, bits));
        }
    }
    fn read(&mut self, memory: Memory, address: u64, place: StageLevel) {
        self.note(place.stage, Event::Read(memory, address));
    }
    fn write(&mut self, memory: Memory, _: u64, place: StageLevel) {
        self.note(place.stage, Event::Write(memory));
    }
    fn record(&mut self, index: u64, level: u32) {
        assert_eq!(index, self.turns.len() as u64);
        let events = Vec::new();
        self.turns.push(Turn { level, events });
    }
}

/// Operations of one stage, by class and width.
type Ops = BTreeMap<(OpClass, u32), u64>;

/// An expected [`Ops`]; classes of which there are none are left out.
fn ops(list: &[(OpClass, u32, u64)]) -> Ops {
    let mut ops = Ops::new();
    for &(class, bits, times) in list {
        *ops.entry((class, bits)).or_default() += times;
    }
    ops.retain(|_, times| *times > 0);
    ops
}

fn sum(events: impl IntoIterator<Item = Event>) -> Ops {
    let mut ops = Ops::new();
    for event in events {
        if let Event::Op(class, bits) = event {
            *ops.entry((class, bits)).or_default() += 1;
        }
    }
    ops
}

impl Turn {
    fn of(&self, stage: Stage) -> impl Iterator<Item = Event> + '_ {
        let here = move |&&(at, _): &&(Stage, Event)| at == stage;
        self.events.iter().filter(here).map(|&(_, event)| event)
    }

    fn ops(&self, stage: Stage) -> Ops {
        sum(self.of(stage))
    }

    /// The fits of a subdivided record's children. Earlier events of that stage are the record's own search for an open
    /// sample.
    fn children_s_fits(&self) -> Vec<Event> {
        self.events
            .iter()
            .skip_while(|(stage, _)| *stage != Stage::Centre)
            .filter(|(stage, _)| *stage == Stage::QuadtreeFit)
            .map(|&(_, event)| event)
            .collect()
    }

    fn count(&self, stage: Stage, class: OpClass) -> u64 {
        self.of(stage)
            .filter(|event| matches!(event, Event::Op(c, _) if *c == class))
            .count() as u64
    }

    fn is_subdivided(&self) -> bool {
        self.of(Stage::Centre).next().is_some()
    }

    /// Children that exist: all of a solid's, else those of the node's mask.
    fn children(&self, graph: &Graph) -> u64 {
        let node = self.of(Stage::OnePixel).find_map(|event| match event {
            Event::Read(Memory::Node, node) => u32::try_from(node).ok(),
            _ => None,
        });
        match node.map(|node| graph.view().mask(node)) {
            Some(mask) if mask != 0 && self.level < graph.depth => u64::from(mask.count_ones()),
            _ => 8,
        }
    }
}

/// The image-order paper's settings, but for the cage and the tolerance.
fn options(cage: CageKind, tolerance_px: f64) -> SetupOptions {
    SetupOptions {
        bits: 48,
        cage,
        tolerance_px,
        lod_px: 0.0,
        ..SetupOptions::of(Coverage::Any)
    }
}

fn watch<P: Probe>(graph: &Graph, setup: &FrameSetup, probe: P) -> (Frame, P) {
    let mut frame = Frame::new(setup.width, setup.height, false);
    let (_, probe) = Machine::default()
        .render_probed(&graph.view(), setup, &mut frame, probe)
        .expect("no overflow");
    (frame, probe)
}

/// A graph, and a camera that has all of it in view.
struct Scene {
    name: &'static str,
    graph: Graph,
    camera: Camera,
}

/// All children, half of them, and few of them; seen askew and straight on.
fn scenes() -> Vec<Scene> {
    let scene = |name, graph: Graph, eye, size| {
        let middle = f64::from(1u32 << graph.depth) / 2.0;
        let camera = camera(eye, [middle; 3], size);
        Scene {
            name,
            graph,
            camera,
        }
    };
    let diagonal = |[x, y, z]: [i32; 3]| (x + y + z) % 4 == 0;
    vec![
        scene("solid cube", solid(2), [13.0, 9.0, 11.0], 32),
        scene(
            "Sierpinski tetrahedron",
            sierpinski(3),
            [-9.0, 16.0, 21.0],
            32,
        ),
        scene("diagonals", octree(3, &diagonal), [4.0, 4.0, 30.0], 64),
        scene(
            "one voxel",
            octree(3, &|at| at == [5, 2, 7]),
            [30.0, -5.0, 8.0],
            64,
        ),
    ]
}

/// Runs a check on each subdivided record of each scene; the check is given
/// scene, set-up, turn and children.
fn each_subdivided(options: &SetupOptions, check: impl Fn(&str, &FrameSetup, &Turn, u64)) {
    for scene in scenes() {
        let (name, graph) = (scene.name, &scene.graph);
        let setup = setup(graph, &scene.camera, options);
        let (frame, probe) = watch(graph, &setup, ByRecord::default());
        assert!(frame.node.iter().any(|&n| n != frame.node[0]), "{name}");
        let turns: Vec<_> = probe.turns.iter().filter(|t| t.is_subdivided()).collect();
        assert!(turns.len() >= 10, "{name}: {} subdivided", turns.len());
        for turn in turns {
            check(name, &setup, turn, turn.children(graph));
        }
    }
}

/// Stages that do not depend on cage and space.
fn check_centre_and_order(setup: &FrameSetup, turn: &Turn) {
    let bits = setup.format.bits();
    assert_eq!(
        turn.ops(Stage::Centre),
        ops(&[(OpClass::Add, bits + 1, 3), (OpClass::Shift, bits + 1, 3)])
    );
    assert_eq!(
        turn.ops(Stage::Order),
        ops(&[(OpClass::Compare, bits, 3), (OpClass::Logic, 3, 8)])
    );
    assert_eq!(turn.ops(Stage::Pop), ops(&[]));
    assert_eq!(turn.ops(Stage::Filled), ops(&[(OpClass::Logic, 4, 1)]));
    assert_eq!(turn.ops(Stage::Push), ops(&[]));
}

/// Tests of the children's fits: each reads one fill vector.
fn fit_tests(turn: &Turn) -> u64 {
    turn.children_s_fits()
        .iter()
        .filter(|event| matches!(event, Event::Read(Memory::FillVector, _)))
        .count() as u64
}
