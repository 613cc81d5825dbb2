//! The fast engine equals the oracle at every sample of many frames, from awkward places, and from those where it was
//! once wrong. `SHIFTVOX_SAMPLES=100000000` compares that many samples instead of 4 million.

use glam::DVec3;
use shiftvox::fast::{Fast, FastOptions, Instructions};
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::Machine;
use shiftvox::project::{Camera, Engine, FrameSetup, SetupOptions};
use shiftvox::rays::Rays;

use crate::common::{number_of, stat};
use crate::scene_table::SCENES;
use crate::scenes::{Dice, PLACES, any_height, camera_at, cube, graph_of, up_of};

const SAMPLES: u32 = 4_000_000;

/// From any place or far away, from a hundredth of a degree to nearly 180.
fn any_camera(graph: &Graph, dice: &mut Dice) -> Camera {
    let size = (8 + dice.below(300), 8 + dice.below(300));
    let mut camera = camera_at(dice.of(&PLACES), graph, size, dice);
    if dice.below(6) == 0 {
        let (corner, side) = cube(graph);
        camera.eye = corner + dice.point(-30.0, 30.0) * side;
        camera.up = up_of(camera.target - camera.eye);
    }
    match dice.below(5) {
        0 => camera.fov_degrees = 10f64.powf(dice.between(0.005f64.log10(), 1.0)),
        1 => camera.fov_degrees = dice.between(90.0, 170.0),
        2 => camera.ortho = Some(any_height(graph, dice)),
        _ => {}
    }
    camera
}

/// The numbers of samples that were compared, that show a voxel, and that the exact rule decided. `None`: the camera
/// sees nothing, or the machine drew the frame.
fn compare(
    graph: &Graph,
    camera: &Camera,
    options: &SetupOptions,
    fast: FastOptions,
) -> Option<[u64; 3]> {
    let setup = FrameSetup::new(camera, &graph.placement, graph.depth, options).ok()?;
    let mut truth = Frame::new(setup.width, setup.height, false);
    let mut frame = truth.clone();
    // Nothing of an earlier picture remains.
    frame.node.fill(3);
    frame.voxel.fill([3; 4]);
    let drawn = Rays::default().render(&graph.view(), &setup, &mut truth);
    drawn.expect("the oracle never fails");
    let mut engine = Fast::new(fast, Box::new(Machine::default()));
    let stats = engine.render(&graph.view(), &setup, &mut frame);
    let stats = stats.expect("no overflow");
    if stats.iter().any(|(name, _)| *name == "handed_to_machine") {
        return None;
    }
    assert!(truth == frame, "{camera:?}, {fast:?}, {options:?}");
    let exact = stat(&stats, "samples_decided_exactly");
    Some([truth.node.len() as u64, truth.drawn() as u64, exact])
}

/// The options of all leaves.
fn leaves() -> SetupOptions {
    SetupOptions {
        lod_px: 0.0,
        ..SetupOptions::default()
    }
}

#[test]
fn fast_equals_the_oracle_at_every_sample() {
    let wanted = u64::from(number_of("SHIFTVOX_SAMPLES", SAMPLES));
    let mut dice = Dice::new(16);
    let mut sums = [0; 3];
    while sums[0] < wanted {
        let (_, graph) = &SCENES[dice.below(SCENES.len() as u32) as usize];
        let camera = any_camera(graph, &mut dice);
        let options = SetupOptions {
            lod_px: dice.of(&[0.0, 1.0, 0.5, 3.0, 0.1]),
            aa_log2: dice.of(&[0, 0, 1, 2]),
            ..leaves()
        };
        let fast = FastOptions {
            threads: 1 + dice.below(4) as usize,
            instructions: dice.of(&[Instructions::Auto, Instructions::Auto, Instructions::Scalar]),
            ..FastOptions::default()
        };
        let compared = compare(graph, &camera, &options, fast).unwrap_or_default();
        sums = [0, 1, 2].map(|i| sums[i] + compared[i]);
    }
    let [compared, drawn, exact] = sums;
    println!("{compared} samples, {drawn} drawn, {exact} decisions by the exact rule");
    assert!(drawn > compared / 10, "frames that show nothing");
    assert!(exact > 0, "ties were never met");
}

/// An eye just before the nearest corner of a brick, in views of nearly 180 degrees: a window in
/// `f32` lost samples there. Field of view, eye, target, up.
const AT_A_BRICK: &str = "
    179.97 -1.0741690972868054  2.9648109639271856 -0.5834173408116315
           -0.5913521098774458  3.298717861218092   0.22614670273928494
            0.34366900807812867 -0.9225381132071233 0.17554213900609644
    179.95  3.5440147668985564  4.0495752244578185  2.4227591969600586
            3.4422293344076116  3.054769122792365   2.4234979945064072
            0.2087245431629805 -0.022082151278343978 -0.9777251370790901
    179.9  -0.9134233092287264  1.4530304503495914  4.269014966681081
            0.005722517712963393 1.104910976903358  4.084668062657188
           -0.3399112620497473 -0.9374263412113141  0.07544659525065157";

#[test]
fn bricks_at_the_eye_in_views_of_nearly_180_degrees() {
    let graph = graph_of("gen:checker,depth=2");
    let numbers = AT_A_BRICK.split_whitespace().map(|n| n.parse().unwrap());
    for of_camera in numbers.collect::<Vec<f64>>().chunks(10) {
        let [eye, target, up] = [1, 4, 7].map(|at| DVec3::from_slice(&of_camera[at..]));
        let mut camera = Camera {
            eye,
            target,
            up,
            fov_degrees: of_camera[0],
            ortho: None,
            width: 64,
            height: 2000,
        };
        for instructions in [Instructions::Auto, Instructions::Scalar] {
            let fast = FastOptions {
                instructions,
                ..FastOptions::default()
            };
            assert!(compare(&graph, &camera, &leaves(), fast).is_some());
        }
        // Wider ones are declined.
        camera.fov_degrees = 179.98;
        assert!(compare(&graph, &camera, &leaves(), FastOptions::default()).is_none());
    }
}
