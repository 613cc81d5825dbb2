//! Statistics, counters and the simulator agree. Each setting of an organisation saves reads and writes.

use std::collections::BTreeMap;

use hwmodel::count::Counter;
use hwmodel::cycles::{Hardware, Independence, NoObserver, Organisation, StackHolds};
use hwmodel::{Memory, OpClass, Operand, Probe, Stage, StageLevel};
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::{Machine, MachineOptions, RecordStage};
use shiftvox::project::{CageKind, Camera, Coverage, FrameSetup, SetupOptions, Stats};

use crate::common::*;
use crate::scenes::*;

/// Operations by stage that wait for a unit: all but those of control.
#[derive(Default)]
struct Issued(BTreeMap<Stage, u64>);

impl Probe for Issued {
    fn op(&mut self, _: OpClass, _: u32, place: StageLevel, times: u32) {
        *self.0.entry(place.stage).or_default() += u64::from(times);
    }

    fn op_on(&mut self, operand: Operand, class: OpClass, bits: u32, place: StageLevel) {
        if operand != Operand::Control {
            self.op(class, bits, place, 1);
        }
    }
}

fn count(
    graph: &Graph,
    setup: &FrameSetup,
    organisation: Organisation,
) -> (Stats, (Counter, Issued)) {
    let mut machine = Machine::new(MachineOptions {
        organisation,
        ..MachineOptions::default()
    });
    let mut frame = Frame::new(setup.width, setup.height, false);
    let drawn = machine.render_probed(&graph.view(), setup, &mut frame, Default::default());
    drawn.expect("no overflow")
}

/// Each record is pushed and popped once, and statistics and the simulator's counts are those of a counter.
fn agree(graph: &Graph, camera: &Camera, options: &SetupOptions) {
    let setup = setup(graph, camera, options);
    let (stats, (counter, issued)) = count(graph, &setup, Organisation::default());
    let divides = counter.ops_at(RecordStage::ToScreen, OpClass::DivideStep);
    assert_eq!(counter.ops_of(OpClass::DivideStep), divides);
    assert_eq!(divides > 0, options.tolerance_px > 0.0);
    let (reads, writes) = (|of| counter.reads(of), |of| counter.writes(of));
    let records = counter.records();
    let [stack, pixels] = [Memory::Stack, Memory::Pixel].map(writes);
    assert_eq!([reads(Memory::Stack), stack], [records; 2]);
    let counted = ["records", "samples_drawn"].map(|name| stat(&stats, name));
    assert_eq!(counted, [records, pixels]);
    // At each level seven siblings wait, at most, and one has its turn.
    assert!(stat(&stats, "deepest_stack") <= 1 + 7 * u64::from(setup.level_bound()));

    let mut hardware = Hardware::preset("wide").unwrap();
    hardware.independence = Independence::Image;
    let mut frame = Frame::new(setup.width, setup.height, false);
    let view = graph.view();
    let simulated =
        Machine::default().simulate(&view, &setup, &mut frame, &hardware, &mut NoObserver);
    let report = simulated.unwrap().cycles;
    let stages = report.stages.iter().filter(|of| of.operations > 0);
    let operations = stages.map(|of| (of.stage, of.operations)).collect();
    assert_eq!(issued.0, operations);
    // Each record compares its level at least once.
    assert!(counter.ops() >= issued.0.values().sum::<u64>() + records);
    let read = [
        report.fill_reads,
        report.node_cache.accesses,
        report.attribute_cache.accesses,
    ];
    let memories = [Memory::FillVector, Memory::Node, Memory::Attribute];
    assert_eq!(read, memories.map(reads));
    assert_eq!(
        [report.fill_writes, report.pixels],
        [writes(Memory::FillVector), pixels]
    );
    assert_eq!(report.records, records);
}

/// All children, half of them, and few of them; seen askew and straight on.
#[test]
fn counts_agree() {
    use Coverage::{Any, Center, Exact};
    let diagonal = |[x, y, z]: [i32; 3]| (x + y + z) % 4 == 0;
    let alone = |at: [i32; 3]| at == [5, 2, 7];
    let rules = [
        (Any, 0.0),
        (Center, 0.0),
        (Exact, 0.0),
        (Any, 0.25),
        (Center, 0.25),
    ];
    for (graph, eye, size) in [
        (solid(2), [13.0, 9.0, 11.0], 32),
        (sierpinski(3), [-9.0, 16.0, 21.0], 32),
        (octree(3, &diagonal), [4.0, 4.0, 30.0], 64),
        (octree(3, &alone), [30.0, -5.0, 8.0], 64),
    ] {
        let middle = f64::from(1u32 << graph.depth) / 2.0;
        let camera = camera(eye, [middle; 3], size);
        for (coverage, tolerance_px) in rules {
            for cage in [CageKind::Corners, CageKind::Frame] {
                let options = SetupOptions {
                    bits: 48,
                    cage,
                    tolerance_px,
                    lod_px: 1.0,
                    ..SetupOptions::of(coverage)
                };
                agree(&graph, &camera, &options);
            }
        }
    }
}

/// Per setting: records, subdivided ones, most entries of the stack. Then reads and writes of the stack, of nodes, of
/// fill vectors.
#[test]
fn each_setting_saves_reads_and_writes() {
    let graph = graph_of("gen:terrain,depth=7");
    let camera = camera_at(CameraPlace::Outside, &graph, (128, 128), &mut Dice::new(3));
    let setup = setup(&graph, &camera, &SetupOptions::default());
    let mut organisation = Organisation::default();
    let mut next = |change: fn(&mut Organisation)| {
        change(&mut organisation);
        let (stats, (counter, _)) = count(&graph, &setup, organisation);
        let counts = ["records", "subdivided", "deepest_stack"].map(|name| stat(&stats, name));
        let accesses = [Memory::Stack, Memory::Node, Memory::FillVector]
            .map(|memory| (counter.reads(memory), counter.writes(memory)));
        (counts, accesses)
    };
    let found = [
        next(|_| {}),
        next(|all| (all.stack, all.leaf_masks) = (StackHolds::Parents, true)),
        next(|all| all.stack = StackHolds::Path),
        next(|all| all.hidden_unread = true),
        next(|all| all.bricks = true),
        next(|all| (all.bricks, all.joined_fill) = (false, true)),
        next(|all| all.tile_levels = 2),
        next(|all| all.stack = StackHolds::Children),
    ];
    let parents = ([4872, 1957, 6], [(1685, 1685), (1957, 0), (63125, 50840)]);
    let expected = [
        ([4924, 1959, 38], [(4924, 4924), (4879, 0), (66442, 50840)]),
        parents,
        // The same, of fewer bits.
        parents,
        ([2831, 776, 6], [(749, 749), (776, 0), (58624, 50840)]),
        ([2831, 776, 6], [(749, 749), (408, 0), (58624, 50840)]),
        ([2831, 776, 6], [(749, 749), (776, 0), (20781, 14822)]),
        ([3505, 1103, 6], [(1059, 1059), (1103, 0), (24612, 14858)]),
        ([3660, 1103, 33], [(3660, 3660), (1103, 0), (27342, 14858)]),
    ];
    assert_eq!(found, expected);
}
