//! The fast engine equals the machine in every buffer: on random graphs,
//! cameras, sizes, cages, coverage rules, levels of detail,
//! formats, thread counts and instruction sets.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::common::*;
use crate::scene_table::SCENES;
use crate::scenes;
use proptest::prelude::*;
use shiftvox::fast::{Fast, FastOptions, Instructions, Switches};
use shiftvox::frame::{Colors, Frame, color_word};
use shiftvox::graph::{Graph, GraphView};
use shiftvox::machine::Machine;
use shiftvox::project::{
    CageKind, Camera, Coverage, Engine, EngineError, FrameSetup, SetupOptions, Stats,
};

/// A machine that records whether it was called.
struct Noted(Machine, Arc<AtomicBool>);

impl Engine for Noted {
    fn render(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
    ) -> Result<Stats, EngineError> {
        self.1.store(true, Ordering::Relaxed);
        self.0.render(graph, setup, frame)
    }
}

/// What the fast engine draws, and whether it drew that itself.
fn draw_fast(
    options: FastOptions,
    graph: &Graph,
    setup: &FrameSetup,
) -> (Result<Frame, EngineError>, bool) {
    let asked = Arc::new(AtomicBool::new(false));
    let fallback = Noted(Machine::default(), Arc::clone(&asked));
    let mut frame = Frame::new(setup.width, setup.height, false);
    let mut fast = Fast::new(options, Box::new(fallback));
    let light = lights(graph);
    let view = GraphView {
        light: &light,
        ..graph.view()
    };
    let drawn = fast.render(&view, setup, &mut frame);
    if drawn.is_ok() && setup.options.coverage != Coverage::Alpha {
        colors_are_the_nodes(&mut fast, graph, setup, &frame);
    }
    (drawn.map(|_| frame), !asked.load(Ordering::Relaxed))
}

/// What is drawn in colours is what the nodes that are seen have.
fn colors_are_the_nodes(fast: &mut Fast, graph: &Graph, setup: &FrameSetup, frame: &Frame) {
    let of_node: Vec<[u8; 3]> = (0..graph.len() as u32)
        .map(|node| {
            let [_, r, g, b] = node.wrapping_mul(0x9e37_79b1).to_be_bytes();
            [r, g, b]
        })
        .collect();
    let mut colors = Colors::new(setup.width, setup.height);
    colors.words.fill(3);
    fast.draw_colors(&graph.view(), &of_node, setup, &mut colors)
        .expect("drawn before");
    for (&node, &word) in frame.node.iter().zip(&colors.words) {
        let color = of_node.get(node as usize);
        assert_eq!(word, color.map_or(0, |&color| color_word(color)));
    }
}

fn draw_machine(graph: &Graph, setup: &FrameSetup) -> Result<Frame, EngineError> {
    let mut frame = Frame::new(setup.width, setup.height, false);
    let light = lights(graph);
    let view = GraphView {
        light: &light,
        ..graph.view()
    };
    Machine::default()
        .render(&view, setup, &mut frame)
        .map(|_| frame)
}

const SETS: [Instructions; 2] = [Instructions::Scalar, Instructions::Avx2];

fn any_options() -> impl Strategy<Value = FastOptions> {
    let set = (0..SETS.len()).prop_map(|i| SETS[i]);
    let switches = proptest::array::uniform6(proptest::bool::weighted(0.85));
    (set, 1..4usize, switches).prop_map(|(instructions, threads, on)| FastOptions {
        threads,
        instructions,
        switches: Switches {
            hidden: on[0],
            full: on[1],
            off_screen: on[2],
            bricks: on[3],
            whole_blocks: on[4],
            absent_children: on[5],
        },
    })
}

pub(super) fn any_settings() -> impl Strategy<Value = SetupOptions> {
    // Of the rules that have one.
    let tolerance = prop_oneof![Just(0.0), Just(1.0 / 8.0), Just(f64::INFINITY)];
    let coverage = prop_oneof![
        24 => Just(Coverage::Exact),
        12 => Just(Coverage::Alpha),
        1 => Just(Coverage::Center),
        1 => Just(Coverage::Any),
    ];
    let cage = prop_oneof![Just(CageKind::Frame), Just(CageKind::Corners)];
    let format = prop_oneof![
        6 => Just((64, None)),
        1 => (24..64u32).prop_map(|bits| (bits, None)),
        1 => (24..64u32, 4..12u32).prop_map(|(bits, frac)| (bits, Some(frac))),
    ];
    let lod = prop_oneof![3 => Just(0.0), 3 => Just(1.0), 1 => Just(0.3), 1 => Just(6.0)];
    (tolerance, coverage, cage, format, lod, 0..2u32).prop_map(
        |(tolerance_px, coverage, cage, (bits, frac), lod_px, aa_log2)| SetupOptions {
            bits,
            frac,
            cage,
            tolerance_px: tolerance_of(coverage, tolerance_px),
            coverage,
            lod_px,
            aa_log2,
        },
    )
}

/// Compares the two engines on one frame.
fn agree(
    graph: &Graph,
    camera: &Camera,
    settings: &SetupOptions,
    options: FastOptions,
) -> Result<(), TestCaseError> {
    let airy = (settings.coverage == Coverage::Alpha).then(|| with_opacities(graph));
    let graph = airy.as_ref().unwrap_or(graph);
    let Ok(setup) = FrameSetup::new(camera, &graph.placement, graph.depth, settings) else {
        return Ok(());
    };
    let right = draw_machine(graph, &setup);
    let (drawn, by_itself) = draw_fast(options, graph, &setup);
    match (&right, &drawn) {
        (Ok(right), Ok(drawn)) => prop_assert!(
            right == drawn,
            "{} samples differ",
            right
                .node
                .iter()
                .zip(&drawn.node)
                .filter(|(a, b)| a != b)
                .count()
        ),
        (Err(right), Err(drawn)) => prop_assert_eq!(right, drawn),
        _ => prop_assert!(false, "only one of them drew: {:?}", right.err()),
    }
    let usual = settings.bits == 64 && settings.frac.is_none();
    if usual && settings.coverage.draws_outlines() {
        // Deep graphs far away may be beyond its lanes; these are not.
        prop_assert!(by_itself || graph.depth > 12, "left to the machine");
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(50))]

    #[test]
    fn equal_on_random_graphs(
        (graph, camera) in any_graph(1..9).prop_flat_map(|graph| {
            let side = f64::from(1u32 << graph.depth);
            (Just(graph), any_camera(side, 1..90))
        }),
        settings in any_settings(),
        options in any_options(),
    ) {
        // Under the other rules a cyclic graph is subdivided to the last bit.
        prop_assume!(settings.coverage.draws_outlines() || graph.depth < 5);
        agree(&graph, &camera, &settings, options)?;
    }

    #[test]
    fn equal_on_random_octrees(
        graph in any_octree(4, 0.3),
        camera in any_camera(16.0, 1..110),
        settings in any_settings(),
        options in any_options(),
    ) {
        agree(&graph, &camera, &settings, options)?;
    }

    // Voxels of about a sample and less, so that three levels fit a tile.
    #[test]
    fn equal_on_small_mixed_voxels(
        graph in any_mixed_octree(5),
        camera in any_camera(32.0, 10..50),
        settings in any_settings(),
        lod_px in prop_oneof![Just(0.0), Just(0.2)],
        options in any_options(),
    ) {
        prop_assume!(settings.coverage.draws_outlines());
        let settings = SetupOptions { lod_px, aa_log2: 0, ..settings };
        agree(&graph, &camera, &settings, options)?;
    }

    #[test]
    fn equal_on_sparse_octrees(
        graph in any_octree(4, 0.02),
        camera in any_camera(16.0, 40..160),
        settings in any_settings(),
        options in any_options(),
    ) {
        agree(&graph, &camera, &settings, options)?;
    }
}

proptest! {
    #![proptest_config(cases(20))]

    #[test]
    fn equal_on_the_scenes_of_the_table(
        which in 0..SCENES.len(),
        camera in any_camera(1.0, 60..300),
        settings in any_settings(),
        options in any_options(),
    ) {
        prop_assume!(settings.coverage.draws_outlines());
        let graph = SCENES[which].graph();
        // From inside, the machine takes hours for a fractal of many levels.
        prop_assume!(graph.depth < 12);
        let (low, side) = scenes::cube(graph);
        let camera = Camera {
            eye: low + camera.eye * side,
            target: low + camera.target * side,
            ..camera
        };
        agree(graph, &camera, &settings, options)?;
    }
}
