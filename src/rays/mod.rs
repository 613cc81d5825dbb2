//! The exact oracle: for every sample, the nearest solid cell on its ray, of the graph as level of detail cuts it
//! (`spec/rays.md`).
//!
//! It starts from the same integers as every other engine and computes in integers that cannot overflow, so its picture
//! is the meaning of *exact*. It is simple enough to be checked by reading, and shares no code with the other engines.
//! Drawing rule, cage and tolerance are ignored: a sample shows the voxel at its centre.

mod line;
mod number;
mod ray_frame;
mod search;

use rayon::prelude::*;

use crate::frame::{Frame, NO_NODE, NO_VOXEL};
use crate::graph::GraphView;
use crate::project::{Engine, EngineError, FrameSetup, Stats};

use number::{Number, Wide};
use ray_frame::RayFrame;
use search::Search;

/// The exact oracle.
#[derive(Debug, Clone, Copy, Default)]
pub struct Rays;

impl Engine for Rays {
    /// Never fails. `frame.records` is the number of nodes whose cube was tested against the sample's ray.
    fn render(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
    ) -> Result<Stats, EngineError> {
        let view = RayFrame::new(setup);
        let tested = if view.fits_i128() {
            render_rows::<i128>(graph, &view, frame)
        } else {
            render_rows::<Wide>(graph, &view, frame)
        };
        Ok(vec![
            ("samples", frame.node.len() as u64),
            ("samples_drawn", frame.drawn() as u64),
            ("nodes_tested", tested),
        ])
    }
}

/// Single rays of a frame, as [`Rays`] draws them, for pictures with too many samples for a frame.
pub struct Caster<'g> {
    graph: &'g GraphView<'g>,
    view: RayFrame,
    is_narrow: bool,
}

/// Most levels of an image root whose rays can be cast: components of rays are at most `2^18`.
pub const MAX_CASTER_LEVELS: u32 = 17;

impl<'g> Caster<'g> {
    /// The rays of a frame whose image root has at most [`MAX_CASTER_LEVELS`] levels. If `setup.levels` is raised and
    /// nothing else changed, the samples are those of a finer grid in the same picture. They see the graph as the frame's
    /// level of detail cuts it; references start from [`FrameSetup::without_detail`].
    pub fn new(graph: &'g GraphView<'g>, setup: &FrameSetup) -> Self {
        debug_assert!(setup.levels <= MAX_CASTER_LEVELS);
        let view = RayFrame::new(setup);
        let is_narrow = view.fits_i128();
        Self {
            graph,
            view,
            is_narrow,
        }
    }

    /// Graph node and voxel, as a frame stores them, of sample `(x, y)`.
    pub fn nearest(&self, x: u32, y: u32) -> Option<(u32, [i32; 4])> {
        if self.is_narrow {
            Search::<i128>::new(self.graph, &self.view, x, y).nearest()
        } else {
            Search::<Wide>::new(self.graph, &self.view, x, y).nearest()
        }
    }
}

/// Draws every row, on all threads; returns the number of tested cubes.
fn render_rows<N: Number>(graph: &GraphView<'_>, view: &RayFrame, frame: &mut Frame) -> u64 {
    let width = frame.width as usize;
    if width == 0 {
        return 0;
    }
    let record_rows: Vec<Option<&mut [f32]>> = match &mut frame.records {
        Some(records) => records.chunks_mut(width).map(Some).collect(),
        None => (0..frame.height).map(|_| None).collect(),
    };
    // Without a buffer of voxels, they are not stored.
    let mut unwanted = Vec::new();
    let voxels = if frame.voxel.is_empty() {
        unwanted.resize(frame.node.len(), NO_VOXEL);
        &mut unwanted
    } else {
        &mut frame.voxel
    };
    frame
        .node
        .par_chunks_mut(width)
        .zip(voxels.par_chunks_mut(width))
        .zip(record_rows)
        .enumerate()
        .map(|(j, ((nodes, voxels), mut records))| {
            let mut tested_in_row = 0u64;
            for i in 0..width {
                let mut walk = Search::<N>::new(graph, view, i as u32, j as u32);
                let seen = walk.nearest();
                (nodes[i], voxels[i]) = seen.unwrap_or((NO_NODE, NO_VOXEL));
                if let Some(records) = &mut records {
                    records[i] = walk.tested as f32;
                }
                tested_in_row += walk.tested;
            }
            tested_in_row
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::Placement;
    use crate::project::{Camera, SetupOptions};

    fn set_up(eye: [f64; 3], depth: u32) -> FrameSetup {
        let eye = glam::DVec3::from_array(eye);
        let camera = Camera {
            eye,
            target: eye + glam::DVec3::Y,
            up: glam::DVec3::Z,
            fov_degrees: 90.0,
            width: 32,
            height: 32,
        };
        FrameSetup::new(
            &camera,
            &Placement::default(),
            depth,
            &SetupOptions::default(),
        )
        .expect("the camera can see")
        // Depths in other units: the numbers below are scaled, `lod_depth` is not.
        .without_detail()
    }

    #[test]
    fn both_widths_of_number_draw_the_same() {
        // Sierpinski's tetrahedron.
        let graph = GraphView {
            depth: 4,
            root: 0,
            mask: &[0b0110_1001],
            first: &[0],
            links: &[0; 4],
            opacity: &[],
            light: &[],
        };
        for eye in [[8.0, -8.0, 8.0], [3.0, 2.0, 4.0], [16.0, 0.0, 0.5]] {
            let setup = set_up(eye, 4);
            let view = RayFrame::new(&setup);
            assert!(view.fits_i128());
            let mut narrow = Frame::new(32, 32, true);
            let mut wide = narrow.clone();
            render_rows::<i128>(&graph, &view, &mut narrow);
            render_rows::<Wide>(&graph, &view, &mut wide);
            assert_eq!(narrow, wide);
            assert!(narrow.drawn() > 0);

            // The same view in greater numbers no longer fits 128 bits.
            let mut huge = setup.clone();
            let numbers = setup.edge_clip.iter().flatten().chain(&setup.origin_clip);
            let spare = numbers.map(|c| c.abs().leading_zeros()).min().unwrap_or(0) - 2;
            huge.origin_clip = setup.origin_clip.map(|c| c << spare);
            huge.edge_clip = setup.edge_clip.map(|e| e.map(|c| c << spare));
            assert!(!RayFrame::new(&huge).fits_i128());
            let mut from_huge = narrow.clone();
            Rays.render(&graph, &huge, &mut from_huge)
                .expect("never fails");
            assert_eq!(narrow, from_huge);
        }
    }
}
