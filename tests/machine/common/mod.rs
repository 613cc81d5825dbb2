//! Random scenes and cameras that several tests share.
#![expect(unreachable_pub, reason = "a module of several test crates")]
#![allow(dead_code, reason = "each test uses a part of it")]

use glam::DVec3;
use proptest::prelude::*;
use shiftvox::fast::{Fast, FastOptions};
use shiftvox::frame::Frame;
use shiftvox::graph::{Graph, LinkedGraph, Opacity};
use shiftvox::machine::{Machine, MachineOptions};
use shiftvox::project::{Camera, Coverage, Engine, EngineError, FrameSetup, SetupOptions, Stats};
use shiftvox::split_mix::SplitMix;

/// How many times as many cases as usual `SHIFTVOX_CASES` asks for.
pub fn times() -> u32 {
    std::env::var("SHIFTVOX_CASES").map_or(1, |n| n.parse().expect("a number"))
}

/// So many cases of a property, other ones in every run.
pub fn cases(usual: u32) -> ProptestConfig {
    ProptestConfig::with_cases(usual * times())
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
    let mut children = [None; 8];
    for octant in [0, 3, 5, 6] {
        children[octant] = Some(0);
    }
    linked(depth, &[children])
}

/// A full octree over the voxels of a predicate, leaves at the finest level.
pub fn octree(depth: u32, is_filled: &dyn Fn([i32; 3]) -> bool) -> Graph {
    fn node(
        nodes: &mut Vec<[Option<u32>; 8]>,
        at: [i32; 3],
        side: i32,
        is_filled: &dyn Fn([i32; 3]) -> bool,
    ) -> Option<u32> {
        if side == 1 {
            if !is_filled(at) {
                return None;
            }
            nodes.push([None; 8]);
            return Some(nodes.len() as u32 - 1);
        }
        let me = nodes.len();
        nodes.push([None; 8]);
        let half = side / 2;
        let mut any = false;
        for octant in 0..8usize {
            let corner = [
                at[0] + half * (octant as i32 >> 2),
                at[1] + half * (octant as i32 >> 1 & 1),
                at[2] + half * (octant as i32 & 1),
            ];
            let child = node(nodes, corner, half, is_filled);
            nodes[me][octant] = child;
            any |= child.is_some();
        }
        if any {
            Some(me as u32)
        } else {
            nodes.truncate(me);
            None
        }
    }
    let mut nodes = Vec::new();
    node(&mut nodes, [0; 3], 1 << depth, is_filled).expect("an octree needs a voxel");
    linked(depth, &nodes)
}

/// Random graphs. Children may be any node, so most are cyclic: a graph ends at its depth.
pub fn any_graph(depths: std::ops::Range<u32>) -> impl Strategy<Value = Graph> {
    (depths, 1..8usize).prop_flat_map(|(depth, count)| {
        let child = prop_oneof![
            2 => Just(None),
            1 => (0..count as u32).prop_map(Some),
        ];
        proptest::collection::vec(proptest::array::uniform8(child), count)
            .prop_map(move |nodes| linked(depth, &nodes))
    })
}

/// Random octrees with some large leaves.
pub fn any_octree(depth: u32, density: f64) -> impl Strategy<Value = Graph> {
    let side = 1usize << depth;
    proptest::collection::vec(proptest::bool::weighted(density), side * side * side).prop_map(
        move |bits| {
            octree(depth, &|[x, y, z]| {
                let at = (x as usize * side + y as usize) * side + z as usize;
                bits[at] || at == 0
            })
        },
    )
}

/// Random octrees with leaves of two and four finest voxels among the finest.
pub fn any_mixed_octree(depth: u32) -> impl Strategy<Value = Graph> {
    /// Adds a node whose children are that of numbers which `next` throws.
    fn node(nodes: &mut Vec<[Option<u32>; 8]>, side: u32, next: &mut dyn FnMut() -> u64) -> u32 {
        let me = nodes.len();
        nodes.push([None; 8]);
        let is_leaf = side == 1 || side <= 4 && next().is_multiple_of(4);
        let most = if is_leaf { 0 } else { 8 };
        for octant in 0..most {
            // One of them at least, or it would be a leaf.
            if next() % 5 < 2 || octant == 7 {
                let child = node(nodes, side / 2, next);
                nodes[me][octant] = Some(child);
            }
        }
        me as u32
    }
    any::<u64>().prop_map(move |seed| {
        let mut numbers = SplitMix::new(seed);
        let mut next = || numbers.below(1 << 24);
        let mut nodes = Vec::new();
        node(&mut nodes, 1 << depth, &mut next);
        linked(depth, &nodes)
    })
}

/// Cameras outside, inside, on faces and on lattice points of a cube of side `side`. Many are aligned with an axis, so
/// that ties abound.
pub fn any_camera(side: f64, sizes: std::ops::Range<u32>) -> impl Strategy<Value = Camera> {
    let free = -2.0..3.0f64;
    let lattice = prop_oneof![Just(0.0), Just(0.25), Just(0.5), Just(1.0), Just(-0.5)];
    let coordinate = prop_oneof![3 => free, 1 => lattice].boxed();
    let eye = proptest::array::uniform3(coordinate);
    let axis = (0..3usize, any::<bool>()).prop_map(|(axis, back)| {
        let sign = if back { -1.0 } else { 1.0 };
        [DVec3::X, DVec3::Y, DVec3::Z][axis] * sign
    });
    let towards = prop_oneof![
        3 => proptest::array::uniform3(0.0..1.0f64).prop_map(Some),
        1 => Just(None),
    ];
    (eye, towards, axis, 5.0..150.0f64, sizes.clone(), sizes).prop_filter_map(
        "a camera that sees",
        move |(eye, towards, axis, fov_degrees, width, height)| {
            let eye = DVec3::from_array(eye) * side;
            let target = match towards {
                Some(target) => DVec3::from_array(target) * side,
                None => eye + axis,
            };
            let camera = Camera {
                eye,
                target,
                up: up_of(target - eye),
                fov_degrees,
                width,
                height,
            };
            camera.axes().ok().map(|_| camera)
        },
    )
}

/// A direction that is up for a camera that looks along another: Z, or Y where that is nearly the
/// same.
pub fn up_of(forward: DVec3) -> DVec3 {
    if forward.normalize_or_zero().z.abs() > 0.9 {
        DVec3::Y
    } else {
        DVec3::Z
    }
}

/// A camera at `eye` towards `target`, 60 degrees, square.
pub fn camera(eye: [f64; 3], target: [f64; 3], size: u32) -> Camera {
    Camera {
        eye: DVec3::from_array(eye),
        target: DVec3::from_array(target),
        up: if eye[..2] == target[..2] {
            DVec3::Y
        } else {
            DVec3::Z
        },
        fov_degrees: 60.0,
        width: size,
        height: size,
    }
}

/// The tolerance, or 0 under the rules that draw outlines, which have no other.
pub fn tolerance_of(coverage: Coverage, tolerance_px: f64) -> f64 {
    if coverage.draws_outlines() {
        0.0
    } else {
        tolerance_px
    }
}

/// Opacities by node: some nothing, some all, some unlike from their sides.
pub fn with_opacities(graph: &Graph) -> Graph {
    let opacity = (0..graph.len() as u32).map(|node| {
        let [kind, x, y, z] = (node + 7).wrapping_mul(0x9e37_79b1).to_be_bytes();
        Opacity(match kind & 7 {
            0 => [0; 3],
            1 => [255; 3],
            2 => [0x0f, 0, 0],
            3 => [0x11; 3],
            _ => [x, y, z],
        })
    });
    Graph {
        opacity: opacity.collect::<Vec<_>>().into(),
        ..graph.clone()
    }
}

/// Light by node.
pub fn lights(graph: &Graph) -> Vec<[u16; 3]> {
    (0..graph.len() as u16)
        .map(|i| [0, 1, 2].map(|c| i.wrapping_mul(40_503).rotate_left(5 * c)))
        .collect()
}

/// Sets a frame up.
pub fn setup(graph: &Graph, camera: &Camera, options: &SetupOptions) -> FrameSetup {
    FrameSetup::new(camera, &graph.placement, graph.depth, options).expect("a frame")
}

/// Draws with the machine; as it is by default, with the fast engine too.
pub fn draw_with(
    options: MachineOptions,
    graph: &Graph,
    setup: &FrameSetup,
) -> Result<(Frame, Stats), EngineError> {
    let mut frame = Frame::new(setup.width, setup.height, false);
    let stats = Machine::new(options).render(&graph.view(), setup, &mut frame)?;
    if options == MachineOptions::default() {
        // Each test of the machine tests the default engine too.
        let mut fast = Frame::new(setup.width, setup.height, false);
        Fast::new(FastOptions::default(), Box::new(Machine::new(options)))
            .render(&graph.view(), setup, &mut fast)
            .expect("what the machine draws");
        assert!(fast == frame, "the fast engine draws other bits");
    }
    Ok((frame, stats))
}

/// Draws with the machine as it is.
pub fn draw(graph: &Graph, setup: &FrameSetup) -> Frame {
    draw_with(MachineOptions::default(), graph, setup)
        .expect("no overflow")
        .0
}

/// One number of a frame's statistics.
pub fn stat(stats: &Stats, name: &str) -> u64 {
    stats
        .iter()
        .find(|(n, _)| *n == name)
        .unwrap_or_else(|| panic!("no statistic {name}"))
        .1
}
