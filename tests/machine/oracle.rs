//! The oracle against a second, slower way to the same truth: every cell cut
//! with every ray in rational numbers, the tie rule as a tiny real offset.

use glam::DVec3;
use num_bigint::{BigInt, Sign};
use num_rational::BigRational;
use shiftvox::frame::{Frame, NO_NODE, NO_VOXEL};
use shiftvox::graph::{Graph, GraphView, Placement};
use shiftvox::project::{Camera, Engine, FrameSetup, SetupOptions};
use shiftvox::rays::Rays;

use crate::common::{self, linked, sierpinski};
use crate::scenes::Dice;

/// A graph from lists of children, `(octant, node)`.
fn listed(depth: u32, lists: &[&[(usize, u32)]]) -> Graph {
    let children = |list: &&[(usize, u32)]| {
        let mut children = [None; 8];
        for &(octant, node) in *list {
            children[octant] = Some(node);
        }
        children
    };
    linked(depth, &lists.iter().map(children).collect::<Vec<_>>())
}

/// Any node may be any other's child: trees, shared subtrees and cycles.
fn random_graph(dice: &mut Dice, depth: u32) -> Graph {
    let nodes = 2 + dice.below(6);
    let children = |node: u32| {
        let is_leaf = node > 0 && dice.below(3) == 0;
        [0; 8].map(|_| {
            let child = dice.below(nodes);
            (!is_leaf && dice.below(100) < 45).then_some(child)
        })
    };
    linked(depth, &(0..nodes).map(children).collect::<Vec<_>>())
}

/// A solid cell: node, lowest corner, level.
type Cell = (u32, [i64; 3], u32);

/// Whether level of detail takes a node for a solid: all its eight vertices
/// are at least at the level's depth.
fn is_solid_by_detail(setup: &FrameSetup, lo: [i64; 3], level: u32) -> bool {
    let enough = setup.lod_depth[level as usize];
    let side = 1i64 << (setup.depth - level);
    enough != i64::MAX
        && (0..8i64).all(|vertex| {
            let u = [0, 1, 2].map(|k| lo[k] + side * (vertex >> (2 - k) & 1));
            let w = |k: usize| BigInt::from(setup.edge_clip[k][2]) * u[k];
            BigInt::from(setup.origin_clip[2]) + w(0) + w(1) + w(2) >= BigInt::from(enough)
        })
}

/// All cells of the graph as the frame's level of detail cuts it.
fn cells(
    graph: &GraphView<'_>,
    setup: &FrameSetup,
    node: u32,
    lo: [i64; 3],
    level: u32,
    out: &mut Vec<Cell>,
) {
    let is_leaf = level == graph.depth || graph.mask(node) == 0;
    if is_leaf || is_solid_by_detail(setup, lo, level) {
        out.push((node, lo, level));
        return;
    }
    let half = 1i64 << (graph.depth - level - 1);
    for octant in 0..8u8 {
        if let Some(child) = graph.child(node, octant) {
            let above = [octant >> 2 & 1, octant >> 1 & 1, octant & 1].map(i64::from);
            let lo = [0, 1, 2].map(|k| lo[k] + half * above[k]);
            cells(graph, setup, child, lo, level + 1, out);
        }
    }
}

fn cross(a: &[BigInt; 3], b: &[BigInt; 3]) -> [BigInt; 3] {
    let minor = |i: usize, j: usize| &a[i] * &b[j] - &a[j] * &b[i];
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

fn dot(a: &[BigInt; 3], b: &[BigInt; 3]) -> BigInt {
    (0..3).map(|c| &a[c] * &b[c]).sum()
}

/// The view in big integers, solved from the set-up's clip vectors.
struct Exact {
    /// Determinant of the edges, made positive.
    whole: BigInt,
    /// Object coordinates of the eye, times `whole`.
    eye: [BigInt; 3],
    /// Rows of the inverse of the edges, times `whole`.
    inverse: [[BigInt; 3]; 3],
}

/// The offset of a ray is `2^-OFFSET` in x and `2^-2OFFSET` in y.
const OFFSET: u32 = 200;

impl Exact {
    fn new(setup: &FrameSetup) -> Self {
        let edge = setup.edge_clip.map(|e| e.map(BigInt::from));
        let mut inverse = [0, 1, 2].map(|k| cross(&edge[(k + 1) % 3], &edge[(k + 2) % 3]));
        let mut whole = dot(&inverse[0], &edge[0]);
        if whole.sign() == Sign::Minus {
            whole = -whole;
            inverse = inverse.map(|row| row.map(|c| -c));
        }
        let origin = setup.origin_clip.map(BigInt::from);
        let eye = [0, 1, 2].map(|k| -dot(&inverse[k], &origin));
        Self {
            whole,
            eye,
            inverse,
        }
    }

    fn direction(&self, setup: &FrameSetup, i: u32, j: u32) -> [BigInt; 3] {
        let one = BigInt::from(1) << (2 * OFFSET);
        let ray = [
            BigInt::from(2 * i + 1) * &one + (BigInt::from(1) << OFFSET),
            BigInt::from(2 * j + 1) * &one + 1,
            BigInt::from(1u64 << (setup.levels + 1)) * &one,
        ];
        [0, 1, 2].map(|k| dot(&self.inverse[k], &ray))
    }

    /// Where the ray meets the plane of coordinate `k` at `at`.
    fn meets(&self, direction: &[BigInt; 3], k: usize, at: i64) -> BigRational {
        let way = &self.whole * at - &self.eye[k];
        match direction[k].sign() {
            Sign::Minus => BigRational::new_raw(-way, -&direction[k]),
            Sign::NoSign => panic!("an offset ray is parallel to no plane"),
            Sign::Plus => BigRational::new_raw(way, direction[k].clone()),
        }
    }

    fn nearest(&self, direction: &[BigInt; 3], depth: u32, cells: &[Cell]) -> (u32, [i32; 4]) {
        let mut best: Option<(BigRational, &Cell)> = None;
        for cell in cells {
            let (_, lo, level) = cell;
            let side = 1i64 << (depth - level);
            let mut from = BigRational::from(BigInt::from(0));
            let mut to: Option<BigRational> = None;
            for (k, &low) in lo.iter().enumerate() {
                let a = self.meets(direction, k, low);
                let b = self.meets(direction, k, low + side);
                let (near, far) = if a < b { (a, b) } else { (b, a) };
                if near > from {
                    from = near;
                }
                if to.as_ref().is_none_or(|to| far < *to) {
                    to = Some(far);
                }
            }
            let hit = to.is_some_and(|to| from < to);
            if hit && best.as_ref().is_none_or(|(nearest, _)| from < *nearest) {
                best = Some((from, cell));
            }
        }
        best.map_or((NO_NODE, NO_VOXEL), |(_, &(node, lo, level))| {
            let [x, y, z] = lo.map(|c| c as i32);
            (node, [x, y, z, level as i32])
        })
    }
}

fn camera(eye: [f64; 3], target: [f64; 3], up: [f64; 3], fov_degrees: f64, size: u32) -> Camera {
    Camera {
        up: DVec3::from_array(up),
        fov_degrees,
        ..common::camera(eye, target, size)
    }
}

fn set_up(camera: &Camera, depth: u32) -> FrameSetup {
    FrameSetup::new(
        camera,
        &Placement::default(),
        depth,
        &SetupOptions::default(),
    )
    .expect("the test's camera can see")
}

fn draw(graph: &Graph, setup: &FrameSetup) -> Frame {
    let mut frame = Frame::new(setup.width, setup.height, true);
    Rays.render(&graph.view(), setup, &mut frame)
        .expect("the oracle never fails");
    frame
}

/// Compares every sample; returns how many were drawn.
fn assert_exact(graph: &Graph, setup: &FrameSetup) -> usize {
    let view = graph.view();
    let frame = draw(graph, setup);
    let exact = Exact::new(setup);
    let mut all = Vec::new();
    cells(&view, setup, view.root, [0; 3], 0, &mut all);
    for j in 0..setup.height {
        for i in 0..setup.width {
            let sample = (j * setup.width + i) as usize;
            let direction = exact.direction(setup, i, j);
            let expected = exact.nearest(&direction, graph.depth, &all);
            let got = (frame.node[sample], frame.voxel[sample]);
            assert_eq!(
                got,
                expected,
                "sample ({i}, {j}) of {} cells; eye {:?}, edges {:?}, graph {:?} {:?}",
                all.len(),
                setup.eye_floor,
                setup.edge_clip,
                (&graph.mask[..], &graph.first[..]),
                &graph.links[..]
            );
        }
    }
    frame.drawn()
}

#[test]
fn random_graphs_from_random_cameras() {
    let mut dice = Dice::new(1);
    let mut drawn = 0;
    for _ in 0..60 {
        let depth = 1 + dice.below(3);
        let graph = random_graph(&mut dice, depth);
        let side = f64::from(1u32 << depth);
        // Inside, near and farther away.
        let reach = [0.0, 0.5, 3.0][dice.below(3) as usize] * side;
        let eye = [(); 3].map(|()| dice.between(-reach, side + reach));
        let target = [(); 3].map(|()| dice.between(0.0, side));
        let up = [(); 3].map(|()| dice.between(-1.0, 1.0));
        let fov = dice.between(10.0, 120.0);
        drawn += assert_exact(&graph, &set_up(&camera(eye, target, up, fov, 9), depth));
    }
    assert!(drawn > 500, "only {drawn} samples show anything");
}

/// Coarse clip vectors, oblong pictures, several samples per pixel, a scene of one voxel.
#[test]
fn coarse_views_are_exact_for_their_own_integers() {
    let mut dice = Dice::new(6);
    let mut drawn = 0;
    let mut views = 0;
    while views < 60 {
        let depth = dice.below(4);
        let graph = random_graph(&mut dice, depth);
        let side = f64::from(1u32 << depth);
        let eye = [(); 3].map(|()| dice.between(-side, 2.0 * side));
        let target = [(); 3].map(|()| dice.between(0.0, side));
        let mut camera = camera(eye, target, [0.3, -0.2, 1.0], dice.between(40.0, 100.0), 9);
        camera.height = 1 + dice.below(9);
        let options = SetupOptions {
            bits: 16 + dice.below(20),
            frac: Some(dice.below(6)),
            aa_log2: dice.below(2),
            ..SetupOptions::default()
        };
        // Some of these views have no volume left.
        if let Ok(setup) = FrameSetup::new(&camera, &Placement::default(), depth, &options) {
            drawn += assert_exact(&graph, &setup);
            views += 1;
        }
    }
    assert!(drawn > 500, "only {drawn} samples show anything");
}

/// Eyes on faces, edges and corners of cells, looking along an axis with 90
/// degrees: every ray through a corner, an edge or along a face is met.
#[test]
fn ties_everywhere() {
    let mut dice = Dice::new(2);
    let mut drawn = 0;
    for round in 0..240 {
        let depth = 2 + round % 2;
        let graph = random_graph(&mut dice, depth);
        let side = 1u32 << depth;
        // Whole and half voxels, from two voxels outside to two inside the far side.
        let eye = [(); 3].map(|()| f64::from(dice.below(2 * side + 9)) / 2.0 - 2.0);
        let axis = dice.below(3) as usize;
        let sign = if dice.below(2) == 0 { 1.0 } else { -1.0 };
        let mut target = eye;
        target[axis] += sign;
        let mut up = [0.0; 3];
        up[(axis + 1 + dice.below(2) as usize) % 3] = if dice.below(2) == 0 { 1.0 } else { -1.0 };
        let size = [8, 7, 8, 16][round as usize % 4];
        drawn += assert_exact(&graph, &set_up(&camera(eye, target, up, 90.0, size), depth));
    }
    assert!(drawn > 1000, "only {drawn} samples show anything");
}

/// The middle sample of an odd picture looks exactly along the axis, and
/// others exactly along cell edges through the eye.
#[test]
fn the_axis_itself_is_decided_by_the_tie_rule() {
    let graph = linked(1, &[[Some(1); 8], [None; 8]]);
    let mut setup = set_up(
        &camera([1.0, -1.0, 1.0], [1.0, 0.0, 1.0], [0.0, 0.0, 1.0], 90.0, 2),
        1,
    );
    // Clip vectors by hand: sample (0, 0) of a 2 x 2 root is at (1/4, 1/4),
    // and X = x + y / 4, Y = -z + y / 4, W = y put the y axis there.
    setup.edge_clip = [[4, 0, 0], [1, 1, 4], [0, -4, 0]];
    setup.origin_clip = [-4 + 1, 4 + 1, 4];
    setup.eye_floor = [1, -1, 1].map(|c: i64| c << setup.sub_levels);
    setup.eye_ceil = setup.eye_floor;
    let determinant = 4 * (-(-4 * 4));
    setup.positive = determinant > 0;
    assert_exact(&graph, &setup);
    let frame = draw(&graph, &setup);
    // Moved right and down: greater x, lower z.
    assert_eq!(frame.voxel[0], [1, 0, 0, 1]);
}

#[test]
fn a_cycle_ends_at_the_finest_level() {
    for (eye, fov) in [
        ([40.0, -17.0, 25.0], 30.0),
        ([0.0, 0.0, 0.0], 90.0),
        ([3.0, 5.5, 7.0], 60.0),
    ] {
        let setup = set_up(&camera(eye, [4.0, 4.0, 4.0], [0.0, 0.0, 1.0], fov, 12), 4);
        assert!(assert_exact(&sierpinski(4), &setup) > 0);
    }
    // Too many cells to try each, but not to draw.
    let side = f64::from(1u32 << 30);
    let setup = set_up(
        &camera(
            [2.0 * side, 1.7 * side, 1.5 * side],
            [0.5 * side; 3],
            [0.0, 0.0, 1.0],
            40.0,
            32,
        ),
        30,
    )
    .without_detail();
    let frame = draw(&sierpinski(30), &setup);
    assert!(frame.voxel.iter().all(|v| v[3] == 30 || *v == NO_VOXEL));
}

#[test]
fn the_eye_is_where_the_set_up_says() {
    let mut dice = Dice::new(3);
    for _ in 0..200 {
        let depth = 1 + dice.below(12);
        let side = f64::from(1u32 << depth);
        let eye = [(); 3].map(|()| dice.between(-2.0 * side, 3.0 * side));
        let target = [(); 3].map(|()| dice.between(0.0, side));
        let setup = set_up(
            &camera(eye, target, [0.1, 0.2, 1.0], dice.between(5.0, 140.0), 64),
            depth,
        );
        let exact = Exact::new(&setup);
        for (k, &eye_k) in eye.iter().enumerate() {
            let at = BigRational::new(
                exact.eye[k].clone() << setup.sub_levels,
                exact.whole.clone(),
            );
            assert_eq!(at.floor().to_integer(), BigInt::from(setup.eye_floor[k]));
            assert_eq!(at.ceil().to_integer(), BigInt::from(setup.eye_ceil[k]));
            let unit = libm::ldexp(1.0, -(setup.sub_levels as i32));
            let off = (setup.eye_floor[k] as f64 * unit - eye_k).abs();
            // Half a unit of each clip coordinate, through a view of bounded shape.
            let allowed = 64.0 * libm::ldexp(1.0, -(setup.clip_frac as i32)) + unit;
            assert!(
                off <= allowed,
                "axis {k}: {off} voxels off at depth {depth}"
            );
        }
    }
}

/// A scene of 4 x 4 x 4 seen from the front, eight pixels across its front
/// face: 1, 2 and 5 are voxels of the front layer, 6 is hidden behind 1, 3 a
/// solid of two voxels a side that begins in the third layer, 4 one voxel in the fourth.
#[test]
fn a_picture_by_hand() {
    // x << 2 | y << 1 | z of the halves, then of the voxels in them.
    let graph = listed(
        2,
        &[
            &[(0b000, 7), (0b101, 8), (0b110, 3), (0b011, 9)],
            &[], // 1, at (0, 0, 0)
            &[], // 2, at (3, 0, 3)
            &[], // 3, at (2, 2, 0)
            &[], // 4, at (1, 3, 2)
            &[], // 5, at (1, 0, 0)
            &[], // 6, at (0, 1, 0)
            &[(0b000, 1), (0b100, 5), (0b010, 6)],
            &[(0b101, 2)],
            &[(0b110, 4)],
        ],
    );
    let fov = 2.0 * libm::atan(2.0 / 8.0).to_degrees();
    let setup = set_up(
        &camera([2.0, -8.0, 2.0], [2.0, 0.0, 2.0], [0.0, 0.0, 1.0], fov, 8),
        2,
    );
    let frame = draw(&graph, &setup);
    let picture: Vec<String> = frame
        .node
        .chunks(8)
        .map(|row| {
            row.iter()
                .map(|&n| char::from_digit(n, 10).unwrap_or('.'))
                .collect()
        })
        .collect();
    let expected = [
        "......22", //
        "......22", //
        "........", //
        "...4....", //
        "....333.", //
        "....333.", //
        "1155333.", //
        "1155....", //
    ];
    assert_eq!(picture, expected);
    assert_eq!(frame.voxel[4 * 8 + 4], [2, 2, 0, 1]);
    assert_eq!(frame.voxel[3 * 8 + 3], [1, 3, 2, 2]);
    let records = frame.records.expect("asked for");
    assert!(records.iter().all(|&tested| tested >= 1.0));
    assert_exact(&graph, &setup);
}
