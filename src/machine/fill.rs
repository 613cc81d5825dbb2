//! Fill vectors, four bits per node of the image quadtree, and both decisions of R6 (`SPEC.md`) that follow from one.
//!
//! *Joined*, a node two levels above the samples has a word of 16 bits instead of its own and its descendants' 21
//! vectors. The last one read stays in a register during a turn. Only accesses differ.

use std::cell::Cell;

use crate::machine::stages::RecordStage;
use hwmodel::cycles::Organisation;
use hwmodel::{Datapath, Memory, Probe, Short};

use super::blocks::{Block, Port};
use super::levels;
use super::quadrants::only;
use crate::frame::quadtree::FULL;
use crate::frame::{FillVectors, QuadNode};

const LEVELS_BELOW: u32 = 2;
const WORD_BITS: u32 = 16;
const NO_WORD: u64 = u64::MAX;

#[derive(Debug)]
pub(super) struct FillStore<'f> {
    vectors: &'f mut FillVectors,
    is_joined: bool,
    latched: Cell<u64>,
    pub(super) rejects_full: bool,
}

impl<'f> FillStore<'f> {
    pub(super) fn new(
        vectors: &'f mut FillVectors,
        organisation: Organisation,
        rejects_full: bool,
    ) -> Self {
        let (joined, tile_levels) = (organisation.joined_fill, organisation.tile_levels);
        Self {
            is_joined: joined && vectors.levels() >= tile_levels + LEVELS_BELOW,
            vectors,
            latched: Cell::new(NO_WORD),
            rejects_full,
        }
    }

    pub(super) fn levels(&self) -> u32 {
        self.vectors.levels()
    }

    /// Reports the writes of a tile's vectors and of those above it, which are up to date.
    pub(super) fn begin_tile<P: Probe>(&self, dp: &mut Datapath<P>, tile: QuadNode) {
        if !P::ENABLED {
            return;
        }
        dp.stage(RecordStage::FillUpdate);
        let below_words = if self.is_joined { LEVELS_BELOW } else { 0 };
        for level in 0..=self.levels().saturating_sub(below_words) {
            let (below, above) = (
                level.saturating_sub(tile.level),
                tile.level.saturating_sub(level),
            );
            for at in 0..1u64 << below << below {
                let (x, y) = (at as u32 & ((1 << below) - 1), (at >> below) as u32);
                let node = QuadNode {
                    level,
                    x: (tile.x >> above << below) + x,
                    y: (tile.y >> above << below) + y,
                };
                dp.write(Memory::FillVector, node.address() as u64);
            }
        }
    }

    #[inline(always)]
    pub(super) fn begin_turn(&self) {
        self.latched.set(NO_WORD);
    }

    #[inline(always)]
    pub(super) fn read<P: Probe>(&self, dp: &mut Datapath<P>, node: QuadNode) -> u8 {
        if self.is_in_word(dp, node) {
            self.read_word(dp, node);
        } else {
            self.read_vector(dp, node);
        }
        self.peek(node)
    }

    #[inline(always)]
    pub(super) fn is_full<P: Probe>(&self, dp: &mut Datapath<P>, quad: QuadNode) -> bool {
        dp.stage(RecordStage::Filled);
        if !self.rejects_full {
            return false;
        }
        let vector = self.read(dp, quad);
        let full = dp.and_bits(4, vector, FULL) == FULL;
        dp.tap(Block::Filled, &Short::unsigned(vector, 4), &full);
        full
    }

    /// Whether all quadrants that a box overlaps are full. The search for its node begins in a full one only if a parent
    /// that draws its children one by one filled it.
    #[inline]
    pub(super) fn rejects<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        quad: QuadNode,
        quadrants: u8,
    ) -> bool {
        if !self.rejects_full {
            return quadrants == 0;
        }
        let vector = self.read(dp, quad);
        let rejects = dp.and_bits(4, quadrants, !vector & FULL) == 0;
        let choice = only(quadrants);
        dp.tap(
            Block::NodeChoice,
            &(Short::unsigned(quadrants, 4), Short::unsigned(vector, 4)),
            &(
                rejects,
                choice.is_some(),
                Short::unsigned(choice.unwrap_or(0), 2),
            ),
        );
        rejects
    }

    #[inline(always)]
    pub(super) fn peek(&self, node: QuadNode) -> u8 {
        self.vectors.vector(node)
    }

    pub(super) fn replace(&mut self, node: QuadNode, vector: u8) -> u8 {
        self.vectors.replace(node, vector)
    }

    /// Sets a sample's vector, and in each ancestor the bit of a quadrant that became full.
    #[inline(always)]
    pub(super) fn mark<P: Probe>(&mut self, dp: &mut Datapath<P>, sample: QuadNode) {
        dp.stage(RecordStage::FillUpdate);
        let (mut quad, mut bits) = (sample, FULL);
        if self.is_in_word(dp, sample) {
            match self.mark_in_word(dp, sample) {
                Some(above) => (quad, bits) = above,
                None => return,
            }
            let vector = self.read_vector(dp, quad);
            dp.or_bits(4, vector, bits);
        }
        loop {
            dp.write(Memory::FillVector, quad.address() as u64);
            let before = self.vectors.vector(quad);
            let vector = self.vectors.set(quad, bits);
            dp.tap(
                Block::FillUpdate,
                &(Short::unsigned(before, 4), Short::unsigned(bits, 4)),
                &(Short::unsigned(vector, 4), vector == FULL),
            );
            let written = Short::unsigned(vector, 4);
            Port::FillWrite.tap(dp, quad.address() as u64, &written);
            let is_root = !levels::reaches(dp, quad.level, 1);
            if dp.and_bits(4, vector, FULL) != FULL || is_root {
                break;
            }
            bits = 1 << quad.in_parent();
            quad = levels::up(dp, quad);
            let vector = self.read_vector(dp, quad);
            dp.or_bits(4, vector, bits);
        }
    }

    /// Returns the node above a word that becomes full, and its bit there.
    fn mark_in_word<P: Probe>(
        &mut self,
        dp: &mut Datapath<P>,
        sample: QuadNode,
    ) -> Option<(QuadNode, u8)> {
        self.read_word(dp, sample);
        let holder = self.word_of(sample);
        let (mut node, mut bits) = (sample.ancestor(sample.level - 1), 1 << sample.in_parent());
        // Four gates per quadrant, of which one changes.
        let before = self.peek(node);
        dp.beside(RecordStage::FillUpdate, |dp| {
            dp.or_bits(4, before, bits);
            dp.and_bits(4, before, FULL);
        });
        self.vectors.set(sample, FULL);
        while self.vectors.set(node, bits) == FULL && node.level > holder.level {
            bits = 1 << node.in_parent();
            node = node.ancestor(node.level - 1);
        }
        dp.write(Memory::FillVector, holder.address() as u64);
        Port::FillWrite.tap(dp, holder.address() as u64, &self.word(holder));
        let is_full = self.peek(holder) == FULL && levels::reaches(dp, holder.level, 1);
        is_full.then(|| (levels::up(dp, holder), 1 << holder.in_parent()))
    }

    #[inline(always)]
    fn read_vector<P: Probe>(&self, dp: &mut Datapath<P>, node: QuadNode) -> u8 {
        let (address, vector) = (node.address() as u64, self.vectors.vector(node));
        dp.read(Memory::FillVector, address);
        Port::FillRead.tap(dp, address, &Short::unsigned(vector, 4));
        vector
    }

    #[inline(always)]
    fn is_in_word<P: Probe>(&self, dp: &mut Datapath<P>, node: QuadNode) -> bool {
        self.is_joined && levels::reaches(dp, node.level, self.levels() - LEVELS_BELOW)
    }

    fn word_of(&self, node: QuadNode) -> QuadNode {
        node.ancestor(self.levels() - LEVELS_BELOW)
    }

    fn word(&self, node: QuadNode) -> Short {
        let word = (0..4).fold(0, |word, quadrant| {
            word | u32::from(self.peek(node.quadrant(quadrant))) << (quadrant << 2)
        });
        Short::unsigned(word, WORD_BITS)
    }

    fn read_word<P: Probe>(&self, dp: &mut Datapath<P>, node: QuadNode) {
        let node = self.word_of(node);
        let address = node.address() as u64;
        if self.latched.replace(address) != address {
            dp.read(Memory::FillVector, address);
            Port::FillRead.tap(dp, address, &self.word(node));
        }
    }
}
