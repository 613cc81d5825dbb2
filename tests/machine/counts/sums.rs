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
