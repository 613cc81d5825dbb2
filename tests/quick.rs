//! Small scenes on all engines, under all rules, with each instruction set: seconds after a change (CONTRIBUTING.md).

use shiftvox::fast::{Fast, FastOptions, Instructions};
use shiftvox::frame::Frame;
use shiftvox::graph::Silent;
use shiftvox::machine::Machine;
use shiftvox::project::{
    Bounds, Coverage, DEFAULT_FOV, Direction, Engine, FrameSetup, SetupOptions, Up, fit_camera,
};
use shiftvox::rays::Rays;
use shiftvox::scene::{NoMeshes, OpenOptions, open};

/// The frame of an engine.
fn drawn(
    engine: &mut dyn Engine,
    graph: &shiftvox::graph::Graph,
    setup: &FrameSetup,
) -> (Vec<u32>, Vec<[i32; 4]>) {
    let mut frame = Frame::new(setup.width, setup.height, false);
    engine
        .render(&graph.view(), setup, &mut frame)
        .expect("64 bits are enough");
    (frame.node, frame.voxel)
}

#[test]
fn engines_agree_on_small_scenes() {
    for scene in [
        "gen:menger,depth=2",
        "gen:terrain,depth=5",
        "gen:sierpinski,depth=9",
        "gen:wires,depth=5",
    ] {
        let opened = open(scene, &OpenOptions::default(), &NoMeshes, &Silent).expect("a scene");
        let graph = opened.graph;
        for (coverage, azimuth, size) in [
            (Coverage::Exact, 10.0, 96),
            (Coverage::Exact, 200.0, 33),
            (Coverage::Center, 45.0, 48),
            (Coverage::Any, 300.0, 48),
        ] {
            for (aa_log2, zoom) in [(0, 1.0), (1, 6.0)] {
                let direction = Direction {
                    azimuth,
                    elevation: 25.0,
                };
                let bounds = Bounds::of(&graph);
                let camera = fit_camera(&bounds, Up::Z, direction, DEFAULT_FOV, zoom, (size, size));
                let options = SetupOptions {
                    aa_log2,
                    ..SetupOptions::of(coverage)
                };
                let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, &options);
                let setup = setup.expect("a frame");
                let machine = drawn(&mut Machine::default(), &graph, &setup);
                assert!(
                    machine
                        .0
                        .iter()
                        .any(|&node| node != shiftvox::frame::NO_NODE)
                );
                for instructions in [Instructions::Auto, Instructions::Scalar] {
                    let options = FastOptions {
                        instructions,
                        ..FastOptions::default()
                    };
                    let mut fast = Fast::new(options, Box::new(Machine::default()));
                    assert!(
                        drawn(&mut fast, &graph, &setup) == machine,
                        "{scene} {coverage:?} {instructions:?}"
                    );
                }
                if coverage == Coverage::Exact {
                    assert!(
                        drawn(&mut Rays, &graph, &setup) == machine,
                        "{scene}: the oracle differs"
                    );
                }
            }
        }
    }
}
