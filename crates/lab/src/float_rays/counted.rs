//! The ray caster as hardware: every step counted while it is executed.
//!
//! The comparison favours the ray caster: its rays are as cheap as possible. Each direction is the last one plus a constant,
//! and the eye is the origin of all. The first ray of a row and the choice of the constant are free.

use serde::Serialize;

use super::arithmetic::{Arithmetic, FloatStep};
use super::caster::Caster;
use super::{MAX_LEVEL, RayOrder, Rays};
use shiftvox::frame::Frame;
use shiftvox::graph::{GraphView, NodeLayout};
use shiftvox::project::FrameSetup;

/// Steps of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct FloatRayCounts {
    steps: [u64; FloatStep::ALL.len()],
    /// Of those, the ones that had to follow one another within a ray.
    waits: [u64; FloatStep::ALL.len()],
    /// Rays cast: one a sample.
    pub rays: u64,
    /// Cells that rays examined.
    pub cells: u64,
}

impl FloatRayCounts {
    /// Steps of one kind.
    pub fn of(&self, step: FloatStep) -> u64 {
        self.steps[step as usize]
    }

    /// Steps of one kind in the rays' longest chains.
    pub fn waits(&self, step: FloatStep) -> u64 {
        self.waits[step as usize]
    }

    /// Adds steps of one kind, so many of them in the longest chain.
    pub fn add(&mut self, step: FloatStep, times: u64, waits: u64) {
        self.steps[step as usize] += times;
        self.waits[step as usize] += waits;
    }

    /// All steps that are arithmetic, and not accesses to a memory.
    pub fn arithmetic(&self) -> u64 {
        let of = |step: &FloatStep| self.of(*step);
        FloatStep::ALL[..=FloatStep::Shift as usize]
            .iter()
            .map(of)
            .sum()
    }
}

/// A read of a ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RayRead {
    /// A word of a node, by its place among all words.
    Node(u64),
    /// Colour and normal of a node.
    Attribute(u32),
}

/// Counts steps, and calls `reads` for every node and attribute that is read.
struct Counting<'n> {
    counts: FloatRayCounts,
    reads: &'n mut dyn FnMut(RayRead),
}

impl Arithmetic for Counting<'_> {
    #[inline]
    fn count(&mut self, step: FloatStep, times: u32) {
        self.counts.steps[step as usize] += u64::from(times);
    }

    #[inline]
    fn wait(&mut self, step: FloatStep, times: u32) {
        self.counts.waits[step as usize] += u64::from(times);
    }

    #[inline]
    fn node(&mut self, word: u64) {
        self.counts.steps[FloatStep::NodeRead as usize] += 1;
        (self.reads)(RayRead::Node(word));
    }
}

/// Draws a frame in `f32`, its rays in `order`, and counts the steps. `reads` gets every read, in order.
pub fn count(
    graph: &GraphView<'_>,
    setup: &FrameSetup,
    frame: &mut Frame,
    order: RayOrder,
    layout: NodeLayout,
    reads: &mut dyn FnMut(RayRead),
) -> FloatRayCounts {
    frame.clear();
    let rays = Rays::new(setup);
    let caster = Caster {
        graph,
        last_level: setup.depth.min(MAX_LEVEL),
        depth: setup.depth,
        layout,
    };
    let mut by = Counting {
        counts: FloatRayCounts::default(),
        reads,
    };
    let eye = rays.eye.map(|c| c as f32);
    let right = rays.right.map(|c| c as f32);
    let width = frame.width as usize;
    let mut direction = [0f32; 3];
    order.for_each(frame.width, frame.height, |i, j| {
        // Sums drift along a row; the other orders' rays are taken as they should be.
        if i == 0 || order != RayOrder::Rows {
            direction = rays.direction(i, j).map(|c| c as f32);
        }
        let mut steps = 0;
        if let Some((seen, voxel)) = caster.cast(eye, direction, &mut steps, &mut by) {
            let at = j as usize * width + i as usize;
            frame.node[at] = seen;
            by.count(FloatStep::AttributeRead, 1);
            (by.reads)(RayRead::Attribute(seen));
            by.count(FloatStep::PixelWrite, 1);
            if let Some(to) = frame.voxel.get_mut(at) {
                *to = voxel;
            }
        }
        by.counts.rays += 1;
        by.counts.cells += steps;
        by.wait(FloatStep::FloatAdd, 1);
        for k in 0..3 {
            direction[k] = by.add(direction[k], right[k]);
        }
    });
    by.counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    use crate::float_rays::FloatRays;
    use crate::measure::CoverageError;
    use shiftvox::frame::NO_NODE;
    use shiftvox::graph::{Graph, Silent};
    use shiftvox::project::{Camera, Engine, SetupOptions};
    use shiftvox::rays::Rays as Oracle;
    use shiftvox_mesh::open::{OpenOptions, open};

    /// Eye and target in sides of the object's cube.
    fn scene(spec: &str, eye: [f64; 3], target: [f64; 3], side: u32) -> (Graph, FrameSetup) {
        let spec = format!("gen:{spec}");
        let graph = open(&spec, &OpenOptions::default(), &Silent).unwrap().graph;
        let low = DVec3::from_array(graph.placement.origin_index.map(|c| c as f64));
        let in_world = |at: [f64; 3]| low + DVec3::from_array(at) * f64::from(1u32 << graph.depth);
        let camera = Camera {
            eye: in_world(eye),
            target: in_world(target),
            up: DVec3::Z,
            fov_degrees: 60.0,
            width: side,
            height: side,
        };
        let options = SetupOptions::default();
        let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, &options).unwrap();
        (graph, setup)
    }

    fn counted(
        (graph, setup): &(Graph, FrameSetup),
        order: RayOrder,
        layout: NodeLayout,
    ) -> (Frame, FloatRayCounts, Vec<RayRead>) {
        let mut frame = Frame::new(setup.width, setup.height, false);
        let mut reads = Vec::new();
        let mut note = |read| reads.push(read);
        let counts = count(&graph.view(), setup, &mut frame, order, layout, &mut note);
        (frame, counts, reads)
    }

    #[test]
    fn a_ray_that_misses_costs_its_set_up() {
        // All components of all four directions are below 0: nothing is mirrored.
        let scene = scene("sphere,depth=2", [22.5, 20.0, 17.5], [17.5, 15.0, 12.5], 2);
        let (frame, counts, _) = counted(&scene, RayOrder::Rows, NodeLayout::default());
        assert_eq!((frame.drawn(), counts.rays, counts.cells), (0, 4, 0));
        // Steps per ray, and those one after the other.
        for (step, steps, waits) in [
            // The inverse of three slopes.
            (FloatStep::FloatDivide, 3, 1),
            // Three biases, and the cube's six planes.
            (FloatStep::FloatMultiply, 3 + 6, 2),
            // The six planes, and the step to the next ray.
            (FloatStep::FloatAdd, 6 + 3, 2),
            // Three least slopes, the last and the first of three planes, and 0.
            (FloatStep::FloatMinMax, 3 + 2 + 2 + 1, 4),
            (FloatStep::FloatCompare, 3 + 1, 1),
            (FloatStep::NodeRead, 0, 0),
            (FloatStep::AttributeRead, 0, 0),
        ] {
            let found = (counts.of(step), counts.waits(step));
            assert_eq!(found, (steps * 4, waits * 4), "{step:?}");
        }
        assert_eq!(counts.arithmetic(), (3 + 9 + 9 + 8 + 4 + 3) * 4);
    }

    #[test]
    fn it_sees_what_the_oracle_sees() {
        // All octants of direction, and far away.
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
        for (spec, side, views) in [
            ("terrain,depth=8", 256, &outside[..]),
            ("menger,depth=4", 256, &outside),
            ("menger,depth=3", 256, &inside),
            ("sierpinski,depth=9", 256, &inside),
            ("sphere,depth=6", 256, &inside),
            ("sphere,depth=1", 17, &along),
        ] {
            for &(eye, target) in views {
                let scene = scene(spec, eye, target, side);
                let (graph, setup) = &scene;
                let mut exact = Frame::new(side, side, false);
                let mut plain = exact.clone();
                // It has no level of detail.
                let whole = setup.without_detail();
                Oracle.render(&graph.view(), &whole, &mut exact).unwrap();
                let stats = FloatRays.render(&graph.view(), setup, &mut plain).unwrap();
                let (frame, counts, _) = counted(&scene, RayOrder::Rows, NodeLayout::default());
                for (drawn, one_of) in [(&plain, 5000), (&frame, 1500)] {
                    let error = CoverageError::between(&drawn.voxel, &exact.voxel);
                    let is_near = error.covered > 0 && error.differing() * one_of <= error.pixels;
                    assert!(is_near, "{spec} from {eye:?}: {error:?}");
                }
                let mut samples = plain.voxel.iter().zip(&plain.node);
                assert!(samples.all(|(voxel, node)| (voxel[3] < 0) == (*node == NO_NODE)));
                assert_eq!(stats[1], ("samples_drawn", plain.drawn() as u64));
                let steps = stats[2].1;
                assert!(steps < 200 * u64::from(side * side), "{stats:?}");
                assert!(counts.cells.abs_diff(steps) * 100 < steps);
            }
        }
    }

    #[test]
    fn every_read_is_reported_in_every_order() {
        let scene = scene("terrain,depth=6", [1.6, -0.7, 1.25], [0.5, 0.5, 0.3], 128);
        let masks = NodeLayout::new(&scene.0.view(), true, false);
        let mut first: Option<(Frame, u64)> = None;
        for order in RayOrder::ALL {
            let (frame, counts, reads) = counted(&scene, order, NodeLayout::default());
            // Each ray that hits reads the attribute of its voxel.
            let attributes = reads.iter().filter_map(|read| match read {
                RayRead::Attribute(node) => Some(*node),
                RayRead::Node(_) => None,
            });
            let mut attributes: Vec<u32> = attributes.collect();
            let shown = frame.node.iter().copied().filter(|&node| node != NO_NODE);
            let mut shown: Vec<u32> = shown.collect();
            attributes.sort_unstable();
            shown.sort_unstable();
            assert_eq!(attributes, shown);
            let (hits, node_reads) = (shown.len() as u64, counts.of(FloatStep::NodeRead));
            assert_eq!(counts.of(FloatStep::AttributeRead), hits);
            assert_eq!(counts.of(FloatStep::PixelWrite), hits);
            assert_eq!(
                (counts.rays, node_reads + hits),
                (128 * 128, reads.len() as u64)
            );
            // A node that says which children are leaves saves each ray that hits the last read.
            let (same, with_masks, _) = counted(&scene, order, masks);
            assert_eq!(same, frame);
            assert_eq!(with_masks.of(FloatStep::NodeRead) + hits, node_reads);
            // A chain is no longer than all steps of a kind.
            let mut steps = FloatStep::ALL.into_iter();
            assert!(steps.all(|step| counts.waits(step) <= counts.of(step)));
            // All orders draw the same, but for roundings.
            let (rows, all) = first.get_or_insert((frame.clone(), counts.arithmetic()));
            let error = CoverageError::between(&frame.voxel, &rows.voxel);
            assert!(error.covered > 1000 && error.differing() <= 8, "{error:?}");
            assert!(counts.arithmetic().abs_diff(*all) * 100 < *all);
        }
    }
}
