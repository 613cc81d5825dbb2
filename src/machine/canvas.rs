//! The picture and its fill vectors (image-order paper, 3.3).

use crate::machine::stages::RecordStage;
use hwmodel::{Datapath, Memory, Probe, Short};

use super::alpha::BlendColor;
use super::blocks::{ADDRESS_BITS, Port};
use super::counters::Counts;
use super::fill::FillStore;
use super::levels;
use super::planes::{Cover, Silhouette};
use crate::frame::quadtree::FULL;
use crate::frame::{Frame, QuadNode};

/// The entry that a record writes to its samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct Paint {
    pub(super) node: u32,
    /// The voxel's lowest corner in finest voxels, and its level.
    pub(super) voxel: [i32; 4],
    /// Weight and colour under the rule that blends.
    pub(super) color: Option<BlendColor>,
}

#[derive(Debug)]
pub(super) struct Canvas<'f> {
    pub(super) fill: FillStore<'f>,
    pub(super) frame: &'f mut Frame,
    pub(super) counts: Counts,
}

impl Canvas<'_> {
    /// Draws one sample, unless it is full.
    #[inline]
    pub(super) fn draw<P: Probe>(&mut self, dp: &mut Datapath<P>, sample: QuadNode, paint: &Paint) {
        dp.stage(RecordStage::Draw);
        let vector = self.fill.read(dp, sample);
        if dp.and_bits(4, vector, FULL) == FULL {
            self.counts.samples_already_drawn += 1;
            return;
        }
        let at = sample.y as usize * self.frame.width as usize + sample.x as usize; // host: a sample's address
        if let Some(color) = &paint.color {
            if !self.blend(dp, at, color, paint) {
                return;
            }
        } else {
            let node = u64::from(paint.node);
            dp.next_step(0);
            dp.read(Memory::Attribute, node);
            Port::AttributeRead.tap(dp, node, &Short::unsigned(0u8, ADDRESS_BITS));
            self.put(dp, at, paint);
        }
        self.fill.mark(dp, sample);
    }

    /// Writes node and voxel to sample number `at`.
    #[inline(always)]
    fn put<P: Probe>(&mut self, dp: &mut Datapath<P>, at: usize, paint: &Paint) {
        dp.write(Memory::Pixel, at as u64);
        let shown = Short::unsigned(paint.node, ADDRESS_BITS);
        Port::PixelWrite.tap(dp, at as u64, &shown);
        self.frame.node[at] = paint.node;
        // Empty in a frame of nodes only.
        if let Some(to) = self.frame.voxel.get_mut(at) {
            *to = paint.voxel;
        }
        self.counts.samples_drawn += 1;
    }

    /// Blends a voxel into sample number `at`, which shows its first. Returns whether it is opaque enough.
    fn blend<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        at: usize,
        color: &BlendColor,
        paint: &Paint,
    ) -> bool {
        let Some(blend) = &mut self.frame.blend else {
            unreachable!("the engine makes room for blending before the first record");
        };
        let [is_first, is_full] = color.add_to(dp, at as u64, &mut blend[at]);
        self.counts.samples_blended += 1;
        if is_first {
            dp.stage(RecordStage::Draw);
            self.put(dp, at, paint);
        }
        is_full
    }

    /// Draws all samples of `quad` inside a silhouette that are not full.
    pub(super) fn draw_silhouette<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        quad: QuadNode,
        silhouette: Silhouette,
        paint: &Paint,
    ) {
        let _ = self.find(dp, quad, silhouette, &mut |canvas, dp, quad| {
            canvas.draw_all(dp, quad, paint);
            false
        });
    }

    fn draw_all<P: Probe>(&mut self, dp: &mut Datapath<P>, quad: QuadNode, paint: &Paint) {
        if levels::reaches(dp, quad.level, self.fill.levels()) {
            self.draw(dp, quad, paint);
            return;
        }
        for quadrant in self.open_quadrants(dp, quad) {
            dp.next_step(0);
            levels::next(dp, quad.level);
            self.draw_all(dp, quad.quadrant(quadrant), paint);
        }
    }

    /// Whether a sample of `quad` inside a silhouette is not full.
    pub(super) fn sees<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        quad: QuadNode,
        silhouette: Silhouette,
    ) -> bool {
        let mut is_open = |canvas: &mut Self, dp: &mut Datapath<P>, quad| {
            canvas.open_quadrants(dp, quad).next().is_some()
        };
        self.find(dp, quad, silhouette, &mut is_open).is_ok()
    }

    /// Passes the open nodes of `quad` inside a silhouette to `is_found` until it returns true. `Err`: the level of the
    /// last divided node, or of the parent of `quad`.
    fn find<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        quad: QuadNode,
        mut silhouette: Silhouette,
        is_found: &mut impl FnMut(&mut Self, &mut Datapath<P>, QuadNode) -> bool,
    ) -> Result<(), u32> {
        dp.stage(RecordStage::Draw);
        let below = levels::above(dp, quad.level, self.fill.levels());
        let mut divided = quad.level.saturating_sub(1);
        match silhouette.cover(dp, below) {
            Cover::None => {}
            Cover::All => {
                if is_found(self, dp, quad) {
                    return Ok(());
                }
            }
            Cover::Some => {
                divided = quad.level;
                for quadrant in self.open_quadrants(dp, quad) {
                    // Hardware has the planes of one node, and restores them one level at a time.
                    dp.next_step(divided - quad.level);
                    levels::next(dp, quad.level);
                    let inner = silhouette.in_quadrant(dp, quadrant);
                    dp.next_step(0);
                    match self.find(dp, quad.quadrant(quadrant), inner, is_found) {
                        Ok(()) => return Ok(()),
                        Err(deepest) => divided = deepest,
                    }
                }
            }
        }
        Err(divided)
    }

    fn open_quadrants<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        quad: QuadNode,
    ) -> impl Iterator<Item = u8> + use<P> {
        let vector = self.fill.read(dp, quad);
        let open = dp.xor_bits(4, vector, FULL);
        (0..4).filter(move |quadrant| open >> quadrant & 1 != 0)
    }
}
