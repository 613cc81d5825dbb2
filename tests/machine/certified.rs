//! The certified engine: at every sample of many frames, fast equals oracle in
//! node and voxel, whatever the graph, the camera, the level of detail, the
//! samples a pixel, the threads and the instruction set.
//!
//! `SHIFTVOX_SAMPLES=100000000` compares that many samples instead of 8 million.

use glam::DVec3;
use shiftvox::fast::{Fast, FastOptions, Instructions};
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::Machine;
use shiftvox::project::{Camera, Engine, FrameSetup, SetupOptions};
use shiftvox::rays::Rays;

use crate::common::{octree, solid, up_of};
use crate::scene_table::SCENES;
use crate::scenes::{Dice, any_voxel, cube, graph_of_spec};

/// Samples that are compared unless the environment sets another number.
const SAMPLES: u64 = 8_000_000;

/// A camera: anywhere, or where ties abound: on a voxel's corner, edge, face or
/// in its middle, looking along an axis or at a corner.
fn camera(graph: &Graph, dice: &mut Dice) -> Option<Camera> {
    let (corner, side) = cube(graph);
    let voxel = any_voxel(graph, dice);
    let size = graph.placement.voxel_size;
    let halves = DVec3::new(
        f64::from(dice.below(3)),
        f64::from(dice.below(3)),
        f64::from(dice.below(3)),
    );
    let eye = match dice.below(6) {
        0 => voxel + halves * (size / 2.0),
        1 => voxel + dice.point(-4.0, 4.0) * size,
        2 => corner + dice.point(0.0, 1.0) * side,
        3 => corner + dice.point(-30.0, 30.0) * side,
        _ => corner + dice.point(-1.5, 2.5) * side,
    };
    let axis = [DVec3::X, DVec3::Y, DVec3::Z][dice.below(3) as usize];
    let target = match dice.below(5) {
        0 => eye + axis,
        1 => eye - axis,
        2 => voxel,
        _ => corner + dice.point(0.0, 1.0) * side,
    };
    let fov_degrees = match dice.below(4) {
        0 => 10f64.powf(dice.between(0.005f64.log10(), 1.0)),
        1 => dice.between(90.0, 170.0),
        _ => dice.between(10.0, 90.0),
    };
    let camera = Camera {
        eye,
        target,
        up: up_of(target - eye),
        fov_degrees,
        width: 8 + dice.below(300),
        height: 8 + dice.below(300),
    };
    camera.axes().ok().map(|_| camera)
}

#[test]
fn fast_equals_the_oracle_at_every_sample() {
    let wanted =
        std::env::var("SHIFTVOX_SAMPLES").map_or(SAMPLES, |n| n.parse().expect("a number"));
    let mut dice = Dice::new(16);
    let (mut compared, mut drawn, mut exact, mut left_over) = (0u64, 0u64, 0u64, 0u64);
    while compared < wanted {
        let graph = SCENES[dice.below(SCENES.len() as u32) as usize].graph();
        let Some(camera) = camera(graph, &mut dice) else {
            continue;
        };
        let options = SetupOptions {
            lod_px: [0.0, 1.0, 0.5, 3.0, 0.1][dice.below(5) as usize],
            aa_log2: [0, 0, 1, 2][dice.below(4) as usize],
            ..SetupOptions::default()
        };
        let Ok(setup) = FrameSetup::new(&camera, &graph.placement, graph.depth, &options) else {
            continue;
        };
        let mut truth = Frame::new(setup.width, setup.height, false);
        Rays.render(&graph.view(), &setup, &mut truth)
            .expect("never fails");
        let options = FastOptions {
            threads: 1 + dice.below(4) as usize,
            instructions: [Instructions::Auto, Instructions::Scalar]
                [usize::from(dice.below(8) == 0)],
            ..FastOptions::default()
        };
        let mut frame = truth.clone();
        frame.clear();
        let stats = Fast::new(options, Box::new(Machine::default()))
            .render(&graph.view(), &setup, &mut frame)
            .expect("no overflow");
        let stat = |name: &str| {
            stats
                .iter()
                .find(|(n, _)| *n == name)
                .map_or(0, |(_, n)| *n)
        };
        if stat("handed_to_machine") > 0 {
            left_over += 1;
            continue;
        }
        let differing = |(a, b): (&[i32; 4], &[i32; 4])| a != b;
        let differ = truth.voxel.iter().zip(&frame.voxel).position(differing);
        assert!(
            differ.is_none() && truth.node == frame.node,
            "{camera:?} of {graph_depth} levels, {options:?}, lod {}, aa {}: sample {differ:?}: \
             {:?}, truth {:?}",
            setup.options.lod_px,
            setup.options.aa_log2,
            differ.map(|at| frame.voxel[at]),
            differ.map(|at| truth.voxel[at]),
            graph_depth = graph.depth,
        );
        compared += truth.node.len() as u64;
        drawn += truth.drawn() as u64;
        exact += stat("samples_decided_exactly");
    }
    println!(
        "{compared} samples, {drawn} drawn, {exact} decisions by the exact rule; {left_over} \
         frames left to the machine"
    );
    assert!(drawn > compared / 10, "frames that show nothing");
    assert!(exact > 0, "ties were never met");
}

/// One sample whose ray runs along an axis, between four parts: all of its numbers are 0.
#[test]
fn a_ray_along_the_line_between_four_parts() {
    for graph in [
        solid(2),
        solid(4),
        solid(5),
        octree(4, &|[x, y, z]| (x ^ y ^ z) & 1 == 0),
    ] {
        let side = f64::from(1u32 << graph.depth);
        for (axis, at) in (0..3).flat_map(|axis| [0.25, 0.5, 0.75].map(|at| (axis, at))) {
            let mut eye = DVec3::splat(side * at);
            eye[axis] = -side;
            let mut target = eye;
            target[axis] = 0.0;
            let camera = Camera {
                eye,
                target,
                up: if axis == 2 { DVec3::Y } else { DVec3::Z },
                fov_degrees: 40.0,
                width: 1,
                height: 1,
            };
            let options = SetupOptions {
                lod_px: 0.0,
                ..SetupOptions::default()
            };
            let setup =
                FrameSetup::new(&camera, &graph.placement, graph.depth, &options).expect("a frame");
            let mut truth = Frame::new(1, 1, false);
            Rays.render(&graph.view(), &setup, &mut truth)
                .expect("never fails");
            let mut frame = truth.clone();
            Fast::new(FastOptions::default(), Box::new(Machine::default()))
                .render(&graph.view(), &setup, &mut frame)
                .expect("no overflow");
            assert!(
                truth == frame,
                "axis {axis} at {at}: {:?} {:?}",
                frame.voxel,
                truth.voxel
            );
        }
    }
}

/// An eye just before the nearest corner of a brick, in views of nearly 180 degrees: a window in
/// `f32` lost samples there.
#[test]
fn bricks_at_the_eye_in_views_of_nearly_180_degrees() {
    let graph = graph_of_spec("gen:checker,depth=2");
    let cameras = [
        (
            179.97,
            [-1.0741690972868054, 2.9648109639271856, -0.5834173408116315],
            [-0.5913521098774458, 3.298717861218092, 0.22614670273928494],
            [
                0.34366900807812867,
                -0.9225381132071233,
                0.17554213900609644,
            ],
        ),
        (
            179.95,
            [3.5440147668985564, 4.0495752244578185, 2.4227591969600586],
            [3.4422293344076116, 3.054769122792365, 2.4234979945064072],
            [
                0.2087245431629805,
                -0.022082151278343978,
                -0.9777251370790901,
            ],
        ),
        (
            179.9,
            [-0.9134233092287264, 1.4530304503495914, 4.269014966681081],
            [0.005722517712963393, 1.104910976903358, 4.084668062657188],
            [
                -0.3399112620497473,
                -0.9374263412113141,
                0.07544659525065157,
            ],
        ),
    ];
    for (fov_degrees, eye, target, up) in cameras {
        let camera = Camera {
            eye: eye.into(),
            target: target.into(),
            up: up.into(),
            fov_degrees,
            width: 64,
            height: 2000,
        };
        let options = SetupOptions {
            lod_px: 0.0,
            ..SetupOptions::default()
        };
        let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, &options)
            .expect("a camera that sees");
        let mut truth = Frame::new(setup.width, setup.height, false);
        Rays.render(&graph.view(), &setup, &mut truth)
            .expect("never fails");
        for instructions in [Instructions::Auto, Instructions::Scalar] {
            let options = FastOptions {
                instructions,
                ..FastOptions::default()
            };
            let mut frame = Frame::new(setup.width, setup.height, false);
            let stats = Fast::new(options, Box::new(Machine::default()))
                .render(&graph.view(), &setup, &mut frame)
                .expect("no overflow");
            assert!(stats.iter().all(|(name, _)| *name != "handed_to_machine"));
            assert!(frame == truth, "{fov_degrees} degrees, {instructions:?}");
        }
    }
}
