//! What is done with a record by itself: it is changed to screen space, drawn or dropped, or left
//! to its children.

use hwmodel::{Memory, Probe, Short, Stage};

use super::alpha::BlendColor;
use super::blocks::{ADDRESS_BITS, Block, Port};
use super::cage::CageCoordinate;
use super::canvas::Paint;
use super::planes::Silhouette;
use super::record::{Pose, Record};
use super::size;
use super::state::State;
use super::to_screen;
use super::verdict::Verdict;
use super::watch::Watch;
use crate::frame::QuadNode;
use crate::frame::quadtree::FULL;

/// What is left to do of a record.
pub(super) enum RemainingWork {
    /// Nothing: it is drawn, hidden or dropped.
    Nothing,
    /// To push its children.
    Children,
}

impl<P: Probe, L: CageCoordinate, W: Watch> State<'_, P, L, W> {
    /// Whether all of a quadtree node is drawn.
    #[inline(always)]
    pub(super) fn is_full(&mut self, quad: QuadNode) -> bool {
        self.dp.stage(Stage::Filled);
        if !self.options.reject_filled {
            return false;
        }
        let vector = self.canvas.fill.read(&mut self.dp, quad);
        let full = self.dp.and_bits(4, vector, FULL) == FULL;
        self.dp
            .tap(Block::Filled, &Short::unsigned(vector, 4), &full);
        full
    }

    /// Draws or drops a record whose quadtree node is not full, unless its children are needed.
    #[inline(always)]
    pub(super) fn decide(&mut self, record: &mut Record<L>) -> RemainingWork {
        self.change_to_screen(record);

        self.dp.stage(Stage::OnePixel);
        let cube = &mut record.cube;
        // A record whose parent says what is a leaf reads its node only if it is subdivided.
        let is_read_late = self.layout.leaf_masks;
        if !cube.solid {
            let (node, level) = (cube.node, cube.level);
            cube.solid = level >= self.constants.depth || self.graph.mask(node) == 0;
            if !is_read_late {
                self.read_node(node, level);
            }
        }
        match self.verdict(record) {
            Verdict::DrawCentre => self.draw_centre(record),
            Verdict::DrawBox => self.draw_box(record),
            Verdict::DrawSolid => self.draw_solid(record),
            Verdict::Drop => {}
            Verdict::Subdivide if self.is_hidden(record) => self.counts.hidden += 1,
            Verdict::Subdivide => {
                // Parts of a solid have no node of their own.
                if is_read_late && !record.cube.solid {
                    self.dp.stage(Stage::OnePixel);
                    self.read_node(record.cube.node, record.cube.level);
                }
                return RemainingWork::Children;
            }
        }
        RemainingWork::Nothing
    }

    /// Reads an octree node, or what its brick has of it.
    #[inline(always)]
    fn read_node(&mut self, node: u32, level: u32) {
        for word in self.layout.words(node, level) {
            self.dp.read(Memory::Node, word);
            let data = (
                Short::unsigned(self.graph.mask(node), 8),
                Short::unsigned(self.graph.first(node), ADDRESS_BITS),
            );
            Port::NodeRead.tap(&mut self.dp, word, &data);
        }
    }

    /// Changes a record from clip space to screen space, if it may.
    #[inline(always)]
    fn change_to_screen(&mut self, record: &mut Record<L>) {
        let Pose::Clip(clip, _) = &record.pose else {
            return;
        };
        let (dp, constants, place) = (&mut self.dp, &self.constants, record.place);
        if to_screen::may_change(dp, constants, record.cube.level, place, clip) {
            self.counts.changed_to_screen += 1;
            record.pose = Pose::Screen(to_screen::change(dp, constants, place, clip));
        }
    }

    /// Draws a record at every sample that its box overlaps.
    fn draw_box(&mut self, record: &Record<L>) {
        let paint = self.paint(record, None);
        while let Some(sample) = self.first_undrawn(record) {
            self.canvas.draw(&mut self.dp, sample, &paint);
        }
    }

    /// Draws a record at the sample that holds its centre, if that is in the
    /// picture and not before the near plane.
    fn draw_centre(&mut self, record: &Record<L>) {
        self.dp.stage(Stage::Draw);
        let (dp, constants, place) = (&mut self.dp, &self.constants, record.place);
        let sample = match &record.pose {
            Pose::Clip(clip, _) => {
                let w = clip.w.centre(dp);
                dp.tap(Block::CageCentre, &clip.w, &w);
                if dp.lt(w, constants.near) {
                    return;
                }
                size::clip_sample(dp, constants, place, clip, w)
            }
            Pose::Screen(screen) => size::screen_sample(dp, constants, place, screen),
        };
        if let Some(sample) = sample {
            let paint = self.paint(record, None);
            self.canvas.draw(&mut self.dp, sample, &paint);
        }
    }

    /// Draws a solid by its silhouette.
    fn draw_solid(&mut self, record: &Record<L>) {
        let Pose::Clip(clip, planes) = &record.pose else {
            unreachable!("`FrameSetup::screen_depth` lets no record change under these rules");
        };
        self.counts.solids += 1;
        self.dp.stage(Stage::Draw);
        let cube = &record.cube;
        let mut ink = None;
        if let Some(eye) = &self.constants.blend_eye {
            let (opacity, light) = (
                self.graph.opacity_of(cube.node),
                self.graph.light_of(cube.node),
            );
            let eye_floor = &self.constants.eye_floor;
            ink = BlendColor::of_voxel(&mut self.dp, eye, eye_floor, cube, opacity, light);
            self.dp.stage(Stage::Draw);
            if ink.is_none() {
                return;
            }
        }
        let paint = self.paint(record, ink);
        let silhouette = Silhouette::new(&mut self.dp, &self.constants, cube, planes, clip.w_min);
        self.dp.next_step(0);
        self.canvas
            .draw_silhouette(&mut self.dp, record.place.quad, silhouette, &paint);
    }

    /// What a record shows where it is drawn: the voxel that it is a part of.
    fn paint(&self, record: &Record<L>, ink: Option<BlendColor>) -> Paint {
        let cube = &record.cube;
        let side_log2 = self.constants.depth - cube.voxel_level;
        let [x, y, z] = cube.min.map(|min| {
            let voxel = min.to_host() >> self.constants.sub_levels;
            (voxel >> side_log2 << side_log2) as i32
        });
        Paint {
            node: cube.node,
            voxel: [x, y, z, cube.voxel_level as i32],
            ink,
        }
    }
}
