//! The machine on simulated hardware: its counts, what lanes save, its errors.
//! (`differential.rs` compares its frames.)

use crate::common::*;
use crate::scenes;
use hwmodel::count::Counter;
use hwmodel::cycles::{Hardware, Independence, NoObserver};
use hwmodel::{Memory, OpClass, Stage};
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::{Machine, SimulateError, Simulated};
use shiftvox::project::{Coverage, Engine, FrameSetup, SetupOptions};

fn simulated(
    (graph, setup): &(Graph, FrameSetup),
    hardware: &Hardware,
) -> Result<Simulated, SimulateError> {
    let mut frame = Frame::new(setup.width, setup.height, false);
    Machine::default().simulate(&graph.view(), setup, &mut frame, hardware, &mut NoObserver)
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
        let scene = terrain(&SetupOptions::of(coverage), 96);
        let mut frame = Frame::new(96, 96, false);
        let (_, counter) = Machine::default()
            .render_probed(&scene.0.view(), &scene.1, &mut frame, Counter::new())
            .expect("a frame");
        let mut hardware = Hardware::preset("wide").unwrap();
        hardware.independence = Independence::Image;
        let report = simulated(&scene, &hardware).unwrap();
        let report = report.cycles;
        for stage in Stage::ALL {
            let counted = OpClass::ALL.map(|class| counter.ops_at(stage, class));
            let operations = report.stages[stage as usize].operations;
            assert_eq!(operations, counted.iter().sum::<u64>(), "{stage:?}");
        }
        let reads = [
            (report.fill_reads, Memory::FillVector),
            (report.node_cache.accesses, Memory::Node),
            (report.attribute_cache.accesses, Memory::Attribute),
        ];
        for (found, memory) in reads {
            assert_eq!(found, counter.reads(memory), "{memory:?}");
        }
        assert_eq!(report.fill_writes, counter.writes(Memory::FillVector));
        assert_eq!(report.pixels, counter.writes(Memory::Pixel));
        assert_eq!(report.records, counter.records());
    }
}

/// More lanes save cycles down to the span.
#[test]
fn cycles_fall_with_lanes_down_to_the_span() {
    let scene = terrain(&SetupOptions::default(), 128);
    let mut hardware = Hardware::preset("wide").unwrap();
    let mut report = |lanes: u32, independence: Independence| {
        (hardware.lanes, hardware.independence) = (lanes, independence);
        let report = simulated(&scene, &hardware);
        report.unwrap().cycles
    };
    let usual = Hardware::preset("wide").unwrap();
    let reports = [1, 4, 64].map(|lanes| report(lanes, usual.independence));
    assert!(reports.iter().all(|report| report.cycles >= report.span));
    let cycles = reports.map(|report| report.cycles);
    assert!(cycles[0] as f64 > 1.1 * cycles[1] as f64, "{cycles:?}");
    assert!(cycles[2] <= cycles[1], "{cycles:?}");
    let serial = report(usual.lanes, Independence::None);
    // One record at a time: all work is one chain.
    assert_eq!((serial.work, serial.parallelism), (serial.span, 1.0));
    assert!(serial.cycles > cycles[0]);
}

/// An overflow ends a simulation as it ends a frame.
#[test]
fn cycles_end_with_the_machines_own_error() {
    let settings = SetupOptions {
        bits: 24,
        frac: Some(15),
        ..SetupOptions::default()
    };
    let scene = terrain(&settings, 256);
    let mut frame = Frame::new(256, 256, false);
    let right = Machine::default().render(&scene.0.view(), &scene.1, &mut frame);
    let mut hardware = Hardware::preset("tiny").unwrap();
    hardware.independence = Independence::None;
    let found = simulated(&scene, &hardware);
    let [found, right] = [
        found.unwrap_err().to_string(),
        right.unwrap_err().to_string(),
    ];
    assert_eq!(found, right);
}
