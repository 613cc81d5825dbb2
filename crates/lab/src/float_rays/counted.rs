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
    #[must_use]
    pub fn of(&self, step: FloatStep) -> u64 {
        self.steps[step as usize]
    }

    /// Steps of one kind in the rays' longest chains.
    #[must_use]
    pub fn waits(&self, step: FloatStep) -> u64 {
        self.waits[step as usize]
    }

    /// Adds steps of one kind, so many of them in the longest chain.
    pub fn add(&mut self, step: FloatStep, times: u64, waits: u64) {
        self.steps[step as usize] += times;
        self.waits[step as usize] += waits;
    }

    /// All steps that are arithmetic, and not accesses to a memory.
    #[must_use]
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
    use shiftvox_mesh::open::{OpenOptions, open};

    fn scene(spec: &str, eye: [f64; 3], target: [f64; 3], side: u32) -> (Graph, FrameSetup) {
        let camera = Camera {
            eye: DVec3::from_array(eye),
            target: DVec3::from_array(target),
            up: DVec3::Z,
            fov_degrees: 60.0,
            width: side,
            height: side,
        };
        let graph = open(spec, &OpenOptions::default(), &Silent).unwrap().graph;
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
        let scene = scene(
            "gen:sphere,depth=2",
            [90.0, 80.0, 70.0],
            [70.0, 60.0, 50.0],
            2,
        );
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
    fn it_draws_the_ray_caster_s_picture_and_reports_every_read() {
        let scene = scene(
            "gen:terrain,depth=6",
            [100.0, -45.0, 80.0],
            [32.0, 32.0, 20.0],
            128,
        );
        let (graph, setup) = &scene;
        let mut plain = Frame::new(128, 128, false);
        let stats = FloatRays.render(&graph.view(), setup, &mut plain).unwrap();
        let (frame, counts, reads) = counted(&scene, RayOrder::Rows, NodeLayout::default());
        assert!(counts.cells.abs_diff(stats[2].1) * 100 < stats[2].1);
        // Each ray that hits reads the attribute of its voxel.
        let attributes = reads.iter().filter_map(|read| match read {
            RayRead::Attribute(node) => Some(*node),
            RayRead::Node(_) => None,
        });
        let shown = frame.node.iter().copied().filter(|&node| node != NO_NODE);
        assert!(attributes.eq(shown));
        let (hits, node_reads) = (frame.drawn() as u64, counts.of(FloatStep::NodeRead));
        assert_eq!(counts.of(FloatStep::AttributeRead), hits);
        assert_eq!(counts.of(FloatStep::PixelWrite), hits);
        assert_eq!(node_reads + hits, reads.len() as u64);
        // A node that says which children are leaves saves each ray that hits the last read.
        let masks = NodeLayout::new(&graph.view(), true, false);
        let (same, with_masks, _) = counted(&scene, RayOrder::Rows, masks);
        assert_eq!(same, frame);
        assert_eq!(with_masks.of(FloatStep::NodeRead) + hits, node_reads);
        // A chain is no longer than all steps of a kind.
        for step in FloatStep::ALL {
            assert!(counts.waits(step) <= counts.of(step), "{step:?}");
        }
        // All orders draw the same, but for roundings.
        for order in RayOrder::ALL {
            let (frame, other, _) = counted(&scene, order, NodeLayout::default());
            let error = CoverageError::between(&frame.voxel, &plain.voxel);
            assert!(error.covered > 1000 && error.differing() <= 8, "{error:?}");
            assert_eq!(other.rays, counts.rays);
            assert!(other.arithmetic().abs_diff(counts.arithmetic()) * 100 < counts.arithmetic());
        }
    }
}
