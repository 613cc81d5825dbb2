//! The ray caster as hardware: every step counted while it is executed.
//!
//! So that the comparison with the machine is fair to the ray caster, its rays
//! are made as cheaply as a ray can be: one direction added to the last along a
//! row, the eye as the origin of all; nothing is charged for the first of a row.

use serde::Serialize;

use super::arithmetic::{Arithmetic, FloatStep};
use super::caster::Caster;
use super::{MAX_LEVEL, Rays};
use crate::frame::Frame;
use crate::graph::GraphView;
use crate::project::FrameSetup;

/// Steps of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct FloatRayCounts {
    steps: [u64; FloatStep::ALL.len()],
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

/// Counts steps, and calls `nodes` for every node that is read.
struct Counting<'n> {
    counts: FloatRayCounts,
    nodes: &'n mut dyn FnMut(u32),
}

impl Arithmetic for Counting<'_> {
    #[inline]
    fn count(&mut self, step: FloatStep, times: u32) {
        self.counts.steps[step as usize] += u64::from(times);
    }

    #[inline]
    fn node(&mut self, node: u32) {
        self.counts.steps[FloatStep::NodeRead as usize] += 1;
        (self.nodes)(node);
    }
}

/// Draws a frame in `f32` and counts what that takes. `nodes` is called
/// for every node that is read, in order.
pub fn count(
    graph: &GraphView<'_>,
    setup: &FrameSetup,
    frame: &mut Frame,
    nodes: &mut dyn FnMut(u32),
) -> FloatRayCounts {
    frame.clear();
    let rays = Rays::new(setup);
    let caster = Caster {
        graph,
        last_level: setup.depth.min(MAX_LEVEL),
        depth: setup.depth,
    };
    let mut by = Counting {
        counts: FloatRayCounts::default(),
        nodes,
    };
    let eye = rays.eye.map(|c| c as f32);
    let right = rays.right.map(|c| c as f32);
    let width = frame.width as usize;
    for (j, nodes) in frame.node.chunks_mut(width.max(1)).enumerate() {
        let mut direction = rays.direction(0, j as u32).map(|c| c as f32);
        for (i, node) in nodes.iter_mut().enumerate() {
            let mut steps = 0;
            if let Some((seen, voxel)) = caster.cast(eye, direction, &mut steps, &mut by) {
                *node = seen;
                by.count(FloatStep::PixelWrite, 1);
                if let Some(to) = frame.voxel.get_mut(j * width + i) {
                    *to = voxel;
                }
            }
            by.counts.rays += 1;
            by.counts.cells += steps;
            for k in 0..3 {
                direction[k] = by.add(direction[k], right[k]);
            }
        }
    }
    by.counts
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::graph::Silent;
    use crate::lab::float_rays::FloatRays;
    use crate::measure::CoverageError;
    use crate::project::{Camera, Engine, SetupOptions};
    use crate::scene::{OpenOptions, open};

    fn setup(spec: &str, camera: &Camera) -> (crate::graph::Graph, FrameSetup) {
        let graph = open(spec, &OpenOptions::default(), &Silent).unwrap().graph;
        let options = SetupOptions::default();
        let setup = FrameSetup::new(camera, &graph.placement, graph.depth, &options).unwrap();
        (graph, setup)
    }

    fn camera(eye: [f64; 3], target: [f64; 3], side: u32) -> Camera {
        Camera {
            eye: DVec3::from_array(eye),
            target: DVec3::from_array(target),
            up: DVec3::Z,
            fov_degrees: 60.0,
            width: side,
            height: side,
        }
    }

    #[test]
    fn a_ray_that_misses_costs_its_set_up() {
        // All components of all four directions are below 0: nothing is mirrored.
        let camera = camera([90.0, 80.0, 70.0], [70.0, 60.0, 50.0], 2);
        let (graph, setup) = setup("gen:sphere,depth=2", &camera);
        let mut frame = Frame::new(2, 2, false);
        let counts = count(&graph.view(), &setup, &mut frame, &mut |_| ());
        assert_eq!(frame.drawn(), 0);
        assert_eq!((counts.rays, counts.cells), (4, 0));
        let rays = 4;
        // The inverse of three slopes, and the bias of three planes.
        assert_eq!(counts.of(FloatStep::FloatDivide), 3 * rays);
        // Three biases, and the cube's six planes.
        assert_eq!(counts.of(FloatStep::FloatMultiply), (3 + 6) * rays);
        // The six planes, and the step to the next ray.
        assert_eq!(counts.of(FloatStep::FloatAdd), (6 + 3) * rays);
        // Three least slopes; of three planes the last and the first; 0.
        assert_eq!(counts.of(FloatStep::FloatMinMax), (3 + 2 + 2 + 1) * rays);
        assert_eq!(counts.of(FloatStep::FloatCompare), (3 + 1) * rays);
        assert_eq!(counts.of(FloatStep::NodeRead), 0);
        assert_eq!(counts.arithmetic(), (3 + 9 + 9 + 8 + 4 + 3) * rays);
    }

    #[test]
    fn it_draws_the_ray_caster_s_picture_and_tells_of_every_node() {
        let camera = camera([100.0, -45.0, 80.0], [32.0, 32.0, 20.0], 128);
        let (graph, setup) = setup("gen:terrain,depth=6", &camera);
        let mut plain = Frame::new(128, 128, false);
        let mut counted = plain.clone();
        let stats = FloatRays.render(&graph.view(), &setup, &mut plain).unwrap();
        let mut nodes = 0;
        let counts = count(&graph.view(), &setup, &mut counted, &mut |_| nodes += 1);
        let error = CoverageError::between(&counted.voxel, &plain.voxel);
        assert!(error.covered > 1000);
        assert!(error.differing() <= 8, "{error:?}");
        assert_eq!(counts.of(FloatStep::NodeRead), nodes);
        assert_eq!(counts.of(FloatStep::PixelWrite), counted.drawn() as u64);
        let steps = stats.iter().find(|(name, _)| *name == "steps").unwrap().1;
        assert!(counts.cells.abs_diff(steps) * 100 < steps);
    }
}
