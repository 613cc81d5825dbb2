//! A ray caster in `f32`: the stand-in for renderers that are not ours.
//!
//! One ray per sample traverses the octree with a stack and visits children in order (Revelles, Urena, Lastra 2000, in the
//! form of Laine and Karras, *Efficient Sparse Voxel Octrees*, 2010). The first leaf ends a ray.
//!
//! The object is the cube `[1, 2]^3`, so that a cell's position along an axis
//! is the mantissa of an `f32` and its level a bit of it. Space is mirrored
//! where the ray runs upwards; in mirrored space it runs downwards on every axis.

mod caster;

use caster::Caster;

use shiftvox::frame::Frame;
use shiftvox::graph::GraphView;
use shiftvox::project::vector::cross;
use shiftvox::project::{Engine, EngineError, FrameSetup, Stats};

/// Bits of an `f32`'s mantissa, which are also the levels that positions resolve.
const MANTISSA_BITS: u32 = 23;
/// Deepest level that is examined; nodes there are drawn as one voxel.
pub const MAX_LEVEL: u32 = MANTISSA_BITS - 2;
/// Least magnitude of a direction's component, so that its inverse is finite
/// and products with it stay far from overflow.
const LEAST_SLOPE: f32 = 1.0 / (1 << MANTISSA_BITS) as f32;

/// The ray caster in floating point. A sample shows what its centre sees, within the precision of `f32`, whatever rule,
/// cage, tolerance and level of detail the set-up has.
#[derive(Debug, Clone, Copy, Default)]
pub struct FloatRays;

impl Engine for FloatRays {
    /// Fails only if the system refuses the memory of a frame. `steps` counts the cells that rays examined.
    fn render(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
    ) -> Result<Stats, EngineError> {
        frame.fit(setup.width, setup.height, false)?;
        frame.clear();
        let rays = Rays::new(setup);
        let caster = Caster {
            graph,
            last_level: setup.depth.min(MAX_LEVEL),
            depth: setup.depth,
        };
        let (mut steps, mut drawn) = (0, 0);
        let width = frame.width as usize;
        let rows = frame.node.chunks_mut(width.max(1));
        for (j, nodes) in rows.enumerate() {
            for (i, node) in nodes.iter_mut().enumerate() {
                let (origin, direction) = rays.of_sample(i as u32, j as u32);
                if let Some((seen, voxel)) = caster.cast(origin, direction, &mut steps) {
                    *node = seen;
                    // None where the frame is of nodes alone.
                    if let Some(to) = frame.voxel.get_mut(j * width + i) {
                        *to = voxel;
                    }
                    drawn += 1;
                }
            }
        }
        Ok(vec![
            ("samples", frame.node.len() as u64),
            ("samples_drawn", drawn),
            ("steps", steps),
        ])
    }
}

/// The rays of a frame, in the object's cube `[1, 2]^3`.
struct Rays {
    eye: [f64; 3],
    /// Direction of the first sample's ray, and its change for each sample
    /// right and down.
    first: [f64; 3],
    right: [f64; 3],
    down: [f64; 3],
}

impl Rays {
    /// Inverts the frame's view: once a frame, in `f64`.
    fn new(setup: &FrameSetup) -> Self {
        let (voxels, eye) = inverse(setup);
        let side = (1u64 << setup.depth) as f64;
        let object = |clip: [f64; 3]| voxels(clip).map(|c| c / side);
        let sample = 1.0 / (1u64 << setup.levels) as f64;
        // The first sample's centre is half a sample from the corner.
        let first = object([sample / 2.0, sample / 2.0, 1.0]);
        let longest = first.iter().fold(0.0f64, |most, c| most.max(c.abs()));
        let unit = 1.0 / longest;
        Self {
            eye: eye.map(|c| 1.0 + c / side),
            first: first.map(|c| c * unit),
            right: object([sample, 0.0, 0.0]).map(|c| c * unit),
            down: object([0.0, sample, 0.0]).map(|c| c * unit),
        }
    }

    fn direction(&self, i: u32, j: u32) -> [f64; 3] {
        let (i, j) = (f64::from(i), f64::from(j));
        std::array::from_fn(|k| self.first[k] + self.right[k] * i + self.down[k] * j)
    }

    /// Origin and direction of a sample's ray. The origin is where the ray
    /// comes near the cube, so that `f32` keeps its digits for the way inside.
    fn of_sample(&self, i: u32, j: u32) -> ([f32; 3], [f32; 3]) {
        let direction = self.direction(i, j);
        let to_centre: [f64; 3] = std::array::from_fn(|k| 1.5 - self.eye[k]);
        let nearest = dot(to_centre, direction) / dot(direction, direction);
        // Half the cube's diagonal is below 1.
        let length = dot(direction, direction).sqrt();
        let start = (nearest - 1.0 / length).max(0.0);
        let origin = std::array::from_fn(|k| (self.eye[k] + direction[k] * start) as f32);
        (origin, direction.map(|c| c as f32))
    }
}

/// The inverse of a frame's view: the object's coordinates of a clip vector, and those of the eye, in voxels.
pub(crate) fn inverse(setup: &FrameSetup) -> (impl Fn([f64; 3]) -> [f64; 3], [f64; 3]) {
    let edge = setup.edge_clip.map(|e| e.map(|c| c as f64));
    let normal = [0, 1, 2].map(|k| cross(edge[(k + 1) % 3], edge[(k + 2) % 3]));
    let determinant = dot(normal[0], edge[0]);
    let object = move |clip: [f64; 3]| normal.map(|n| dot(n, clip) / determinant);
    let eye = object(setup.origin_clip.map(|c| -(c as f64)));
    (object, eye)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::measure::CoverageError;
    use crate::model::frame::reference;
    use crate::rival::views;
    use shiftvox::frame::NO_NODE;

    #[test]
    fn it_sees_what_the_oracle_sees() {
        for (name, graph, setup) in views() {
            // It has no level of detail.
            let exact = reference(&graph.view(), &setup).unwrap();
            let mut plain = Frame::new(setup.width, setup.height, false);
            let stats = FloatRays.render(&graph.view(), &setup, &mut plain).unwrap();
            let error = CoverageError::between(&plain.voxel, &exact.voxel);
            let is_near = error.covered > 0 && error.differing() * 5000 <= error.pixels;
            assert!(is_near, "{name}: {error:?}");
            let mut samples = plain.voxel.iter().zip(&plain.node);
            assert!(samples.all(|(voxel, node)| (voxel[3] < 0) == (*node == NO_NODE)));
            assert_eq!(stats[1], ("samples_drawn", plain.drawn() as u64));
            assert!(stats[2].1 < 200 * stats[0].1, "{stats:?}");
        }
    }
}
