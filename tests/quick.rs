//! Small scenes on all engines, under all rules, with each instruction set: seconds after a change (CONTRIBUTING.md).

use shiftvox::fast::{Fast, FastOptions, Instructions};
use shiftvox::frame::{Colors, Frame};
use shiftvox::graph::Silent;
use shiftvox::machine::Machine;
use shiftvox::project::{
    Bounds, Coverage, DEFAULT_FOV, Direction, Engine, FrameSetup, SetupOptions, Up, fit_camera,
};
use shiftvox::rays::Rays;
use shiftvox::scene::{NoMeshes, OpenOptions, open};

fn agree(scene: &str, azimuth: f64, coverage: Coverage, (size, aa_log2, zoom): (u32, u32, f64)) {
    let graph = open(scene, &OpenOptions::default(), &NoMeshes, &Silent);
    let graph = graph.expect("a scene").graph;
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
    let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, &options).expect("a frame");
    let draw = |mut engine: Box<dyn Engine>| {
        let mut frame = Frame::new(setup.width, setup.height, false);
        let stats = engine.render(&graph.view(), &setup, &mut frame);
        assert!(!stats.expect("64 bits are enough").is_empty());
        let mut again = Frame::new(setup.width, setup.height, false);
        let drawn = engine.draw(&graph.view(), &setup, &mut again);
        assert!(drawn.is_ok() && again == frame);
        let mut colors = Colors::new(setup.width, setup.height);
        let drawn = engine.draw_colors(&graph.view(), &graph.color, &setup, &mut colors);
        let shown = colors.words.iter().filter(|&&word| word != 0);
        assert!(drawn.is_ok() && shown.count() == frame.drawn());
        frame
    };
    let right = draw(Box::<Machine>::default());
    assert!(right.drawn() > 0);
    for instructions in [Instructions::Auto, Instructions::Scalar] {
        let options = FastOptions {
            instructions,
            ..FastOptions::default()
        };
        let fast = draw(Box::new(Fast::new(options, Box::new(Machine::default()))));
        assert!(fast == right, "{scene} {coverage:?} {instructions:?}");
    }
    assert!(coverage != Coverage::Exact || draw(Box::new(Rays)) == right);
}

#[test]
fn engines_agree_on_small_scenes() {
    for scene in [
        "gen:menger,depth=2",
        "gen:terrain,depth=5",
        "gen:sierpinski,depth=9",
        "gen:wires,depth=5",
    ] {
        agree(scene, 10.0, Coverage::Exact, (96, 0, 1.0));
        agree(scene, 200.0, Coverage::Exact, (33, 1, 6.0));
        agree(scene, 45.0, Coverage::Center, (48, 0, 1.0));
        agree(scene, 300.0, Coverage::Any, (48, 1, 6.0));
    }
}
