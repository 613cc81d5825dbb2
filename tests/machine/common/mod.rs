//! Random graphs and cameras, and drawing with the machine.
#![expect(unreachable_pub, reason = "a module of several test crates")]
#![allow(dead_code, reason = "each test uses a part of it")]

use glam::DVec3;
use proptest::prelude::*;
use shiftvox::frame::Frame;
use shiftvox::graph::{Graph, LinkedGraph, Opacity};
use shiftvox::machine::Machine;
use shiftvox::project::{Camera, Coverage, Engine, FrameSetup, SetupOptions, Stats};

use crate::scenes::{Dice, any_camera};

/// A number that a variable may set.
pub fn number_of(variable: &str, usual: u32) -> u32 {
    std::env::var(variable).map_or(usual, |n| n.parse().expect("a number"))
}

/// New cases in every run, as many times as `SHIFTVOX_CASES` says.
pub fn cases(usual: u32) -> ProptestConfig {
    ProptestConfig::with_cases(usual * number_of("SHIFTVOX_CASES", 1))
}

/// A graph from each node's children by octant; a node without any is a leaf.
pub fn linked(depth: u32, nodes: &[[Option<u32>; 8]]) -> Graph {
    let mut graph = LinkedGraph::new(depth);
    for (node, children) in nodes.iter().enumerate() {
        graph.add_node([node as u8, 100, 200], *children);
    }
    graph.build().expect("a graph")
}

/// A dense cube: one node, all of whose children are itself.
pub fn solid(depth: u32) -> Graph {
    linked(depth, &[[Some(0); 8]])
}

/// The Sierpinski tetrahedron: one node, four of whose children are itself.
pub fn sierpinski(depth: u32) -> Graph {
    let child = |octant| [0, 3, 5, 6].contains(&octant).then_some(0);
    linked(depth, &[std::array::from_fn(child)])
}

/// A full octree over the voxels of a predicate, leaves at the finest level.
pub fn octree(depth: u32, is_filled: &dyn Fn([i32; 3]) -> bool) -> Graph {
    let mut nodes = vec![[None; 8]];
    for place in 0..1u32 << (3 * depth) {
        let octants = (0..depth).rev().map(|level| place >> (3 * level) & 7);
        let halved = |at: [i32; 3], octant: u32| {
            [0, 1, 2].map(|k| at[k] << 1 | (octant >> (2 - k) & 1) as i32)
        };
        if !is_filled(octants.clone().fold([0; 3], halved)) {
            continue;
        }
        let mut node = 0;
        for octant in octants {
            let next = nodes.len();
            let child = &mut nodes[node][octant as usize];
            node = *child.get_or_insert(next as u32) as usize;
            if node == next {
                nodes.push([None; 8]);
            }
        }
    }
    linked(depth, &nodes)
}

/// Random graphs: trees, shared subtrees, cycles that end at the depth, and large leaves.
pub fn any_graph(depths: std::ops::Range<u32>) -> impl Strategy<Value = Graph> {
    (depths, 1..8usize).prop_flat_map(|(depth, count)| {
        let child = prop_oneof![
            2 => Just(None),
            1 => (0..count as u32).prop_map(Some),
        ];
        let node = prop_oneof![
            4 => proptest::array::uniform8(child),
            1 => Just([None; 8]),
        ];
        proptest::collection::vec(node, count).prop_map(move |nodes| linked(depth, &nodes))
    })
}

/// Random octrees of the finest voxels.
pub fn any_octree(depth: u32, density: f64) -> impl Strategy<Value = Graph> {
    let bits = proptest::collection::vec(proptest::bool::weighted(density), 1 << (3 * depth));
    bits.prop_map(move |bits| {
        let number = |at: [i32; 3]| at.iter().fold(0, |number, c| number << depth | *c as usize);
        octree(depth, &|at| bits[number(at)] || at == [0; 3])
    })
}

/// Graphs, each with a camera around it.
pub fn any_view(
    graphs: impl Strategy<Value = Graph>,
    sizes: std::ops::Range<u32>,
) -> impl Strategy<Value = (Graph, Camera)> {
    (graphs, any::<u64>()).prop_map(move |(graph, seed)| {
        let camera = any_camera(&graph, sizes.clone(), &mut Dice::new(seed));
        (graph, camera)
    })
}

/// A square camera of 60 degrees.
pub fn camera(eye: [f64; 3], target: [f64; 3], size: u32) -> Camera {
    let (eye, target) = (DVec3::from_array(eye), DVec3::from_array(target));
    let up = match eye.truncate() == target.truncate() {
        true => DVec3::Y,
        false => DVec3::Z,
    };
    Camera {
        up,
        ..Camera::looking(eye, target, 60.0, (size, size))
    }
}

/// The tolerance, or 0 under the rules that draw outlines, which have no other.
pub fn tolerance_of(coverage: Coverage, tolerance_px: f64) -> f64 {
    match coverage.draws_outlines() {
        true => 0.0,
        false => tolerance_px,
    }
}

/// Opacities by node, in turn.
pub fn with_opacities(graph: &Graph, opacities: &[[u8; 3]]) -> Graph {
    let opacity = opacities.iter().cycle().take(graph.len());
    Graph {
        opacity: opacity.map(|&of| Opacity(of)).collect::<Vec<_>>().into(),
        ..graph.clone()
    }
}

/// Light by node.
pub fn lights(graph: &Graph) -> Vec<[u16; 3]> {
    (0..graph.len() as u16)
        .map(|i| [0, 1, 2].map(|c| i.wrapping_mul(40_503).rotate_left(5 * c)))
        .collect()
}

pub fn setup(graph: &Graph, camera: &Camera, options: &SetupOptions) -> FrameSetup {
    FrameSetup::new(camera, &graph.placement, graph.depth, options).expect("a frame")
}

pub fn draw(graph: &Graph, setup: &FrameSetup) -> (Frame, Stats) {
    let mut frame = Frame::new(setup.width, setup.height, false);
    let drawn = Machine::default().render(&graph.view(), setup, &mut frame);
    (frame, drawn.expect("no overflow"))
}

pub fn stat(stats: &Stats, name: &str) -> u64 {
    let named = stats.iter().find(|(n, _)| *n == name);
    named.unwrap_or_else(|| panic!("no statistic {name}")).1
}
