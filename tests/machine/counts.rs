//! The cost of subdivided records, by stage: under the rule `any`, for boxes inside the picture. Coordinates are x and
//! y in screen space, and X, Y, W in clip space, where the child box finds the span of W alone, and the fit the others.

use std::collections::BTreeMap;

use crate::common::*;
use hwmodel::count::Counter;
use hwmodel::{Memory, OpClass, Probe, Stage, StageLevel};
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::Machine;
use shiftvox::project::{CageKind, Camera, Coverage, FrameSetup, SetupOptions};

/// Counts from the first record on: before it is the object's own fit.
#[derive(Default)]
struct Records(Option<Counter>);

impl Probe for Records {
    fn op(&mut self, class: OpClass, bits: u32, place: StageLevel, times: u32) {
        if let Some(counter) = &mut self.0 {
            counter.op(class, bits, place, times);
        }
    }
    fn record(&mut self, index: u64, level: u32) {
        self.0.get_or_insert_default().record(index, level);
    }
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
fn subdivided_records_cost_what_their_steps_do() {
    use OpClass::{Add, Compare, DivideStep, Logic, MinMax, Select, Shift, Sub};
    for (cage, [halvings, pool_adds, numbers, min_max, adds, vertices]) in CAGES {
        for (at, (graph, camera)) in scenes().into_iter().cycle().take(8).enumerate() {
            let in_clip = at < 4;
            let tolerance = if in_clip { 0.0 } else { f64::INFINITY };
            let setup = setup(&graph, &camera, &options(cage, tolerance));
            let Records(counter) = watch(&graph, &setup, Records::default());
            let counter = counter.expect("records");
            let (_, stats) = draw(&graph, &setup);
            let subdivided = stat(&stats, "subdivided");
            assert!(subdivided >= 10);
            let children = 8 * subdivided - stat(&stats, "absent_children");
            let bits = setup.format.bits();
            let coordinates = if in_clip { 3 } else { 2 } * subdivided;
            let spans = if in_clip { 1 } else { 2 } * children;
            // Each test of the fit takes four compares.
            let tests = counter.ops_at(Stage::QuadtreeFit, Compare) / 4;
            let shifts = counter.ops_at(Stage::QuadtreeFit, Shift);
            assert!(tests >= children, "each child is tested once at least");
            let in_fit = if in_clip { tests } else { 0 };
            // Beyond those of the tests, a cage coordinate's worth for each left half.
            let doubled = shifts - 2 * numbers * in_fit;
            assert!(doubled % numbers == 0 && doubled <= 2 * numbers * in_fit);
            // Only the object's record is divided, whose node is the root: 4 integer bits, a bit per level, the
            // fraction.
            let steps = 2 * vertices * u64::from(4 + setup.levels + setup.format.frac());
            let mut expected = BTreeMap::new();
            for (stage, class, bits, times) in [
                (Stage::Filled, Logic, 4, stat(&stats, "records")),
                (Stage::Centre, Add, bits + 1, 3 * subdivided),
                (Stage::Centre, Shift, bits + 1, 3 * subdivided),
                (Stage::Order, Compare, bits, 3 * subdivided),
                (Stage::Order, Logic, 3, 8 * subdivided),
                (Stage::VertexPool, Add, bits + 1, coordinates * halvings),
                (Stage::VertexPool, Shift, bits + 1, coordinates * halvings),
                (Stage::VertexPool, Add, bits, coordinates * pool_adds),
                (Stage::ChildBox, Select, bits, 6 * children),
                (Stage::ChildBox, MinMax, bits, spans * min_max),
                (Stage::ChildBox, Add, bits, spans * adds),
                (
                    Stage::ChildBox,
                    Compare,
                    bits,
                    if in_clip { children } else { 0 },
                ),
                (Stage::QuadtreeFit, Compare, bits, 4 * tests),
                (Stage::QuadtreeFit, Logic, 4, tests),
                (Stage::QuadtreeFit, Shift, bits, shifts),
                (Stage::QuadtreeFit, Sub, bits, 2 * numbers * in_fit),
                (Stage::QuadtreeFit, MinMax, bits, 2 * min_max * in_fit),
                (Stage::QuadtreeFit, Add, bits, 2 * adds * in_fit),
            ] {
                *expected.entry((stage, class, bits)).or_default() += times;
            }
            expected.retain(|_, times| *times > 0);
            let mut found: BTreeMap<_, u64> = BTreeMap::new();
            for cell in counter.cells() {
                *found
                    .entry((cell.stage, cell.class, cell.bits))
                    .or_default() += cell.times;
            }
            let others = [
                Stage::ToScreen,
                Stage::OnePixel,
                Stage::Draw,
                Stage::FillUpdate,
            ];
            found.retain(|(stage, ..), _| !others.contains(stage));
            assert_eq!(found, expected, "{cage:?}");
            let divides = counter.ops_at(Stage::ToScreen, DivideStep);
            assert_eq!(divides, if in_clip { 0 } else { steps });
            assert_eq!(counter.ops_of(DivideStep), divides);
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
