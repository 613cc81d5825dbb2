//! The cost of a record, by stage. `c` is the number of its children, `t` of quadtree nodes against whose bisectors their
//! boxes are tested.
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
//! In screen space coordinates are x and y. In clip space they are X, Y, W. The child box finds the span of W alone, and
//! compares it once with the near plane. Every test of the fit takes per coordinate:
//!
//! | | corners | frame |
//! |---|---|---|
//! | doubled less the width | 8 shifts, 8 subtractions | 4 shifts, 4 subtractions |
//! | span | 14 min/max | 6 min/max, 6 adds |
//! | side | 2 compares | the same |
//!
//! If the child lies in the left (upper) half, its coordinates are doubled once more. All of that is under the rule `any`,
//! for boxes inside the picture.

use std::collections::BTreeMap;

use crate::common::*;
use hwmodel::count::Counter;
use hwmodel::{Memory, OpClass, Probe, Stage, StageLevel};
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::Machine;
use shiftvox::project::{CageKind, Camera, Coverage, FrameSetup, SetupOptions};

/// Operations by class and width.
type Ops = BTreeMap<(OpClass, u32), u64>;

/// The turn of one record.
#[derive(Debug, Default)]
struct Turn {
    level: u32,
    ops: BTreeMap<Stage, Ops>,
    /// Without those before the children are made.
    fit: Ops,
    fit_tests: u64,
    node: Option<u32>,
}

impl Turn {
    fn ops(&self, stage: Stage) -> Ops {
        self.ops.get(&stage).cloned().unwrap_or_default()
    }

    fn is_subdivided(&self) -> bool {
        self.ops.contains_key(&Stage::Centre)
    }

    /// Children that exist: all of a solid's, else those of the node's mask.
    fn children(&self, graph: &Graph) -> u64 {
        match self.node.map(|node| graph.view().mask(node)) {
            Some(mask) if mask != 0 && self.level < graph.depth => u64::from(mask.count_ones()),
            _ => 8,
        }
    }
}

/// Keeps records apart. The first entry is before all records.
#[derive(Debug)]
struct ByRecord(Vec<Turn>);

impl Probe for ByRecord {
    fn op(&mut self, class: OpClass, bits: u32, place: StageLevel, times: u32) {
        let is_first = self.0.len() == 1;
        let turn = self.0.last_mut().unwrap();
        assert!(is_first || place.level == turn.level);
        let mut kinds = vec![turn.ops.entry(place.stage).or_default()];
        if place.stage == Stage::QuadtreeFit {
            kinds.push(&mut turn.fit);
        } else if place.stage == Stage::Centre {
            turn.fit.clear();
            turn.fit_tests = 0;
        }
        for ops in kinds {
            *ops.entry((class, bits)).or_default() += u64::from(times);
        }
    }
    fn read(&mut self, memory: Memory, address: u64, place: StageLevel) {
        let turn = self.0.last_mut().unwrap();
        match (memory, place.stage) {
            (Memory::Node, Stage::OnePixel) => turn.node = Some(address as u32),
            (Memory::FillVector, Stage::QuadtreeFit) => turn.fit_tests += 1,
            _ => {}
        }
    }
    fn write(&mut self, _: Memory, _: u64, _: StageLevel) {}
    fn record(&mut self, index: u64, level: u32) {
        assert_eq!(index + 1, self.0.len() as u64);
        self.0.push(Turn {
            level,
            ..Turn::default()
        });
    }
}

/// Expected operations; classes of which there are none are left out.
fn ops(list: &[(OpClass, u32, u64)]) -> Ops {
    let mut ops = Ops::new();
    for &(class, bits, times) in list {
        *ops.entry((class, bits)).or_default() += times;
    }
    ops.retain(|_, times| *times > 0);
    ops
}

/// The image-order paper's settings, but for the cage and the tolerance.
fn options(cage: CageKind, tolerance_px: f64) -> SetupOptions {
    SetupOptions {
        bits: 48,
        cage,
        tolerance_px,
        lod_px: 0.0,
        ..SetupOptions::paper()
    }
}

fn watch<P: Probe>(graph: &Graph, setup: &FrameSetup, probe: P) -> P {
    let mut frame = Frame::new(setup.width, setup.height, false);
    let drawn = Machine::default().render_probed(&graph.view(), setup, &mut frame, probe);
    drawn.expect("no overflow").1
}

/// All children, half of them, and few of them; seen askew and straight on.
fn scenes() -> [(Graph, Camera); 4] {
    let diagonal = |[x, y, z]: [i32; 3]| (x + y + z) % 4 == 0;
    [
        (solid(2), [13.0, 9.0, 11.0], 32),
        (sierpinski(3), [-9.0, 16.0, 21.0], 32),
        (octree(3, &diagonal), [4.0, 4.0, 30.0], 64),
        (octree(3, &|at| at == [5, 2, 7]), [30.0, -5.0, 8.0], 64),
    ]
    .map(|(graph, eye, size)| {
        let middle = f64::from(1u32 << graph.depth) / 2.0;
        let camera = camera(eye, [middle; 3], size);
        (graph, camera)
    })
}

/// The cost of a cage coordinate: halvings and additions of the vertex pool, numbers held, minima, maxima and additions
/// of a span, vertices that are divided.
const CAGES: [(CageKind, [u64; 6]); 2] = [
    (CageKind::Corners, [19, 0, 8, 7 + 7, 0, 8]),
    (CageKind::Frame, [3, 7, 4, 3 + 3, 6, 4]),
];

#[test]
fn a_subdivided_record_costs_what_the_table_says() {
    use OpClass::{Add, Compare, DivideStep, Logic, MinMax, Select, Shift, Sub};
    for (cage, [halvings, pool_adds, numbers, min_max, adds, vertices]) in CAGES {
        for ((graph, camera), in_clip) in scenes()
            .into_iter()
            .flat_map(|scene| [false, true].map(|in_clip| (scene.clone(), in_clip)))
        {
            let tolerance = if in_clip { 0.0 } else { f64::INFINITY };
            let setup = setup(&graph, &camera, &options(cage, tolerance));
            let bits = setup.format.bits();
            let ByRecord(turns) = watch(&graph, &setup, ByRecord(vec![Turn::default()]));
            // Only the object's record is divided, whose node is the root: 4 integer bits, a bit per level, the fraction.
            let steps = u64::from(4 + setup.levels + setup.format.frac());
            for (number, turn) in turns.iter().enumerate() {
                for (stage, ops) in &turn.ops {
                    let of_class = ops.iter().filter(|((class, _), _)| *class == DivideStep);
                    let divides: u64 = of_class.map(|(_, times)| times).sum();
                    let is_here = !in_clip && number == 1 && *stage == Stage::ToScreen;
                    assert_eq!(divides, u64::from(is_here) * 2 * vertices * steps);
                }
                assert!(in_clip || number == 1 || turn.ops(Stage::ToScreen).is_empty());
            }
            let subdivided: Vec<_> = turns.iter().filter(|t| t.is_subdivided()).collect();
            assert!(subdivided.len() >= 10);
            for turn in subdivided {
                let (c, tests) = (turn.children(&graph), turn.fit_tests);
                let coordinates = if in_clip { 3 } else { 2 };
                let spans = if in_clip { 1 } else { 2 };
                for (stage, expected) in [
                    (Stage::Pop, ops(&[])),
                    (Stage::Filled, ops(&[(Logic, 4, 1)])),
                    (
                        Stage::Centre,
                        ops(&[(Add, bits + 1, 3), (Shift, bits + 1, 3)]),
                    ),
                    (Stage::Order, ops(&[(Compare, bits, 3), (Logic, 3, 8)])),
                    (
                        Stage::VertexPool,
                        ops(&[
                            (Add, bits + 1, coordinates * halvings),
                            (Shift, bits + 1, coordinates * halvings),
                            (Add, bits, coordinates * pool_adds),
                        ]),
                    ),
                    (
                        Stage::ChildBox,
                        ops(&[
                            (Select, bits, 6 * c),
                            (MinMax, bits, spans * min_max * c),
                            (Add, bits, spans * adds * c),
                            (Compare, bits, if in_clip { c } else { 0 }),
                        ]),
                    ),
                    (Stage::Push, ops(&[])),
                ] {
                    assert_eq!(turn.ops(stage), expected, "{stage:?}, {cage:?}");
                }
                assert!(tests >= c, "each child is tested once at least");
                let mut fit = vec![(Compare, bits, 2 * 2 * tests), (Logic, 4, tests)];
                if in_clip {
                    let shifts = turn.fit[&(Shift, bits)];
                    fit.extend([
                        (Shift, bits, shifts),
                        (Sub, bits, 2 * numbers * tests),
                        (MinMax, bits, 2 * min_max * tests),
                        (Add, bits, 2 * adds * tests),
                    ]);
                    // Beyond those of the tests, a cage coordinate's worth for each left half.
                    let doubled = shifts - 2 * numbers * tests;
                    assert!(doubled % numbers == 0 && doubled <= 2 * numbers * tests);
                }
                assert_eq!(turn.fit, ops(&fit), "{cage:?}");
            }
        }
    }
}

/// Divides stay in their stage; each record is pushed and popped once, and statistics are those of a counter.
#[test]
fn counts_agree() {
    use Coverage::{Any, Center, Exact};
    for (coverage, tolerance_px) in [
        (Any, 0.0),
        (Center, 0.0),
        (Exact, 0.0),
        (Any, 0.25),
        (Center, 0.25),
    ] {
        for (graph, camera) in scenes() {
            for cage in [CageKind::Corners, CageKind::Frame] {
                let options = SetupOptions {
                    coverage,
                    lod_px: 1.0,
                    ..options(cage, tolerance_px)
                };
                let setup = setup(&graph, &camera, &options);
                let counter = watch(&graph, &setup, Counter::new());
                let divides = counter.ops_of(OpClass::DivideStep);
                assert_eq!(
                    divides,
                    counter.ops_at(Stage::ToScreen, OpClass::DivideStep)
                );
                assert_eq!(divides > 0, tolerance_px > 0.0);
                let (_, stats) = draw(&graph, &setup);
                let records = counter.records();
                assert_eq!(counter.reads(Memory::Stack), records);
                assert_eq!(counter.writes(Memory::Stack), records);
                assert_eq!(stat(&stats, "records"), records);
                assert_eq!(stat(&stats, "samples_drawn"), counter.writes(Memory::Pixel));
                // At each level seven siblings wait, at most, and one has its turn.
                assert!(stat(&stats, "deepest_stack") <= 1 + 7 * u64::from(setup.level_bound()));
            }
        }
    }
}
