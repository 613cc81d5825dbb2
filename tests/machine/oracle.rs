//! The oracle against a second, slower way to the same truth: every cell cut with every ray in rational numbers, the
//! tie rule as a tiny real offset.

use num_bigint::{BigInt, Sign};
use num_rational::BigRational;
use proptest::prelude::*;
use shiftvox::frame::{Frame, NO_NODE, NO_VOXEL};
use shiftvox::graph::{Graph, GraphView};
use shiftvox::project::{Engine, FrameSetup, SetupOptions};
use shiftvox::rays::Rays;

use crate::common::{any_graph, any_view, cases};
use crate::scenes::Dice;

/// A solid cell: node, lowest corner, level.
type Cell = (u32, [i64; 3], u32);

/// Level of detail: whether all eight vertices of a node are at least at the level's depth.
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
fn cells(graph: &GraphView<'_>, setup: &FrameSetup, (node, lo, level): Cell, out: &mut Vec<Cell>) {
    let is_leaf = level == graph.depth || graph.mask(node) == 0;
    if is_leaf || is_solid_by_detail(setup, lo, level) {
        out.push((node, lo, level));
        return;
    }
    let half = 1i64 << (graph.depth - level - 1);
    for octant in 0..8u8 {
        if let Some(child) = graph.child(node, octant) {
            let lo = [0, 1, 2].map(|k| lo[k] + half * i64::from(octant >> (2 - k) & 1));
            cells(graph, setup, (child, lo, level + 1), out);
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

    /// The ray's parameter where it meets the plane of coordinate `k` at `at`.
    fn meets(&self, direction: &[BigInt; 3], k: usize, at: i64) -> BigRational {
        let way = &self.whole * at - &self.eye[k];
        match direction[k].sign() {
            Sign::Minus => BigRational::new_raw(-way, -&direction[k]),
            Sign::NoSign => panic!("an offset ray is parallel to no plane"),
            Sign::Plus => BigRational::new_raw(way, direction[k].clone()),
        }
    }

    fn nearest(&self, direction: &[BigInt; 3], depth: u32, cells: &[Cell]) -> (u32, [i32; 4]) {
        let entered = cells.iter().filter_map(|cell| {
            let &(node, lo, level) = cell;
            let side = 1i64 << (depth - level);
            let planes = [0, 1, 2].map(|k| {
                let [a, b] = [lo[k], lo[k] + side].map(|at| self.meets(direction, k, at));
                if a < b { (a, b) } else { (b, a) }
            });
            let [near, far] = [planes.clone().map(|p| p.0), planes.map(|p| p.1)];
            let zero = BigRational::from(BigInt::from(0));
            let from = near.into_iter().fold(zero, BigRational::max);
            let [x, y, z] = lo.map(|c| c as i32);
            let cell = (node, [x, y, z, level as i32]);
            far.iter().all(|to| from < *to).then_some((from, cell))
        });
        let nearest = entered.min_by(|a, b| a.0.cmp(&b.0));
        nearest.map_or((NO_NODE, NO_VOXEL), |(_, cell)| cell)
    }
}

fn assert_exact(graph: &Graph, setup: &FrameSetup) {
    let view = graph.view();
    let mut frame = Frame::new(setup.width, setup.height, true);
    let drawn = Rays::default().render(&view, setup, &mut frame);
    drawn.expect("the oracle never fails");
    let exact = Exact::new(setup);
    let mut all = Vec::new();
    cells(&view, setup, (view.root, [0; 3], 0), &mut all);
    for (sample, (&node, &voxel)) in (0..).zip(frame.node.iter().zip(&frame.voxel)) {
        let (i, j) = (sample % setup.width, sample / setup.width);
        let expected = exact.nearest(&exact.direction(setup, i, j), graph.depth, &all);
        assert_eq!((node, voxel), expected, "sample ({i}, {j}) of {setup:?}");
    }
    let records = frame.records.as_ref().expect("asked for");
    assert!(records.iter().all(|&tested| tested >= 1.0));
}

proptest! {
    #![proptest_config(cases(360))]

    /// In words of many widths: coarse views are exact for their own integers.
    #[test]
    fn every_sample_is_that_of_rational_numbers(
        (graph, camera) in any_view(any_graph(0..4), 1..10),
        seed: u64,
    ) {
        let mut dice = Dice::new(seed);
        let mut options = SetupOptions::default();
        if dice.below(6) == 0 {
            options.bits = 16 + dice.below(20);
            options.frac = Some(dice.below(6));
            options.aa_log2 = dice.below(2);
        }
        // Some of these views have no volume left.
        if let Ok(setup) = FrameSetup::new(&camera, &graph.placement, graph.depth, &options) {
            assert_exact(&graph, &setup);
        }
    }
}
