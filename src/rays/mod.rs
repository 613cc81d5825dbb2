//! The exact oracle: for every sample, the nearest solid cell on its ray (`spec/rays.md`). It shares no code with the
//! other engines, and ignores drawing rule, cage and tolerance.

mod line;
mod number;
mod ray_frame;
mod search;

use rayon::prelude::*;

use crate::frame::{Frame, NO_NODE, NO_VOXEL};
use crate::graph::GraphView;
use crate::project::{Engine, EngineError, FrameSetup, Rendered, Stop};

use number::{Number, Wide};
use ray_frame::RayFrame;
use search::Search;

/// The exact oracle.
#[derive(Debug, Clone, Default)]
pub struct Rays {
    stop: Stop,
}

impl Rays {
    /// An oracle that `stop` ends.
    #[must_use]
    pub fn stopped_by(stop: &Stop) -> Self {
        Self { stop: stop.clone() }
    }
}

impl Engine for Rays {
    /// Fails only if the system refuses the memory of a frame, or if it is stopped. `frame.records` is the number of cubes
    /// tested against the sample's ray.
    fn render(&mut self, graph: &GraphView<'_>, setup: &FrameSetup, frame: &mut Frame) -> Rendered {
        frame.fit(setup.width, setup.height, false)?;
        let view = RayFrame::new(setup);
        let tested = if view.fits_i128() {
            render_rows::<i128>(graph, &view, frame, &self.stop)
        } else {
            render_rows::<Wide>(graph, &view, frame, &self.stop)
        };
        let tested = tested.ok_or(EngineError::Stopped)?;
        Ok(vec![
            ("samples", frame.node.len() as u64),
            ("samples_drawn", frame.drawn() as u64),
            ("nodes_tested", tested),
        ])
    }
}

/// Single rays of a frame, for pictures with too many samples for a frame.
pub struct Caster<'g> {
    graph: &'g GraphView<'g>,
    view: RayFrame,
    is_narrow: bool,
}

/// Most levels of an image root whose rays can be cast: components of rays are at most `2^18`.
pub const MAX_CASTER_LEVELS: u32 = 17;

impl<'g> Caster<'g> {
    /// The rays of a frame. If `setup.levels` is raised, to at most [`MAX_CASTER_LEVELS`], the samples are those of a
    /// finer grid in the same picture. They see the graph as the level of detail cuts it
    /// ([`FrameSetup::without_detail`]).
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

/// Returns the number of cubes tested, or `None` if it is stopped.
fn render_rows<N: Number>(
    graph: &GraphView<'_>,
    view: &RayFrame,
    frame: &mut Frame,
    stop: &Stop,
) -> Option<u64> {
    let width = frame.width as usize;
    if width == 0 {
        return Some(0);
    }
    let height = frame.height;
    let voxels = Some(&mut frame.voxel[..]).filter(|voxels| !voxels.is_empty());
    let records = frame.records.as_deref_mut();
    frame
        .node
        .par_chunks_mut(width)
        .zip(optional_rows(voxels, width, height))
        .zip(optional_rows(records, width, height))
        .enumerate()
        .map(|(j, ((nodes, mut voxels), mut records))| {
            let mut tested_in_row = 0u64;
            for i in 0..width {
                if i % 64 == 0 && stop.is_requested() {
                    return None;
                }
                let mut walk = Search::<N>::new(graph, view, i as u32, j as u32);
                let (node, voxel) = walk.nearest().unwrap_or((NO_NODE, NO_VOXEL));
                nodes[i] = node;
                if let Some(voxels) = &mut voxels {
                    voxels[i] = voxel;
                }
                if let Some(records) = &mut records {
                    records[i] = walk.tested as f32;
                }
                tested_in_row += walk.tested;
            }
            Some(tested_in_row)
        })
        .sum()
}

/// The rows of a buffer, or none for each row.
fn optional_rows<T>(buffer: Option<&mut [T]>, width: usize, height: u32) -> Vec<Option<&mut [T]>> {
    match buffer {
        Some(buffer) => buffer.chunks_mut(width).map(Some).collect(),
        None => (0..height).map(|_| None).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::project::{Camera, SetupOptions};

    #[test]
    fn both_widths_of_number_draw_the_same() {
        // Sierpinski's tetrahedron.
        let graph = GraphView {
            depth: 4,
            mask: &[0b0110_1001],
            first: &[0],
            links: &[0; 4],
            ..GraphView::default()
        };
        let draw = |setup: &FrameSetup, is_narrow| {
            assert_eq!(RayFrame::new(setup).fits_i128(), is_narrow);
            let mut frame = Frame::new(32, 32, true);
            let drawn = Rays::default().render(&graph, setup, &mut frame);
            drawn.expect("never fails");
            assert!(frame.drawn() > 0);
            frame
        };
        for eye in [[8.0, -8.0, 8.0], [3.0, 2.0, 4.0], [16.0, 0.0, 0.5]].map(glam::DVec3::from) {
            let camera = Camera::looking(eye, eye + glam::DVec3::Y, 90.0, (32, 32));
            let setup = FrameSetup::new(&camera, &Default::default(), 4, &SetupOptions::default());
            // Without `lod_depth`, which is not scaled.
            let mut setup = setup.expect("a frame").without_detail();
            let narrow = draw(&setup, true);
            // The same view in greater numbers no longer fits 128 bits.
            let numbers = setup.edge_clip.iter().flatten().chain(&setup.origin_clip);
            let spare = numbers.map(|c| c.abs().leading_zeros()).min().unwrap_or(0) - 2;
            setup.origin_clip = setup.origin_clip.map(|c| c << spare);
            setup.edge_clip = setup.edge_clip.map(|e| e.map(|c| c << spare));
            assert_eq!(narrow, draw(&setup, false));
        }
    }
}
