//! Hits whose colours are on their way from the memory, because nodes lie all over it. Their samples are marked as drawn
//! already, so only these hits are shown there.

use super::canvas::Pixels;
use super::directions::SAMPLES;
use crate::graph::prefetch;

/// Hits that wait at most: those of four squares.
const MOST: usize = 4 * SAMPLES.len();

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

    /// Adds a hit, after [`Waiting::make_room`]; one that needs no colour is shown at once. The remainder is for the
    /// compiler, which sees no overflow then.
    #[inline(always)]
    pub(super) fn push(&mut self, pixels: &mut Pixels<'_>, at: usize, node: u32) {
        if pixels.color.is_empty() {
            pixels.set(at, node);
            return;
        }
        prefetch(pixels.color, node as usize);
        self.hits[self.count % MOST] = (at, node);
        self.count += 1;
    }

    #[inline(always)]
    pub(super) fn show(&mut self, pixels: &mut Pixels<'_>) {
        for &(at, node) in &self.hits[..self.count.min(MOST)] {
            pixels.set(at, pixels.word(node));
        }
        self.count = 0;
    }
}
