//! The machine on simulated hardware draws what it draws serially.
//!
//! Under `none` and `image` that holds for all settings, to the last count:
//! records whose image nodes meet have their turns in the serial order. Under
//! `classes` and `both` it is the image-order paper's claim (children of one class never
//! occlude one another), which holds where a sample is claimed by a ray: under the exact
//! rule.

use crate::common::*;
use crate::scenes;
use hwmodel::count::Counter;
use hwmodel::cycles::{
    Child, Hardware, ImageNode, Independence, LANES, NoObserver, Progress, Recorder, TraceLimit,
    scaling,
};
use hwmodel::{Memory, OpClass, Stage};
use proptest::prelude::*;
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::{MOST_OPEN_TILES, Machine, OCCLUSION_ORDER, Simulated};
use shiftvox::project::{
    CageKind, Camera, Coverage, Engine, EngineError, FrameSetup, SetupOptions, Stats,
};

fn any_hardware() -> impl Strategy<Value = Hardware> {
    let names = ["tiny", "paper", "wide"];
    (0..3usize, 1..20u32, 1..9u32, 1..80u32, 1..5u32).prop_map(
        move |(which, lanes, contexts, entries, banks)| {
            let mut hardware = Hardware::preset(names[which]).unwrap();
            (hardware.lanes, hardware.contexts) = (lanes, contexts);
            hardware.stack.entries = entries;
            hardware.fill_vectors.banks = banks;
            hardware
        },
    )
}

fn any_settings() -> impl Strategy<Value = SetupOptions> {
    let tolerance = prop_oneof![
        2 => Just(0.0),
        1 => Just(1.0 / 16.0),
        2 => Just(1.0 / 8.0),
        1 => Just(1.5),
        1 => Just(f64::INFINITY),
    ];
    let coverage = prop_oneof![
        2 => Just(Coverage::Exact),
        1 => Just(Coverage::Center),
        1 => Just(Coverage::Any),
    ];
    let cage = prop_oneof![Just(CageKind::Frame), Just(CageKind::Corners)];
    let lod = prop_oneof![Just(0.0), Just(1.0), Just(3.0)];
    (tolerance, coverage, cage, lod).prop_map(|(tolerance_px, coverage, cage, lod_px)| {
        SetupOptions {
            cage,
            tolerance_px: tolerance_of(coverage, tolerance_px),
            coverage,
            lod_px,
            ..SetupOptions::of(coverage)
        }
    })
}

fn serial(graph: &Graph, setup: &FrameSetup) -> Result<(Frame, Stats), EngineError> {
    let mut frame = Frame::new(setup.width, setup.height, false);
    let stats = Machine::default().render(&graph.view(), setup, &mut frame)?;
    Ok((frame, stats))
}

fn simulated(graph: &Graph, setup: &FrameSetup, hardware: &Hardware) -> (Frame, Simulated) {
    let mut frame = Frame::new(setup.width, setup.height, false);
    let simulated = Machine::default()
        .simulate(&graph.view(), setup, &mut frame, hardware, &mut NoObserver)
        .expect("what the machine draws");
    (frame, simulated)
}

/// What holds of every report.
fn is_sound(simulated: &Simulated, hardware: &Hardware) -> Result<(), TestCaseError> {
    let report = &simulated.cycles;
    for bound in &report.bounds {
        prop_assert!(bound.cycles <= report.cycles, "{bound:?}");
    }
    prop_assert!(report.cycles <= report.serial);
    let sum = report.context_cycles;
    prop_assert_eq!(
        sum.working + sum.stalled + sum.order_wait + sum.no_record,
        report.cycles * hardware.all_contexts()
    );
    Ok(())
}

/// Most records of a frame that is simulated: few random frames have more, and some a hundred
/// times as many.
const MOST_RECORDS: u64 = 20_000;

/// Simulates and compares with the serial machine: the picture, and, where
/// the order is the serial one wherever it matters, all counts.
fn agree(
    graph: &Graph,
    camera: &Camera,
    settings: &SetupOptions,
    hardware: &Hardware,
) -> Result<(), TestCaseError> {
    let Ok(setup) = FrameSetup::new(camera, &graph.placement, graph.depth, settings) else {
        return Ok(());
    };
    let mut right = Frame::new(setup.width, setup.height, false);
    let drawn = Machine::default().render_within(&graph.view(), &setup, &mut right, MOST_RECORDS);
    let Ok(drawn) = drawn else {
        return Ok(());
    };
    let Some(mut counts) = drawn else {
        return Err(TestCaseError::reject("a frame of too many records"));
    };
    counts.retain(|(name, _)| *name != "deepest_stack");
    for independence in [Independence::None, Independence::Image] {
        let hardware = Hardware {
            independence,
            ..hardware.clone()
        };
        let (drawn, simulated) = simulated(graph, &setup, &hardware);
        prop_assert!(drawn == right, "{independence:?}: another picture");
        // How many tiles are under way at once is the hardware's alone.
        let mut of_hardware = simulated.counts.clone();
        of_hardware.retain(|(name, _)| *name != MOST_OPEN_TILES);
        prop_assert_eq!(&of_hardware, &counts);
        prop_assert_eq!(simulated.cycles.records, stat(&counts, "records"));
        is_sound(&simulated, &hardware)?;
    }
    for independence in [Independence::Classes, Independence::Both] {
        let hardware = Hardware {
            independence,
            ..hardware.clone()
        };
        let (drawn, simulated) = simulated(graph, &setup, &hardware);
        is_sound(&simulated, &hardware)?;
        if settings.coverage == Coverage::Exact {
            prop_assert!(drawn == right, "{independence:?}: another picture");
        }
        if settings.tolerance_px.is_finite() {
            // Who draws a sample may differ, not whether it is drawn.
            let is_drawn = |frame: &Frame| {
                frame
                    .node
                    .iter()
                    .map(|&n| n != u32::MAX)
                    .collect::<Vec<_>>()
            };
            prop_assert_eq!(is_drawn(&drawn), is_drawn(&right));
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(6))]

    #[test]
    fn cycles_same_picture_on_random_graphs(
        (graph, camera) in any_graph(1..6).prop_flat_map(|graph| {
            let side = f64::from(1u32 << graph.depth);
            (Just(graph), any_camera(side, 1..60))
        }),
        settings in any_settings(),
        hardware in any_hardware(),
    ) {
        prop_assume!(settings.coverage == Coverage::Exact || graph.depth < 4);
        agree(&graph, &camera, &settings, &hardware)?;
    }

    #[test]
    fn cycles_same_picture_on_random_octrees(
        graph in any_octree(4, 0.2),
        camera in any_camera(16.0, 1..80),
        settings in any_settings(),
        hardware in any_hardware(),
    ) {
        agree(&graph, &camera, &settings, &hardware)?;
    }
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

proptest! {
    #![proptest_config(cases(24))]

    /// The image-order paper's claim on hardware that does its best to break it: many
    /// contexts, and misses so slow that classmates overtake one another.
    #[test]
    fn cycles_classmates_may_overtake_one_another(
        graph in any_octree(4, 0.4),
        camera in any_camera(16.0, 30..90),
        lines in 1..16u32,
        cage in prop_oneof![Just(CageKind::Frame), Just(CageKind::Corners)],
    ) {
        let settings = SetupOptions {
            cage,
            lod_px: 0.0,
            ..SetupOptions::default()
        };
        let mut hardware = Hardware::preset("wide").unwrap();
        let cache = &mut hardware.node_cache;
        (cache.ways, cache.line_bytes, cache.bytes) = (1, 8, 8 * lines);
        cache.miss_latency = 700;
        hardware.lanes = 3;
        let Ok(setup) = FrameSetup::new(&camera, &graph.placement, graph.depth, &settings) else {
            return Ok(());
        };
        let (right, _) = serial(&graph, &setup).expect("a frame");
        for independence in [Independence::Classes, Independence::Both] {
            hardware.independence = independence;
            let (drawn, simulated) = simulated(&graph, &setup, &hardware);
            prop_assert!(drawn == right, "{independence:?}: another picture");
            is_sound(&simulated, &hardware)?;
        }
    }
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

/// Lanes help, until the span or the order stands in the way.
#[test]
fn cycles_fall_with_lanes_down_to_the_span() {
    let (graph, setup) = terrain(&SetupOptions::default(), 128);
    let hardware = Hardware::preset("wide").unwrap();
    let rows = scaling(&hardware, &LANES, |hardware| {
        let report = simulated(&graph, &setup, hardware).1.cycles;
        assert!(report.cycles >= report.span);
        Ok::<_, EngineError>(report)
    })
    .expect("a table");
    assert_eq!(rows.len(), 7);
    assert_eq!((rows[0].speedup, rows[0].efficiency), (1.0, 1.0));
    assert!(rows[2].speedup > 1.1, "{rows:?}");
    assert!(rows[6].cycles <= rows[0].cycles);
    let serial = Hardware {
        independence: Independence::None,
        ..hardware
    };
    let report = simulated(&graph, &setup, &serial).1.cycles;
    // One record at a time: all that is worked on is one chain.
    assert_eq!((report.work, report.parallelism), (report.span, 1.0));
    assert!(report.cycles > rows[0].cycles);
}

#[test]
fn cycles_are_watched_without_being_changed() {
    let (graph, setup) = terrain(&SetupOptions::default(), 64);
    let hardware = Hardware::preset("paper").unwrap();
    let (unwatched, expected) = simulated(&graph, &setup, &hardware);
    let mut frame = Frame::new(64, 64, false);
    let mut last = (0, 0);
    let mut observer = (
        Recorder::new(TraceLimit::default()),
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
    let right = serial(&graph, &setup).map(|_| ()).expect_err("an overflow");
    let mut hardware = Hardware::preset("tiny").unwrap();
    hardware.independence = Independence::None;
    let mut frame = Frame::new(256, 256, false);
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
