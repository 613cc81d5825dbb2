//! The ray caster's pictures, and its work worked out by hand.

use glam::DVec3;
use hwmodel::cycles::Hardware;
use hwmodel::{Memory, OpClass, Stage};

use super::{Cast, RayStage, Rival, cast};
use crate::measure::CoverageError;
use crate::model::frame::reference;
use shiftvox::graph::{Graph, Silent};
use shiftvox::project::{Camera, FrameSetup, SetupOptions};
use shiftvox::scene::{NoMeshes, OpenOptions, Source, open_source};

/// Eye and target in sides of the object's cube.
fn view(spec: &str, eye: [f64; 3], target: [f64; 3], side: u32) -> (Graph, FrameSetup) {
    let source = Source::Generated(format!("gen:{spec}"));
    let opened = open_source(source, &OpenOptions::default(), &NoMeshes, &Silent);
    let graph = opened.unwrap().graph;
    let low = DVec3::from_array(graph.placement.origin_index.map(|c| c as f64));
    let in_world = |at: [f64; 3]| low + DVec3::from_array(at) * f64::from(1u32 << graph.depth);
    let camera = Camera::looking(in_world(eye), in_world(target), 60.0, (side, side));
    let options = SetupOptions::default();
    let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, &options).unwrap();
    (graph, setup)
}

/// Views in all octants of direction, from outside, far away and within.
pub(crate) fn views() -> Vec<(String, Graph, FrameSetup)> {
    let outside = [
        ([1.6, -0.7, 1.25], [0.5, 0.5, 0.3]),
        ([0.47, -0.95, 0.53], [0.475, 0.5, 0.475]),
        ([-0.6, 1.4, -0.8], [0.5, 0.5, 0.5]),
        ([1.3, 1.9, 0.6], [0.4, 0.5, 0.5]),
        ([-1.3, -0.4, 1.6], [0.4, 0.5, 0.5]),
        ([6.0, -14.0, 8.0], [0.5, 0.5, 0.4]),
    ];
    let inside = [[0.51, 0.37, 0.47], [0.26, 0.74, 0.41]].map(|eye| (eye, [0.9, 0.8, 0.3]));
    // Odd sizes have a ray through the middle, here along an axis.
    let along = [([0.7, -4.0, 0.6], [0.7, 0.0, 0.6])];
    let mut all = Vec::new();
    for (spec, side, views) in [
        ("terrain,depth=8", 160, &outside[..]),
        ("menger,depth=4", 160, &outside),
        ("menger,depth=3", 160, &inside),
        ("sierpinski,depth=9", 160, &inside),
        ("sphere,depth=6", 160, &inside),
        ("sphere,depth=1", 17, &along),
    ] {
        for &(eye, target) in views {
            let (graph, setup) = view(spec, eye, target, side);
            all.push((format!("{spec} from {eye:?}"), graph, setup));
        }
    }
    all
}

fn cast_with((graph, setup): (&Graph, &FrameSetup), rival: &Rival, design: &str) -> Cast {
    let hardware = rival.beside(&Hardware::preset(design).unwrap());
    cast(graph, setup, rival, &hardware).unwrap()
}

#[test]
fn it_sees_what_the_oracle_sees() {
    let rival = Rival {
        bits: 48,
        ..Rival::shipped()
    };
    for (name, graph, setup) in views() {
        let exact = reference(&graph.view(), &setup).unwrap();
        let found = cast_with((&graph, &setup), &rival, "light");
        let error = CoverageError::between(&found.frame.voxel, &exact.voxel);
        // Rays along a boundary: where both sides are as near, either is right.
        let is_near = error.covered > 0 && error.differing() <= 2;
        assert!(is_near, "{name}: {error:?}");
        assert_eq!(found.frame.drawn() as u64, found.cycles.pixels, "{name}");
    }
}

/// Every setting that is not about numbers leaves the picture as it is.
#[test]
fn the_picture_does_not_depend_on_contexts_buffer_or_nodes() {
    let (graph, setup) = view("terrain,depth=6", [1.6, -0.7, 1.25], [0.5, 0.5, 0.3], 96);
    let shipped = Rival::shipped();
    let scene = (&graph, &setup);
    let first = cast_with(scene, &shipped, "light");
    let reads = |of: &Cast| of.counter.accesses_by(|cell| cell.memory)[&Memory::Node].reads;
    let with = |contexts, node_buffer| Rival {
        contexts,
        node_buffer,
        ..shipped.clone()
    };
    for (rival, design) in [
        (with(3, shipped.node_buffer), "light"),
        (with(shipped.contexts, None), "light"),
        (shipped.clone(), "paper"),
    ] {
        let found = cast_with(scene, &rival, design);
        assert_eq!(found.frame, first.frame);
        let (ops, all) = (found.counter.ops(), first.counter.ops());
        assert_eq!(ops, all);
        let node_cache = found.cycles.node_cache.accesses;
        match found.cycles.node_buffer {
            Some(buffer) => {
                assert_eq!(
                    (buffer.accesses, buffer.misses),
                    (reads(&found), node_cache)
                );
            }
            None => assert_eq!(node_cache, reads(&found)),
        }
        // `paper` has no bricks and no marks of leaves.
        assert_eq!(reads(&found) > reads(&first), design == "paper");
    }
    assert!(first.cycles.node_buffer.unwrap().hit_rate > 0.5);
}

/// A solid cube is seen from a corner by one ray, along its diagonal.
#[test]
fn the_work_of_a_ray_by_hand() {
    let shipped = Rival::shipped();
    let (graph, setup) = view("sphere,depth=2", [2.5, 2.0, 1.5], [0.5, 0.5, 0.5], 1);
    let found = cast_with((&graph, &setup), &shipped, "light");
    let of = |stage: RayStage, class: OpClass| -> u64 {
        let stage = Stage::from(stage);
        let sums = found.counter.sum_by(|cell| (cell.stage, cell.class));
        sums.get(&(stage, class)).copied().unwrap_or(0)
    };
    use RayStage::{Hit, Next, Setup};
    // The first ray is loaded; there is no other.
    assert_eq!(of(Next, OpClass::Add), 0);
    // All components are negative: three magnitudes, three moments turned. The ray comes from beyond three planes,
    // each against the upper planes of two axes, and the later ones against the planes before.
    let (adds, subs) = (of(Setup, OpClass::Add), of(Setup, OpClass::Sub));
    assert_eq!((adds + subs, of(Setup, OpClass::Shift)), (3 + 3 + 6 + 2, 3));
    assert_eq!(of(Hit, OpClass::Add), 0);
    let accesses = found.counter.accesses_by(|cell| cell.memory);
    assert_eq!(
        (
            accesses[&Memory::Attribute].reads,
            accesses[&Memory::Pixel].writes
        ),
        (1, 1)
    );
    // The brick that is the root: two words.
    assert_eq!(accesses[&Memory::Node].reads, 2);
    assert_eq!(found.cycles.pixels, 1);
}

/// A change of the description, and a part of the message.
const WRONG: &str = "\
bits = 32 => bits = 7 | bits: a word has 16 to 64 bits, not 7
contexts = 4 => contexts = 0 | contexts is 0; it must be 1 to 64
line_bytes = 8 => line_bytes = 24 | node_buffer.line_bytes is 24; it must be a power of two
entries = 24 => entries = 0 | a ray has 1 to 32 entries
entry_bytes = 8 => entry_bytes = 1 | node_buffer.entry_bytes is 1; it must be 8, as in the node cache
line_bytes = 8 => line_bytes = 128 | node_buffer.line_bytes is 128; it must be at most 64
latency = 0, interval = 1, width = 48 => latency = 0, interval = 0, width = 48 | interval is 0";

#[test]
fn wrong_descriptions_are_refused() {
    for row in WRONG.lines() {
        let (change, part) = row.split_once(" | ").unwrap();
        let (from, to) = change.split_once(" => ").unwrap();
        assert!(Rival::SHIPPED.contains(from));
        let refused = Rival::from_toml(&Rival::SHIPPED.replacen(from, to, 1));
        let error = refused.unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}
