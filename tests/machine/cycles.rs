//! The machine on simulated hardware: its counts, what lanes save, its observers, its errors.
//! (`differential.rs` compares its frames.)

use crate::common::*;
use crate::scenes;
use hwmodel::count::Counter;
use hwmodel::cycles::{Child, Hardware, ImageNode, Independence, NoObserver, Progress, Recorder};
use hwmodel::{Memory, OpClass, Stage};
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::{Machine, OCCLUSION_ORDER, Simulated};
use shiftvox::project::{Coverage, Engine, FrameSetup, SetupOptions};

fn simulated(graph: &Graph, setup: &FrameSetup, hardware: &Hardware) -> (Frame, Simulated) {
    let mut frame = Frame::new(setup.width, setup.height, false);
    let simulated = Machine::default()
        .simulate(&graph.view(), setup, &mut frame, hardware, &mut NoObserver)
        .expect("what the machine draws");
    (frame, simulated)
}

/// The classes hold no two children of which one may hide the other: none
/// whose octant has all bits of the other's (`order.rs` proves that rule).
#[test]
fn cycles_classes_are_independent_by_geometry() {
    let child = |place: usize| Child {
        item: 0,
        place: place as u8,
        image_node: ImageNode::default(),
    };
    let mut allowed = 0;
    for later in 0..8 {
        for earlier in 0..later {
            let may_hide =
                OCCLUSION_ORDER[earlier] & OCCLUSION_ORDER[later] == OCCLUSION_ORDER[later];
            let allows = Independence::Classes.allows(&child(earlier), &child(later));
            assert!(!(may_hide && allows), "places {earlier} and {later}");
            allowed += u32::from(allows);
        }
    }
    // Three pairs in each class of three.
    assert_eq!(allowed, 6);
}

fn terrain(settings: &SetupOptions, size: u32) -> (Graph, FrameSetup) {
    let graph = scenes::graph_of_spec("gen:terrain,depth=6,seed=3");
    let camera = camera([102.0, -45.0, 80.0], [32.0, 32.0, 19.0], size);
    let setup = setup(&graph, &camera, settings);
    (graph, setup)
}

/// The simulator sees every operation and access that a counter sees.
#[test]
fn cycles_count_what_a_counter_counts() {
    for coverage in [Coverage::Any, Coverage::Center, Coverage::Exact] {
        let settings = SetupOptions::of(coverage);
        let (graph, setup) = terrain(&settings, 96);
        let mut frame = Frame::new(96, 96, false);
        let (_, counter) = Machine::default()
            .render_probed(&graph.view(), &setup, &mut frame, Counter::new())
            .expect("a frame");
        let mut hardware = Hardware::preset("wide").unwrap();
        hardware.independence = Independence::Image;
        let report = simulated(&graph, &setup, &hardware).1.cycles;
        for stage in Stage::ALL {
            let counted: u64 = OpClass::ALL
                .iter()
                .map(|&class| counter.ops_at(stage, class))
                .sum();
            // As the stages' numbers say: which record climbs to a full node's
            // parent may differ, how often it is done does not.
            assert_eq!(
                report.stages[stage as usize].operations, counted,
                "{stage:?}"
            );
        }
        assert_eq!(report.fill_reads, counter.reads(Memory::FillVector));
        assert_eq!(report.fill_writes, counter.writes(Memory::FillVector));
        assert_eq!(report.pixels, counter.writes(Memory::Pixel));
        assert_eq!(report.node_cache.accesses, counter.reads(Memory::Node));
        assert_eq!(
            report.attribute_cache.accesses,
            counter.reads(Memory::Attribute)
        );
        assert_eq!(report.records, counter.records());
    }
}

/// More lanes save cycles down to the span.
#[test]
fn cycles_fall_with_lanes_down_to_the_span() {
    let (graph, setup) = terrain(&SetupOptions::default(), 128);
    let hardware = Hardware::preset("wide").unwrap();
    let cycles = [1, 4, 64].map(|lanes| {
        let hardware = Hardware {
            lanes,
            ..hardware.clone()
        };
        let report = simulated(&graph, &setup, &hardware).1.cycles;
        assert!(report.cycles >= report.span);
        report.cycles
    });
    assert!(cycles[0] as f64 > 1.1 * cycles[1] as f64, "{cycles:?}");
    assert!(cycles[2] <= cycles[1], "{cycles:?}");
    let serial = Hardware {
        independence: Independence::None,
        ..hardware
    };
    let report = simulated(&graph, &setup, &serial).1.cycles;
    // One record at a time: all that is worked on is one chain.
    assert_eq!((report.work, report.parallelism), (report.span, 1.0));
    assert!(report.cycles > cycles[0]);
}

#[test]
fn cycles_are_watched_without_being_changed() {
    let (graph, setup) = terrain(&SetupOptions::default(), 64);
    let hardware = Hardware::preset("paper").unwrap();
    let (unwatched, expected) = simulated(&graph, &setup, &hardware);
    let mut frame = Frame::new(64, 64, false);
    let mut last = (0, 0);
    let mut observer = (
        Recorder::new(u64::MAX),
        Progress(|cycles, records| last = (cycles, records)),
    );
    let watched = Machine::default()
        .simulate(&graph.view(), &setup, &mut frame, &hardware, &mut observer)
        .expect("a frame");
    assert_eq!((watched, frame), (expected.clone(), unwatched));
    assert!(!observer.0.visits().is_empty());
    assert!(last.1 <= expected.cycles.records);
    let json = serde_json::to_value(&expected).expect("a report");
    assert_eq!(json["cycles"]["version"], 1);
    assert_eq!(json["cycles"]["stages"][0]["stage"], "pop");
}

/// An overflow ends a simulation as it ends a frame.
#[test]
fn cycles_end_with_the_machines_own_error() {
    let graph = scenes::graph_of_spec("gen:terrain,depth=6,seed=3");
    let settings = SetupOptions {
        bits: 24,
        frac: Some(15),
        ..SetupOptions::default()
    };
    let camera = camera([102.0, -45.0, 80.0], [32.0, 32.0, 19.0], 256);
    let setup = setup(&graph, &camera, &settings);
    let mut frame = Frame::new(256, 256, false);
    let right = Machine::default().render(&graph.view(), &setup, &mut frame);
    let right = right.expect_err("an overflow");
    let mut hardware = Hardware::preset("tiny").unwrap();
    hardware.independence = Independence::None;
    let found = Machine::default()
        .simulate(
            &graph.view(),
            &setup,
            &mut frame,
            &hardware,
            &mut NoObserver,
        )
        .expect_err("an overflow");
    assert_eq!(found.to_string(), right.to_string());
}
