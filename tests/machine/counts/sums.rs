//! All counts together: probes that see the same frame agree.

use super::*;

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

/// The image-order paper's box of a child takes 7 minima and 7 maxima per coordinate, or 10 compares when the eight
/// vertices are taken in pairs. The frame cage has no eight vertices to pair.
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

/// At each level seven siblings wait, at most, and one has its turn. Every record is pushed.
#[test]
fn the_stack_is_as_deep_as_its_levels() {
    let widths = Widths {
        stack_bits: 1000,
        node_bits: 64,
        attribute_bits: 56,
        fill_vector_bits: 4,
        pixel_bits: 24,
    };
    for scene in scenes() {
        let options = options(CageKind::Corners, f64::INFINITY);
        let setup = setup(&scene.graph, &scene.camera, &options);
        let both = (Counter::new(), MemoryProbe::new(widths));
        let (_, (counter, memory)) = watch(&scene.graph, &setup, both);
        let lowest = counter.records_by_level().map(|(level, _)| level).max();
        let most = 1 + 7 * u64::from(lowest.expect("records"));
        let deepest = memory.deepest_stack();
        assert!((8..=most).contains(&deepest) || scene.name == "one voxel");
        assert!(deepest <= most, "{}: {deepest} of {most}", scene.name);
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

    // The counter adds up what a probe of single events sees.
    let (_, log) = watch(graph, setup, ByRecord::default());
    let mut cells: BTreeMap<(u32, u32, Stage, OpClass), u64> = BTreeMap::new();
    for turn in log.turns.iter().chain([&log.before]) {
        for &(stage, event) in &turn.events {
            if let Event::Op(class, bits) = event {
                *cells.entry((bits, turn.level, stage, class)).or_default() += 1;
            }
        }
    }
    let counted = counter
        .cells()
        .map(|cell| ((cell.bits, cell.level, cell.stage, cell.class), cell.times));
    assert!(counted.eq(cells), "by width, level, stage and class");
    assert_eq!(log.turns.len() as u64, counter.records());
}
