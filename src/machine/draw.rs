//! Drawing samples, and telling the fill vectors (paper, 3.3).

use hwmodel::{Datapath, Memory, Probe, Short, Stage};

use super::alpha::Ink;
use super::fit::Fill;
use super::planes::{Cover, Silhouette};
use super::taps::Block;
use crate::frame::quadtree::FULL;
use crate::frame::{FillVectors, Frame, QuadNode};

/// The picture in the making.
#[derive(Debug)]
pub(super) struct Canvas<'f> {
    pub(super) fill: &'f mut FillVectors,
    frame: &'f mut Frame,
    /// What the voxel that is drawn adds to samples, under the rule that blends.
    pub(super) ink: Option<Ink>,
    /// Records by quadtree node, if asked for.
    heat: Option<Vec<u32>>,
    /// Samples drawn.
    pub(super) drawn: u64,
    /// Voxels that samples took, under the rule that blends.
    pub(super) blended: u64,
    /// Samples that were drawn before.
    pub(super) occluded: u64,
}

impl<'f> Canvas<'f> {
    pub(super) fn new(
        fill: &'f mut FillVectors,
        frame: &'f mut Frame,
        heat: Option<Vec<u32>>,
    ) -> Self {
        Self {
            fill,
            frame,
            ink: None,
            blended: 0,
            heat,
            drawn: 0,
            occluded: 0,
        }
    }

    /// The fill vectors as the fit sees them; `reject`: whether full quadrants reject.
    #[inline]
    pub(super) fn seen_by_fit(&self, reject: bool) -> Fill<'_> {
        Fill {
            vectors: self.fill.cells(),
            reject,
        }
    }

    /// Counts a record for the heat map.
    #[inline]
    pub(super) fn warm(&mut self, quad: QuadNode) {
        if let Some(heat) = &mut self.heat {
            heat[quad.address()] += 1;
        }
    }

    /// Draws one sample, unless it is drawn already.
    #[inline]
    pub(super) fn draw<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        sample: QuadNode,
        node: u32,
        voxel: [i32; 4],
    ) {
        dp.stage(Stage::Draw);
        let address = sample.address();
        dp.read(Memory::FillVector, address as u64);
        let vector = self.fill.vector(sample);
        if dp.and_bits(4, vector, FULL) == FULL {
            self.occluded += 1;
            return;
        }
        let at = sample.y as usize * self.frame.width as usize + sample.x as usize;
        if self.ink.is_some() {
            if !self.blend(dp, at, node, voxel) {
                return;
            }
        } else {
            dp.read(Memory::Attribute, u64::from(node));
            self.put(dp, at, node, voxel);
        }

        dp.stage(Stage::FillUpdate);
        let mut quad = sample;
        let mut bits = FULL;
        loop {
            dp.write(Memory::FillVector, quad.address() as u64);
            let before = self.fill.vector(quad);
            let vector = self.fill.set(quad, bits);
            dp.tap(
                Block::FillUpdate,
                &(Short::unsigned(before, 4), Short::unsigned(bits, 4)),
                &(Short::unsigned(vector, 4), vector == FULL),
            );
            if dp.and_bits(4, vector, FULL) != FULL || quad.level == 0 {
                break;
            }
            bits = 1 << quad.in_parent();
            quad = QuadNode {
                level: quad.level - 1,
                x: quad.x >> 1,
                y: quad.y >> 1,
            };
            dp.read(Memory::FillVector, quad.address() as u64);
            dp.or_bits(4, self.fill.vector(quad), bits);
        }
    }

    /// Shows a voxel at a sample.
    #[inline(always)]
    fn put<P: Probe>(&mut self, dp: &mut Datapath<P>, at: usize, node: u32, voxel: [i32; 4]) {
        dp.write(Memory::Pixel, at as u64);
        self.frame.node[at] = node;
        // None where the frame is of nodes alone.
        if let Some(to) = self.frame.voxel.get_mut(at) {
            *to = voxel;
        }
        self.drawn += 1;
    }

    /// Blends a voxel into a sample, which shows the first that it takes.
    /// Whether it is opaque enough by now.
    fn blend<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        at: usize,
        node: u32,
        voxel: [i32; 4],
    ) -> bool {
        let (Some(ink), Some(blend)) = (&self.ink, &mut self.frame.blend) else {
            return true;
        };
        let taken = ink.take(dp, at as u64, &mut blend[at]);
        self.blended += 1;
        if taken.is_first {
            dp.stage(Stage::Draw);
            self.put(dp, at, node, voxel);
        }
        taken.is_full
    }

    /// Draws all samples of `quad` that a silhouette covers.
    pub(super) fn draw_outline<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        quad: QuadNode,
        mut outline: Silhouette,
        node: u32,
        voxel: [i32; 4],
    ) {
        dp.stage(Stage::Draw);
        let below = self.fill.levels() - quad.level;
        match outline.cover(dp, below) {
            Cover::None => {}
            Cover::All => self.draw_all(dp, quad, node, voxel),
            Cover::Some => {
                for quadrant in self.open_quadrants(dp, quad) {
                    let inner = outline.quadrant(dp, quadrant);
                    self.draw_outline(dp, quad.quadrant(quadrant), inner, node, voxel);
                }
            }
        }
    }

    /// Draws all samples of a node that are not drawn yet.
    fn draw_all<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        quad: QuadNode,
        node: u32,
        voxel: [i32; 4],
    ) {
        if quad.level == self.fill.levels() {
            self.draw(dp, quad, node, voxel);
            return;
        }
        for quadrant in self.open_quadrants(dp, quad) {
            self.draw_all(dp, quad.quadrant(quadrant), node, voxel);
        }
    }

    fn open_quadrants<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        quad: QuadNode,
    ) -> impl Iterator<Item = u8> + use<P> {
        dp.read(Memory::FillVector, quad.address() as u64);
        let open = dp.xor_bits(4, self.fill.vector(quad), FULL);
        (0..4).filter(move |quadrant| open >> quadrant & 1 != 0)
    }

    /// Hands the heat map over: each record counts 1, spread over its node's samples.
    pub(super) fn finish(self) {
        let (Some(heat), Some(records)) = (self.heat, &mut self.frame.records) else {
            return;
        };
        let levels = self.fill.levels();
        let width = self.frame.width as usize;
        for (at, share) in records.iter_mut().enumerate() {
            let (x, y) = ((at % width) as u32, (at / width) as u32);
            *share = (0..=levels)
                .map(|level| {
                    let below = levels - level;
                    let quad = QuadNode {
                        level,
                        x: x >> below,
                        y: y >> below,
                    };
                    let samples = f64::from(1u32 << below) * f64::from(1u32 << below);
                    f64::from(heat[quad.address()]) / samples
                })
                .sum::<f64>() as f32;
        }
    }
}
