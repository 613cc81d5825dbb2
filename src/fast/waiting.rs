//! Hits whose colours are being fetched: colours lie all over the memory, and a sample is not needed again once it is drawn.

use super::canvas::Pixels;
use super::directions::SAMPLES;
use super::lanes::Isa;

const MOST: usize = 256;

#[derive(Debug)]
pub(super) struct Waiting {
    /// Places in the picture, and nodes.
    hits: [(usize, u32); MOST],
    count: usize,
}

impl Waiting {
    pub(super) fn none() -> Self {
        Self {
            hits: [(0, 0); MOST],
            count: 0,
        }
    }

    /// Makes room for the hits of a square.
    #[inline(always)]
    pub(super) fn make_room(&mut self, pixels: &mut Pixels<'_>) {
        if self.count > MOST - SAMPLES.len() {
            self.show(pixels);
        }
    }

    /// Adds a hit, after [`Waiting::make_room`].
    #[inline(always)]
    pub(super) fn push<I: Isa>(&mut self, isa: I, pixels: &Pixels<'_>, at: usize, node: u32) {
        isa.prefetch(pixels.color, node as usize);
        self.hits[self.count % MOST] = (at, node);
        self.count += 1;
    }

    #[inline(always)]
    pub(super) fn show(&mut self, pixels: &mut Pixels<'_>) {
        for &(at, node) in &self.hits[..self.count.min(MOST)] {
            let word = pixels.word(node);
            if let Some(shown) = pixels.shown.get_mut(at) {
                *shown = word;
            }
        }
        self.count = 0;
    }
}
