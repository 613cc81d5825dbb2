//! How much the machine does for a record: known answers, counted while it
//! draws.
//!
//! A probe of this test's own keeps the events of each record apart. What a
//! subdivided record costs is fixed by the algorithm. `c` is the number of
//! children that exist, `t` the number of quadtree nodes against whose
//! bisectors a child's box is tested (one per descent, and one at the end):
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
//! Coordinates are two in screen space (x, y) and three in clip space (X, Y,
//! W). In clip space the child box finds the span of W alone, and compares it
//! once with the near plane; those of X and Y follow in the fit, relative to
//! each bisector. Every test of the fit then takes, a coordinate:
//!
//! | | corners | frame |
//! |---|---|---|
//! | doubled less the width | 8 shifts, 8 subtractions | 4 shifts, 4 subtractions |
//! | span | 14 min/max | 6 min/max, 6 adds |
//! | side | 2 compares | the same |
//!
//! and where the child goes on to the left (upper) half, its coordinates are
//! doubled once more, by 8 shifts (4 for frames).
//!
//! All of that is under the image-order paper's drawing rule (`Coverage::Any`), for boxes
//! inside the picture: one that leaves it is also compared with the picture's
//! four edges, and the exact rule carries silhouette planes along. A screen
//! position is divided for once, bit by bit, in a stage of its own; nothing
//! is ever multiplied.

use std::collections::BTreeMap;

use crate::common::*;
use hwmodel::cost::{Costing, MinMaxUnits, Tally, tallies};
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
    /// What is done before the first record: the object's own fit.
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

    /// The fits of a subdivided record's children. What comes before the
    /// subdivision in the same stage is the record's own search for an open
    /// sample, in case it is hidden across a bisector.
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
    let diagonal = |[x, y, z]: [i32; 3]| (x + y + z) % 4 == 0;
    vec![
        Scene {
            name: "solid cube",
            graph: solid(2),
            camera: camera([13.0, 9.0, 11.0], [2.0, 2.0, 2.0], 32),
        },
        Scene {
            name: "Sierpinski tetrahedron",
            graph: sierpinski(3),
            camera: camera([-9.0, 16.0, 21.0], [4.0, 4.0, 4.0], 32),
        },
        Scene {
            name: "diagonals",
            graph: octree(3, &diagonal),
            camera: camera([4.0, 4.0, 30.0], [4.0, 4.0, 4.0], 64),
        },
        Scene {
            name: "one voxel",
            graph: octree(3, &|at| at == [5, 2, 7]),
            camera: camera([30.0, -5.0, 8.0], [4.0, 4.0, 4.0], 64),
        },
    ]
}

/// Runs a check on each subdivided record of each scene; the check is given
/// scene, set-up, turn and children.
fn each_subdivided(options: &SetupOptions, check: impl Fn(&str, &FrameSetup, &Turn, u64)) {
    for Scene {
        name,
        graph,
        camera,
    } in scenes()
    {
        let setup = setup(&graph, &camera, options);
        let (frame, probe) = watch(&graph, &setup, ByRecord::default());
        assert!(frame.node.iter().any(|&n| n != frame.node[0]), "{name}");
        let turns: Vec<_> = probe.turns.iter().filter(|t| t.is_subdivided()).collect();
        assert!(turns.len() >= 10, "{name}: {} subdivided", turns.len());
        for turn in turns {
            check(name, &setup, turn, turn.children(&graph));
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

/// Tests of the children's fits: each looks at one quadtree node's fill vector.
fn fit_tests(turn: &Turn) -> u64 {
    turn.children_s_fits()
        .iter()
        .filter(|event| matches!(event, Event::Read(Memory::FillVector, _)))
        .count() as u64
}

/// What a cage coordinate costs: halvings and additions of the vertex pool, numbers that are held,
/// minima, maxima and additions of a span.
const CAGES: [(CageKind, [u64; 5]); 2] = [
    (CageKind::Corners, [19, 0, 8, 7 + 7, 0]),
    (CageKind::Frame, [3, 7, 4, 3 + 3, 6]),
];

/// Pool, box and fit of the table above, for both cages in both spaces.
#[test]
fn a_subdivided_record_costs_what_the_table_says() {
    for (cage, [halvings, pool_adds, numbers, min_max, adds]) in CAGES {
        for tolerance in [0.0, f64::INFINITY] {
            let in_clip = tolerance == 0.0;
            let coordinates = if in_clip { 3 } else { 2 };
            // In clip space the box has the span of W alone, which is compared with the near plane.
            let spans = if in_clip { 1 } else { 2 };
            each_subdivided(&options(cage, tolerance), |name, setup, turn, c| {
                let bits = setup.format.bits();
                check_centre_and_order(setup, turn);
                assert_eq!(
                    turn.ops(Stage::VertexPool),
                    ops(&[
                        (OpClass::Add, bits + 1, coordinates * halvings),
                        (OpClass::Shift, bits + 1, coordinates * halvings),
                        (OpClass::Add, bits, coordinates * pool_adds),
                    ]),
                    "{name}, {cage:?}"
                );
                assert_eq!(
                    turn.ops(Stage::ChildBox),
                    ops(&[
                        (OpClass::Select, bits, 6 * c),
                        (OpClass::MinMax, bits, spans * min_max * c),
                        (OpClass::Add, bits, spans * adds * c),
                        (OpClass::Compare, bits, if in_clip { c } else { 0 }),
                    ]),
                    "{name}, {cage:?}, {c} children"
                );
                if in_clip {
                    check_clip_fit(name, setup, turn, [numbers, min_max, adds]);
                    return;
                }
                let tests = fit_tests(turn);
                assert!(tests >= c, "{name}: each child is tested once at least");
                assert_eq!(
                    sum(turn.children_s_fits()),
                    ops(&[
                        (OpClass::Compare, bits, 2 * 2 * tests),
                        (OpClass::Logic, 4, tests)
                    ]),
                    "{name}, {cage:?}"
                );
            });
        }
    }
}

/// Test by test: two compares an axis, one look at a fill vector, one and.
#[test]
fn the_fit_is_one_small_step_over_and_over() {
    each_subdivided(
        &options(CageKind::Corners, f64::INFINITY),
        |name, setup, turn, _| {
            let bits = setup.format.bits();
            let events = turn.children_s_fits();
            let steps = events.chunks_exact(6);
            assert_eq!(steps.remainder(), [], "{name}");
            for step in steps {
                assert_eq!(step[..4], [Event::Op(OpClass::Compare, bits); 4], "{name}");
                assert!(
                    matches!(step[4], Event::Read(Memory::FillVector, _)),
                    "{name}"
                );
                assert_eq!(step[5], Event::Op(OpClass::Logic, 4), "{name}");
            }
        },
    );
}

/// The fit in clip space, where a cage coordinate has `numbers` numbers and its span
/// takes `min_max` and `adds`.
fn check_clip_fit(name: &str, setup: &FrameSetup, turn: &Turn, [numbers, min_max, adds]: [u64; 3]) {
    let bits = setup.format.bits();
    let tests = fit_tests(turn);
    let found = sum(turn.children_s_fits());
    let shifts = found[&(OpClass::Shift, bits)];
    assert_eq!(
        found,
        ops(&[
            (OpClass::Shift, bits, shifts),
            (OpClass::Sub, bits, 2 * numbers * tests),
            (OpClass::MinMax, bits, 2 * min_max * tests),
            (OpClass::Add, bits, 2 * adds * tests),
            (OpClass::Compare, bits, 2 * 2 * tests),
            (OpClass::Logic, 4, tests)
        ]),
        "{name}"
    );
    // Beyond those of the tests, a cage coordinate's worth for each left half.
    let doubled = shifts - 2 * numbers * tests;
    assert_eq!(doubled % numbers, 0, "{name}");
    assert!(doubled <= 2 * numbers * tests, "{name}");
}

/// From within the object, where records lie behind the eye, across the near
/// plane and beyond the picture, and change to screen space one by one, the
/// stages before the children's boxes cost what they cost elsewhere.
#[test]
fn the_view_from_within_costs_the_same() {
    let walls = |[x, y, z]: [i32; 3]| x == 0 || y == 15 || z == 0;
    let graph = octree(4, &walls);
    let camera = camera([7.3, 5.1, 8.6], [2.0, 16.0, 3.0], 16);
    for (cage, [halvings, adds, ..]) in CAGES {
        let setup = setup(&graph, &camera, &options(cage, 0.25));
        let bits = setup.format.bits();
        let pool = |coordinates: u64| {
            ops(&[
                (OpClass::Add, bits + 1, coordinates * halvings),
                (OpClass::Shift, bits + 1, coordinates * halvings),
                (OpClass::Add, bits, coordinates * adds),
            ])
        };
        let (_, probe) = watch(&graph, &setup, ByRecord::default());
        let (mut in_clip, mut in_screen) = (0, 0);
        for turn in probe.turns.iter().filter(|turn| turn.is_subdivided()) {
            check_centre_and_order(&setup, turn);
            let children = turn.children(&graph);
            assert_eq!(turn.count(Stage::ChildBox, OpClass::Select), 6 * children);
            let found = turn.ops(Stage::VertexPool);
            if found == pool(3) {
                in_clip += 1;
            } else {
                assert_eq!(found, pool(2), "{cage:?}");
                in_screen += 1;
            }
        }
        assert!(
            in_clip > 100 && in_screen > 100,
            "{in_clip} and {in_screen}"
        );
    }
}

/// The one change to screen space, of the object's own record: with an
/// infinite tolerance it is the first and the only one, and takes one divide
/// for each vertex and coordinate that the cage has to project.
#[test]
fn only_the_change_to_screen_space_divides() {
    for (cage, vertices) in [(CageKind::Corners, 8), (CageKind::Frame, 4)] {
        for Scene {
            name,
            graph,
            camera,
        } in scenes()
        {
            let setup = setup(&graph, &camera, &options(cage, f64::INFINITY));
            let (_, probe) = watch(&graph, &setup, ByRecord::default());
            for turn in &probe.turns {
                for stage in Stage::ALL.into_iter().filter(|s| *s != Stage::ToScreen) {
                    assert_eq!(turn.count(stage, OpClass::DivideStep), 0, "{name}");
                }
            }
            assert_eq!(probe.before.count(Stage::ToScreen, OpClass::DivideStep), 0);
            // The object lies across the picture's bisectors, so that its node
            // is the root: 4 integer bits, a bit a level, and the fraction.
            let steps = 4 + setup.levels + setup.format.frac();
            let first = &probe.turns[0];
            let divides = first.count(Stage::ToScreen, OpClass::DivideStep);
            assert_eq!(divides, 2 * vertices * u64::from(steps), "{name}, {cage:?}");
            for turn in &probe.turns[1..] {
                assert_eq!(turn.ops(Stage::ToScreen), ops(&[]), "{name}, {cage:?}");
            }
        }
    }
}

/// With no tolerance the machine never changes, and never divides.
#[test]
fn clip_space_never_divides() {
    for cage in [CageKind::Corners, CageKind::Frame] {
        for coverage in [Coverage::Any, Coverage::Center, Coverage::Exact] {
            for scene in scenes() {
                let options = SetupOptions {
                    coverage,
                    ..options(cage, 0.0)
                };
                let setup = setup(&scene.graph, &scene.camera, &options);
                let (_, counter) = watch(&scene.graph, &setup, Counter::new());
                assert_eq!(counter.ops_of(OpClass::DivideStep), 0);
                assert_ne!(counter.ops_of(OpClass::Add), 0);
            }
        }
    }
}

/// Where records change one by one, divides stay in their stage.
#[test]
fn divides_stay_in_their_stage() {
    for coverage in [Coverage::Any, Coverage::Center] {
        for scene in scenes() {
            let options = SetupOptions {
                coverage,
                lod_px: 1.0,
                ..options(CageKind::Frame, 0.25)
            };
            let setup = setup(&scene.graph, &scene.camera, &options);
            let (_, counter) = watch(&scene.graph, &setup, Counter::new());
            assert_eq!(
                counter.ops_of(OpClass::DivideStep),
                counter.ops_at(Stage::ToScreen, OpClass::DivideStep),
                "{}",
                scene.name
            );
        }
    }
}

/// A graph with four of eight children costs half of what all eight do, and
/// one with one child an eighth, in the stage that is paid for by child.
#[test]
fn absent_children_cost_nothing() {
    let cost = |children: &[u8]| {
        let mut links = [None; 8];
        for &octant in children {
            links[octant as usize] = Some(0);
        }
        let graph = linked(1, &[links]);
        let camera = camera([6.0, 5.0, 4.0], [1.0, 1.0, 1.0], 16);
        let setup = setup(&graph, &camera, &options(CageKind::Corners, f64::INFINITY));
        let (_, probe) = watch(&graph, &setup, ByRecord::default());
        let object = &probe.turns[0];
        assert!(object.is_subdivided());
        let pushes = object
            .of(Stage::Push)
            .filter(|event| *event == Event::Write(Memory::Stack))
            .count();
        assert_eq!(pushes, children.len(), "all are seen");
        let boxes = object.count(Stage::ChildBox, OpClass::MinMax)
            + object.count(Stage::ChildBox, OpClass::Select);
        assert_eq!(boxes, children.len() as u64 * (6 + 28));
        assert_eq!(object.count(Stage::VertexPool, OpClass::Add), 38);
        object.count(Stage::QuadtreeFit, OpClass::Logic)
    };
    let all = cost(&[0, 1, 2, 3, 4, 5, 6, 7]);
    let each: u64 = (0..8).map(|octant| cost(&[octant])).sum();
    assert_eq!(all, each, "a child's fit does not depend on its siblings");
    assert!(cost(&[0, 3, 5, 6]) < all);
}

/// Every record that is pushed is popped, and has one turn.
#[test]
fn every_record_has_one_turn() {
    for cage in [CageKind::Corners, CageKind::Frame] {
        for scene in scenes() {
            let setup = setup(&scene.graph, &scene.camera, &options(cage, 0.25));
            let (_, counter) = watch(&scene.graph, &setup, Counter::new());
            assert_eq!(counter.reads(Memory::Stack), counter.records());
            assert_eq!(counter.writes(Memory::Stack), counter.records());
        }
    }
}

/// The image-order paper's box of a child takes 7 minima and 7 maxima a coordinate, or 10
/// compares when the eight vertices are taken in pairs; the frame cage has no
/// eight vertices to pair.
#[test]
fn ten_compares_in_pairs() {
    let pairs = Costing {
        min_max: MinMaxUnits::Pairs,
        ..Costing::default()
    };
    let at = |tallies: &[Tally], operation: &str, width| -> u64 {
        let of = tallies
            .iter()
            .filter(|t| t.operation == operation && t.width == width);
        of.map(|t| t.times).sum()
    };
    for tolerance in [0.0, f64::INFINITY] {
        for scene in scenes() {
            let setup = setup(
                &scene.graph,
                &scene.camera,
                &options(CageKind::Corners, tolerance),
            );
            let bits = setup.format.bits();
            let (_, counter) = watch(&scene.graph, &setup, Counter::new());
            let separate = tallies(&counter, Costing::default()).expect("tallies");
            let paired = tallies(&counter, pairs).expect("spans of eight values");
            let found = counter.sum(|cell| {
                let finds_spans = matches!(cell.stage, Stage::ChildBox | Stage::QuadtreeFit);
                finds_spans && cell.class == OpClass::MinMax
            });
            assert_eq!(found % 14, 0);
            let spans = found / 14;
            assert!(spans > 20, "{}", scene.name);
            let fewer = at(&separate, "min", bits) - at(&paired, "min", bits);
            assert_eq!(fewer, 14 * spans);
            let more = |operation| at(&paired, operation, bits) - at(&separate, operation, bits);
            assert_eq!((more("less"), more("select")), (10 * spans, 14 * spans));
        }
    }
    let frame = options(CageKind::Frame, f64::INFINITY);
    let refused = scenes().into_iter().filter(|scene| {
        let setup = setup(&scene.graph, &scene.camera, &frame);
        let (_, counter) = watch(&scene.graph, &setup, Counter::new());
        tallies(&counter, pairs).is_err()
    });
    assert!(refused.count() > 0);
}

/// The probe of the memories sees what the counter counts, and a stack that
/// ends empty.
#[test]
fn traffic_agrees_with_the_counts() {
    let widths = Widths {
        stack_bits: 1000,
        node_bits: 64,
        attribute_bits: 56,
        fill_vector_bits: 4,
        pixel_bits: 24,
    };
    for scene in scenes() {
        let setup = setup(
            &scene.graph,
            &scene.camera,
            &options(CageKind::Corners, f64::INFINITY),
        );
        let memory = MemoryProbe::new(widths).with_curve(Memory::Node, 64);
        let both = (Counter::new(), memory);
        let (_, (counter, memory)) = watch(&scene.graph, &setup, both);
        for kind in Memory::ALL {
            assert_eq!(memory.reads(kind), counter.reads(kind));
            assert_eq!(memory.writes(kind), counter.writes(kind));
        }
        let pushes: u64 = memory.stack_depths().iter().sum();
        assert_eq!(pushes, counter.records(), "{}", scene.name);
        // At each level seven siblings wait, at most, and one has its turn.
        let lowest = counter.records_by_level().map(|(level, _)| level).max();
        let most = 1 + 7 * u64::from(lowest.expect("records"));
        let deepest = memory.deepest_stack();
        assert!((8..=most).contains(&deepest) || scene.name == "one voxel");
        assert!(deepest <= most, "{}: {deepest} of {most}", scene.name);
        let curve = &memory.curves()[0].1;
        assert_eq!(curve.accesses(), counter.reads(Memory::Node));
        assert_eq!(curve.misses(1 << 20), curve.distinct_lines());
        assert!(memory.distinct(Memory::Node) <= scene.graph.len() as u64);
    }
}

/// Counter, this test's probe, and the frame's own statistics agree.
#[test]
fn counts_agree_and_change_nothing() {
    for coverage in [Coverage::Any, Coverage::Center, Coverage::Exact] {
        for cage in [CageKind::Corners, CageKind::Frame] {
            for tolerance in [0.0, 0.25, f64::INFINITY] {
                if tolerance != tolerance_of(coverage, tolerance) {
                    continue;
                }
                for scene in scenes() {
                    let options = SetupOptions {
                        coverage,
                        lod_px: 1.0,
                        ..options(cage, tolerance)
                    };
                    let camera = Camera {
                        width: 16,
                        height: 11,
                        ..scene.camera
                    };
                    let setup = setup(&scene.graph, &camera, &options);
                    compare_probes(&scene.graph, &setup);
                }
            }
        }
    }
}

fn compare_probes(graph: &Graph, setup: &FrameSetup) {
    let (frame, counter) = watch(graph, setup, Counter::new());
    let (unwatched, NoProbe) = watch(graph, setup, NoProbe);
    assert_eq!(frame.node, unwatched.node);
    assert_eq!(frame.voxel, unwatched.voxel);

    // The same machine again: nothing is left over from the frame before.
    let mut machine = Machine::new(MachineOptions::default());
    for _ in 0..2 {
        let mut again = Frame::new(setup.width, setup.height, false);
        let (stats, same) = machine
            .render_probed(&graph.view(), setup, &mut again, Counter::new())
            .expect("no overflow");
        assert_eq!(same, counter, "counts are the same in every run");
        assert_eq!(again.voxel, frame.voxel);
        assert_eq!(stat(&stats, "records"), counter.records());
        assert_eq!(stat(&stats, "samples_drawn"), counter.writes(Memory::Pixel));
    }

    let (_, log) = watch(graph, setup, ByRecord::default());
    assert_eq!(log.turns.len() as u64, counter.records());
    let mut by_hand: BTreeMap<(Stage, OpClass), u64> = BTreeMap::new();
    let mut cells: BTreeMap<(u32, u32, Stage, OpClass), u64> = BTreeMap::new();
    let mut reads: BTreeMap<Memory, u64> = BTreeMap::new();
    let mut writes: BTreeMap<Memory, u64> = BTreeMap::new();
    let mut widest = 0;
    for turn in log.turns.iter().chain([&log.before]) {
        for &(stage, event) in &turn.events {
            match event {
                Event::Op(class, bits) => {
                    *by_hand.entry((stage, class)).or_default() += 1;
                    *cells.entry((bits, turn.level, stage, class)).or_default() += 1;
                    widest = widest.max(bits);
                }
                Event::Read(memory, _) => *reads.entry(memory).or_default() += 1,
                Event::Write(memory) => *writes.entry(memory).or_default() += 1,
            }
        }
    }
    let counted = counter
        .cells()
        .map(|cell| ((cell.bits, cell.level, cell.stage, cell.class), cell.times));
    assert!(counted.eq(cells), "by width, level, stage and class");
    let mut levels: BTreeMap<u32, u64> = BTreeMap::new();
    for turn in &log.turns {
        *levels.entry(turn.level).or_default() += 1;
    }
    assert!(counter.records_by_level().eq(levels));
    let none = 0;
    for stage in Stage::ALL {
        for class in OpClass::ALL {
            let expected = by_hand.get(&(stage, class)).unwrap_or(&none);
            assert_eq!(counter.ops_at(stage, class), *expected);
        }
    }
    for memory in Memory::ALL {
        assert_eq!(counter.reads(memory), *reads.get(&memory).unwrap_or(&none));
        assert_eq!(
            counter.writes(memory),
            *writes.get(&memory).unwrap_or(&none)
        );
    }
    assert_eq!(counter.ops(), by_hand.values().sum::<u64>());
    assert_eq!(counter.widest(), widest);
}
